//! Where results go: standard output, or files that appear whole or not at all.

use std::io::{ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use planner::manipulator::JointTrajectory;
use planner::pose_bag::BagWriter;
use planner::pose_bag::msg;
use planner::{Plan, Request, trajectory_message};

use crate::failure::Failure;

/// Prints to standard output. A reader that stops early, such as `head`, is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::BadInput(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// The trajectory as CSV: `t`, then positions, velocities and accelerations of every joint, SI units. Headers are read as they stand,
/// without quotes: a joint whose name would need them goes into no CSV.
pub(crate) fn trajectory_csv(trajectory: &JointTrajectory) -> Result<String, Failure> {
    if let Some(joint) = trajectory.joint_names.iter().find(|name| name.contains([',', '"', '\n', '\r'])) {
        let sentence = format!("joint {joint:?} cannot head a column of a CSV file: write an .mcap file (-o)");
        return Err(Failure::BadInput(sentence));
    }
    let mut header = vec!["t".to_owned()];
    for kind in ["position", "velocity", "acceleration"] {
        header.extend(trajectory.joint_names.iter().map(|joint| format!("{joint}.{kind}")));
    }
    let mut text = header.join(",") + "\n";
    for point in &trajectory.points {
        let row = [point.time_s].into_iter().chain(point.positions.iter().copied());
        let row = row.chain(point.velocities.iter().copied()).chain(point.accelerations.iter().copied());
        text += &(row.map(|x| x.to_string()).collect::<Vec<_>>().join(",") + "\n");
    }
    Ok(text)
}

/// Text beside its destination, to be moved there when all that belongs with it is complete; dropped, it leaves nothing. What is no file,
/// a device or a pipe, gets the text itself, and is not replaced by one.
pub(crate) struct Pending<'a> {
    content: Content,
    path: &'a Path,
}

enum Content {
    /// With the place where it goes, which a link may name.
    File(tempfile::NamedTempFile, PathBuf),
    Text(String),
}

impl<'a> Pending<'a> {
    pub(crate) fn write(path: &'a Path, text: &str) -> Result<Self, Failure> {
        // Readable by others as far as the umask allows, as any other file would be.
        let readable = std::fs::Permissions::from_mode(0o666);
        let write = || -> std::io::Result<_> {
            let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
            if place.is_dir() {
                return Err(ErrorKind::IsADirectory.into());
            }
            if place.exists() && !place.is_file() {
                return Ok(Content::Text(text.to_owned()));
            }
            let folder = place.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let mut file = tempfile::Builder::new().permissions(readable).tempfile_in(folder)?;
            file.write_all(text.as_bytes())?;
            // On the disk before it has its name, or a power cut could leave an empty file of that name.
            file.as_file().sync_all()?;
            Ok(Content::File(file, place))
        };
        Ok(Self { content: write().map_err(|error| unwritten(path, &error))?, path })
    }

    pub(crate) fn appear(self) -> Result<(), Failure> {
        match self.content {
            Content::File(file, place) => file.persist(place).map(drop).map_err(|error| error.error),
            Content::Text(text) => std::fs::OpenOptions::new()
                .write(true)
                .open(self.path)
                .and_then(|mut file| file.write_all(text.as_bytes())),
        }
        .map_err(|error| unwritten(self.path, &error))
    }
}

fn unwritten(path: &Path, error: &std::io::Error) -> Failure {
    Failure::BadInput(format!("{}: {error}", path.display()))
}

/// Writes a bag with the trajectory, the ordered poses and the path, on the topics of the ROS node.
pub(crate) fn write_bag(path: &Path, plan: &Plan, base_frame: &str, request: &Request) -> Result<(), Failure> {
    let header = || msg::Header { stamp: msg::Time::default(), frame_id: base_frame.to_owned() };
    let ordered = plan.ordered_poses(request).iter().map(Into::into).collect();
    let curve = plan.path().iter().map(|pose| msg::PoseStamped { header: header(), pose: pose.into() }).collect();
    let write = || {
        let mut bag = BagWriter::create(path)?;
        bag.write("/joint_trajectory", 0, &trajectory_message(&plan.trajectory, header()))?;
        bag.write("/reorder/ordered_poses", 0, &msg::PoseArray { header: header(), poses: ordered })?;
        bag.write("/reorder/path", 0, &msg::Path { header: header(), poses: curve })?;
        bag.finish()
    };
    write().map_err(Failure::bad_input)
}
