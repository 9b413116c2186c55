//! Poses that were recorded together, and reading them from any file.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use se3_geom::Pose;

use crate::BagError;
use crate::bag_reader::BagReader;
use crate::pose_sets::read_bag;
use crate::table::{STANDARD_INPUT, read_table};
use crate::track::read_track;

/// Poses that were recorded together: a text file, one `PoseArray` or `Path`, or what [`Grouping`] takes together.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSet {
    /// Frame in which the poses are given; empty where the file does not say.
    pub frame_id: String,
    /// `frame_from_tool`, in the order of the file.
    pub poses: Vec<Pose>,
    /// When each pose held, in nanoseconds since the epoch, where file or messages say it.
    pub stamps_ns: Option<Vec<i64>>,
    /// When the message, or the first of them, was recorded, in nanoseconds since the epoch; zero for a text file.
    pub log_time_ns: u64,
    /// Where the poses come from.
    pub origin: Origin,
}

/// Where poses come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// The file; for a bag, the MCAP or SQLite file (the first, where a topic spans several).
    pub file: PathBuf,
    /// Topic, in a bag.
    pub topic: Option<String>,
    /// Message on the topic, from 0, where the poses are those of one message.
    pub message: Option<usize>,
}

/// Which poses of a bag are meant, and which of them belong together.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Selection {
    /// The topic; without it the bag has to have exactly one with poses. Paths count only where there is nothing else, and
    /// transforms only where there are not even paths, or where [`Self::frames`] are named.
    pub topic: Option<String>,
    /// Parent and child frame of the transforms that are meant, without leading slash; where it is not given there has to be one pair.
    pub frames: Option<(String, String)>,
    /// Which single poses form a set.
    pub grouping: Grouping,
}

/// Which poses form a set where each message holds one. Times are those of recording.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Grouping {
    /// All of the topic.
    #[default]
    Whole,
    /// Those within a span of time that begins with the first of them.
    Window {
        /// Length of the span.
        length_ns: u64,
    },
    /// Those between two silences.
    Gap {
        /// A longer silence ends a set.
        longest_ns: u64,
    },
}

/// Reads poses from CSV (also from standard input, as `-`), EuRoC (`.csv`), TUM and KITTI (`.tum`, `.kitti`, `.txt`, told apart by
/// the numbers on a line), an MCAP or `.db3` file, or the folder of a rosbag2 bag.
///
/// `topic` chooses among the topics of a bag, as in [`Selection`]. Each `PoseArray` and each `Path` is a set of its own; the
/// messages of a topic that hold one pose each are one set.
///
/// # Errors
/// [`BagError`], one sentence that names the file and the line or message; also where any part of a bag is damaged.
pub fn read_poses(path: impl AsRef<Path>, topic: Option<&str>) -> Result<Vec<PoseSet>, BagError> {
    let (sets, losses) = recover_poses(path, &Selection { topic: topic.map(str::to_owned), ..Selection::default() })?;
    losses.into_iter().next().map_or(Ok(sets), Err)
}

/// As [`read_poses`], but of a damaged bag takes what is whole, and says what is lost.
///
/// # Errors
/// [`BagError`] where nothing is left, or what is whole holds no poses.
pub fn recover_poses(path: impl AsRef<Path>, selection: &Selection) -> Result<(Vec<PoseSet>, Vec<BagError>), BagError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    let origin = Origin { file: path.to_path_buf(), topic: None, message: None };
    let one = |poses, stamps_ns| {
        (vec![PoseSet { frame_id: String::new(), poses, stamps_ns, log_time_ns: 0, origin }], Vec::new())
    };
    match extension.as_deref() {
        _ if path.is_dir() => read_bag(&BagReader::open(path)?, selection),
        None if path == Path::new(STANDARD_INPUT) => Ok(one(read_table(path)?.poses()?, None)),
        Some("csv") => {
            let table = read_table(path)?;
            Ok(one(table.poses()?, table.stamps_ns()?))
        }
        Some("tum" | "txt" | "kitti") => {
            let opened = File::open(path).map_err(BagError::io(&file))?;
            let (stamps_ns, poses) = read_track(BufReader::new(opened), &file)?;
            Ok(one(poses, stamps_ns))
        }
        _ => read_bag(&BagReader::open(path)?, selection),
    }
}
