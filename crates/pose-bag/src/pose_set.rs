//! Poses that were recorded together, and reading them from any file.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use se3_geom::Pose;

use crate::BagError;
use crate::bag_reader::read_bag;
use crate::mcap_messages::has_magic;
use crate::metadata::mcap_files;
use crate::table::{STANDARD_INPUT, read_table};
use crate::tum::read_tum;

/// Poses that were recorded together: a text file, one `PoseArray`, or all `PoseStamped` of a topic.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSet {
    /// Frame in which the poses are given; empty where the file does not say.
    pub frame_id: String,
    /// `frame_from_tool`, in the order of the file.
    pub poses: Vec<Pose>,
    /// When each pose held, in nanoseconds since the epoch, as TUM lines and `PoseStamped` messages say.
    pub stamps_ns: Option<Vec<i64>>,
    /// Where the poses come from.
    pub origin: Origin,
}

/// Where poses come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// The file; for a bag, the MCAP file (the first, where a topic spans several).
    pub file: PathBuf,
    /// Topic, in a bag.
    pub topic: Option<String>,
    /// Message on the topic, from 0, where the poses are those of one message.
    pub message: Option<usize>,
}

/// Reads poses from CSV (also from standard input, as `-`), TUM (`.tum`, `.txt`), an MCAP file, or the folder of a rosbag2 bag.
///
/// `topic` chooses among the topics of a bag; without it the bag has to have exactly one with poses. Each `PoseArray` message is
/// a set of its own; the `PoseStamped` messages of a topic are one set.
///
/// # Errors
/// [`BagError`], one sentence that names the file and the line or message.
pub fn read_poses(path: impl AsRef<Path>, topic: Option<&str>) -> Result<Vec<PoseSet>, BagError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    if path.is_dir() {
        return read_bag(path, &mcap_files(path)?, topic);
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    let origin = Origin { file: path.to_path_buf(), topic: None, message: None };
    let set = |poses, stamps_ns| vec![PoseSet { frame_id: String::new(), poses, stamps_ns, origin }];
    match extension.as_deref() {
        Some("csv") => Ok(set(read_table(path)?.poses()?, None)),
        None if path == Path::new(STANDARD_INPUT) => Ok(set(read_table(path)?.poses()?, None)),
        Some("tum" | "txt") => {
            let opened = File::open(path).map_err(BagError::io(&file))?;
            let (stamps_ns, poses) = read_tum(BufReader::new(opened), &file)?;
            Ok(set(poses, Some(stamps_ns)))
        }
        Some("mcap") => read_bag(path, &[path.to_path_buf()], topic),
        _ => {
            let mut start = Vec::new();
            let opened = File::open(path).map_err(BagError::io(&file))?;
            opened.take(mcap::MAGIC.len() as u64).read_to_end(&mut start).map_err(BagError::io(&file))?;
            if has_magic(&start) {
                read_bag(path, &[path.to_path_buf()], topic)
            } else {
                Err(BagError::UnknownFormat { file })
            }
        }
    }
}
