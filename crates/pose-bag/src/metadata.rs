//! `metadata.yaml` of a rosbag2 bag, version 9 (ROS 2 Jazzy).

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::BagError;

/// Name of the file inside the folder of a bag.
pub(crate) const METADATA_FILE: &str = "metadata.yaml";
const STORAGE: &str = "mcap";

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
            storage_identifier: STORAGE.into(),
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

/// The MCAP files of the bag in a folder, in the order of its metadata.
pub(crate) fn mcap_files(folder: &Path) -> Result<Vec<PathBuf>, BagError> {
    let path = folder.join(METADATA_FILE);
    let file = folder.display().to_string();
    let invalid =
        |reason: String| BagError::NotABag { file: file.clone(), reason: format!("{METADATA_FILE}: {reason}") };
    let unsupported = |feature: String| BagError::Unsupported { file: file.clone(), feature };
    let text = fs::read_to_string(&path).map_err(|error| invalid(error.to_string()))?;
    let document: Document = serde_yaml::from_str(&text).map_err(|error| invalid(error.to_string()))?;
    let metadata = document.rosbag2_bagfile_information;
    if metadata.storage_identifier != STORAGE {
        return Err(unsupported(format!("storage {}", metadata.storage_identifier)));
    }
    // Chunks compressed by the MCAP storage itself are not meant here: they leave the mode empty.
    if !matches!(metadata.compression_mode.to_ascii_lowercase().as_str(), "" | "none" | "storage") {
        return Err(unsupported(format!("compression mode {}", metadata.compression_mode)));
    }
    if metadata.relative_file_paths.is_empty() {
        return Err(invalid("relative_file_paths is empty".into()));
    }
    // Bags before version 4 prefix the name of the folder, and a bag may have been renamed since.
    let file_name = |relative: &String| Path::new(relative).file_name().map(|name| folder.join(name));
    let files = metadata.relative_file_paths.iter().map(file_name).collect::<Option<Vec<_>>>();
    files.ok_or_else(|| invalid("relative_file_paths names no file".into()))
}
