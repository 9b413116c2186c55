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

/// Text beside its destination, to be moved there when all that belongs with it is complete; dropped, it leaves nothing.
pub(crate) struct Pending<'a> {
    file: tempfile::NamedTempFile,
    path: &'a Path,
}

impl<'a> Pending<'a> {
    pub(crate) fn write(path: &'a Path, text: &str) -> Result<Self, Failure> {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // Readable by others as far as the umask allows, as any other file would be.
        let readable = std::fs::Permissions::from_mode(0o666);
        let write = || -> std::io::Result<_> {
            let mut file = tempfile::Builder::new().permissions(readable).tempfile_in(folder)?;
            file.write_all(text.as_bytes())?;
            Ok(file)
        };
        // A folder in its place would be noticed only when it is too late.
        let file = if path.is_dir() { Err(ErrorKind::IsADirectory.into()) } else { write() };
        Ok(Self { file: file.map_err(|error| unwritten(path, &error))?, path })
    }

    pub(crate) fn appear(self) -> Result<(), Failure> {
        self.file.persist(self.path).map(drop).map_err(|error| unwritten(self.path, &error.error))
    }
}

/// No result may take the place of what it is made from, or of another result.
pub(crate) fn spare<'a>(
    inputs: impl Iterator<Item = &'a Path>,
    outputs: impl Iterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let mut taken: Vec<PathBuf> = inputs.filter_map(|path| path.canonicalize().ok()).collect();
    for path in outputs {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let in_folder = || Ok(folder.canonicalize()?.join(path.file_name().unwrap_or_default()));
        let place = path.canonicalize().or_else(|_| in_folder()).map_err(|error| unwritten(path, &error))?;
        if taken.contains(&place) {
            let path = path.display();
            return Err(Failure::BadInput(format!("{path}: already an input or another output of this command")));
        }
        taken.push(place);
    }
    Ok(())
}

fn unwritten(path: &Path, error: &std::io::Error) -> Failure {
    Failure::BadInput(format!("{}: {error}", path.display()))
}

/// Writes a bag with what the ROS node publishes, on the same topics.
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
