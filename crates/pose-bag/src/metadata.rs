//! `metadata.yaml` of a rosbag2 bag, version 9 (ROS 2 Jazzy).

use std::collections::HashSet;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::BagError;

/// Name of the file inside the folder of a bag.
pub(crate) const METADATA_FILE: &str = "metadata.yaml";
const MCAP: &str = "mcap";

#[derive(Serialize, Deserialize)]
pub(crate) struct Document {
    pub(crate) rosbag2_bagfile_information: Metadata,
}

/// What older versions lack is defaulted.
#[derive(Serialize, Deserialize)]
pub(crate) struct Metadata {
    version: u32,
    storage_identifier: String,
    #[serde(default)]
    duration: Nanoseconds,
    #[serde(default)]
    starting_time: SinceEpoch,
    #[serde(default)]
    message_count: u64,
    #[serde(skip_deserializing)]
    topics_with_message_count: Vec<TopicCount>,
    #[serde(default)]
    compression_format: String,
    #[serde(default)]
    compression_mode: String,
    relative_file_paths: Vec<String>,
    #[serde(skip_deserializing)]
    files: Vec<FileInformation>,
    #[serde(skip_deserializing)]
    custom_data: Option<()>,
    #[serde(skip_deserializing)]
    ros_distro: &'static str,
}

#[derive(Serialize, Deserialize, Default, Clone, Copy)]
struct Nanoseconds {
    nanoseconds: u64,
}

#[derive(Serialize, Deserialize, Default, Clone, Copy)]
struct SinceEpoch {
    nanoseconds_since_epoch: u64,
}

#[derive(Serialize)]
struct FileInformation {
    path: String,
    starting_time: SinceEpoch,
    duration: Nanoseconds,
    message_count: u64,
}

/// A topic and how often it spoke.
#[derive(Serialize)]
pub(crate) struct TopicCount {
    pub(crate) topic_metadata: TopicMetadata,
    pub(crate) message_count: u64,
}

#[derive(Serialize)]
pub(crate) struct TopicMetadata {
    pub(crate) name: String,
    pub(crate) r#type: &'static str,
    pub(crate) serialization_format: &'static str,
    pub(crate) offered_qos_profiles: Vec<QosProfile>,
    pub(crate) type_description_hash: &'static str,
}

/// Quality of service a publisher offered, in the words of `rmw`.
#[derive(Serialize)]
pub(crate) struct QosProfile {
    history: &'static str,
    depth: u32,
    reliability: &'static str,
    durability: &'static str,
    deadline: Span,
    lifespan: Span,
    liveliness: &'static str,
    liveliness_lease_duration: Span,
    avoid_ros_namespace_conventions: bool,
}

#[derive(Serialize)]
struct Span {
    sec: u64,
    nsec: u32,
}

/// What `rmw` takes for forever: 2⁶³ − 1 nanoseconds.
const FOREVER: Span = Span { sec: 9_223_372_036, nsec: 854_775_807 };

impl QosProfile {
    /// Reliable, keep last.
    pub(crate) fn reliable(depth: u32, durability: &'static str) -> Self {
        Self {
            history: "keep_last",
            depth,
            reliability: "reliable",
            durability,
            deadline: FOREVER,
            lifespan: FOREVER,
            liveliness: "automatic",
            liveliness_lease_duration: FOREVER,
            avoid_ros_namespace_conventions: false,
        }
    }
}

impl Metadata {
    /// Of a bag with one file; `span_ns` is first and last log time, `None` for a bag without messages.
    pub(crate) fn of_one_file(path: String, span_ns: Option<(u64, u64)>, topics: Vec<TopicCount>) -> Self {
        let (first, last) = span_ns.unwrap_or_default();
        let starting_time = SinceEpoch { nanoseconds_since_epoch: first };
        let duration = Nanoseconds { nanoseconds: last - first };
        let message_count = topics.iter().map(|topic| topic.message_count).sum();
        Self {
            version: 9,
            storage_identifier: MCAP.into(),
            duration,
            starting_time,
            message_count,
            topics_with_message_count: topics,
            compression_format: String::new(),
            compression_mode: String::new(),
            relative_file_paths: vec![path.clone()],
            files: vec![FileInformation { path, starting_time, duration, message_count }],
            custom_data: None,
            ros_distro: "jazzy",
        }
    }
}

/// The files of a bag and how they are stored.
pub(crate) struct Stored {
    pub(crate) files: Vec<PathBuf>,
    pub(crate) storage: Storage,
    pub(crate) packed: Packed,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Storage {
    Mcap,
    Sqlite,
}

/// What zstd was applied to, beside what MCAP does by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packed {
    Nothing,
    Messages,
    Files,
}

/// A longer file is no metadata.
const MAX_BYTES: u64 = 4 << 20;

/// What `metadata.yaml` in the folder of a bag says of its files, in its order.
pub(crate) fn stored_in(folder: &Path) -> Result<Stored, BagError> {
    let path = folder.join(METADATA_FILE);
    let file = folder.display().to_string();
    let invalid =
        |reason: String| BagError::NotABag { file: file.clone(), reason: format!("{METADATA_FILE}: {reason}") };
    let unsupported = |feature: String| BagError::Unsupported { file: file.clone(), feature };
    let mut text = String::new();
    let read = open_regular(&path).and_then(|opened| opened.take(MAX_BYTES + 1).read_to_string(&mut text));
    read.map_err(|error| invalid(error.to_string()))?;
    if text.len() as u64 > MAX_BYTES {
        return Err(invalid(format!("it has more than {MAX_BYTES} bytes")));
    }
    let document: Document = serde_yaml::from_str(&text).map_err(|error| invalid(error.to_string()))?;
    let metadata = document.rosbag2_bagfile_information;
    let storage = match metadata.storage_identifier.as_str() {
        MCAP => Storage::Mcap,
        "sqlite3" => Storage::Sqlite,
        other => return Err(unsupported(format!("storage {other}"))),
    };
    // Chunks compressed by the MCAP storage itself are not meant here: they leave the mode empty.
    let packed = match metadata.compression_mode.to_ascii_lowercase().as_str() {
        "" | "none" | "storage" => Packed::Nothing,
        "message" => Packed::Messages,
        "file" => Packed::Files,
        _ => return Err(unsupported(format!("compression mode {}", metadata.compression_mode))),
    };
    if packed != Packed::Nothing && metadata.compression_format != "zstd" {
        return Err(unsupported(format!("compression by {}", metadata.compression_format)));
    }
    if metadata.relative_file_paths.is_empty() {
        return Err(invalid("relative_file_paths is empty".into()));
    }
    // Bags before version 4 prefix the name of the folder, and a bag may have been renamed since.
    let name_of = |relative: &String| Path::new(relative).file_name().map(OsStr::to_owned);
    let names = metadata.relative_file_paths.iter().map(name_of).collect::<Option<Vec<_>>>();
    let names = names.ok_or_else(|| invalid("relative_file_paths names no file".into()))?;
    let mut seen = HashSet::new();
    // Its poses would be there twice, or a hundred thousand times.
    if let Some(twice) = names.iter().find(|name| !seen.insert(*name)) {
        return Err(invalid(format!("relative_file_paths names {} twice", twice.display())));
    }
    let files = names.iter().map(|name| folder.join(name)).collect();
    Ok(Stored { files, storage, packed })
}

/// Opens a file of a bag. A pipe would be waited for without end, and cannot be read twice.
pub(crate) fn open_regular(path: &Path) -> io::Result<File> {
    if fs::metadata(path)?.is_file() {
        File::open(path)
    } else {
        Err(io::Error::new(ErrorKind::InvalidInput, "it is not a regular file"))
    }
}
