//! Where results go: standard output, or files that appear whole or not at all.

use std::io::{ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

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

/// The trajectory as CSV: `t`, then positions, velocities and accelerations of every joint, SI units.
pub(crate) fn trajectory_csv(trajectory: &JointTrajectory) -> String {
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
    text
}

/// Writes text beside its destination and moves it there when it is complete.
pub(crate) fn write_whole(path: &Path, text: &str) -> Result<(), Failure> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let write = || -> std::io::Result<()> {
        // Readable by others as far as the umask allows, as any other file would be.
        let readable = std::fs::Permissions::from_mode(0o666);
        let mut pending = tempfile::Builder::new().permissions(readable).tempfile_in(folder)?;
        pending.write_all(text.as_bytes())?;
        pending.persist(path)?;
        Ok(())
    };
    write().map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))
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
