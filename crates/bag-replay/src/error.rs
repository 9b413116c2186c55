//! What keeps a replay, or the loading of a robot, from beginning.

use std::path::{Path, PathBuf};

use planner::manipulator::ManipulatorError;
use planner::pose_bag::BagError;

/// One sentence that names what and where.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// A file or folder cannot be read, or not be made.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// Which one.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A folder that is searched for bags holds none.
    #[error("{folder}: there is no bag in this folder", folder = folder.display())]
    NoBag {
        /// Which folder.
        folder: PathBuf,
    },
    /// Two bags would be written over each other.
    #[error("{} and {} would both be written as {name}.mcap", bags[0].display(), bags[1].display())]
    SameName {
        /// Which bags.
        bags: [PathBuf; 2],
        /// What both outputs would be called, without the ending.
        name: String,
    },
    /// One file shall hold what several bags give.
    #[error("{output} is one file for {bags} bags: name a folder", output = output.display())]
    OneFile {
        /// The file.
        output: PathBuf,
        /// How many bags there are.
        bags: usize,
    },
    /// The next run would find the outputs of this one among its bags.
    #[error("{output} lies in {searched}: outputs go where no bags are looked for", output = output.display(), searched = searched.display())]
    OutputAmongInputs {
        /// Where the outputs shall go.
        output: PathBuf,
        /// The folder that is searched for bags.
        searched: PathBuf,
    },
    /// A result would take the place of what it is made from, or of another result.
    #[error("{path}: already an input or another output of this command", path = path.display())]
    Taken {
        /// The result.
        path: PathBuf,
    },
    /// A result would take the place of a file that no replay made.
    #[error("{path}: already there, and not made by a replay of this version: choose another place, or remove it", path = path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// What runs that were killed left cannot be removed.
    #[error(transparent)]
    Abandoned(#[from] BagError),
    /// No robot of that name, or no such robot in the files.
    #[error("{of}{source}", of = files.as_ref().map_or_else(String::new, |files| format!("{files}: ")))]
    Robot {
        /// The file at fault, or both where that cannot be told; none where only a name was given.
        files: Option<String>,
        /// Why.
        source: Box<ManipulatorError>,
    },
    /// A URDF alone makes no robot.
    #[error("{urdf}: a URDF has no acceleration and jerk limits: give --limits")]
    NoLimits {
        /// The URDF.
        urdf: String,
    },
}

impl ReplayError {
    pub(crate) fn io(path: impl AsRef<Path>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.as_ref().to_owned();
        move |source| Self::Io { path, source }
    }
}
