//! The run as a bag of ROS messages.

use std::path::Path;

use mujoco_sim::planner::manipulator::{JointPoint, JointTrajectory};
use mujoco_sim::planner::pose_bag::{BagWriter, msg};
use mujoco_sim::{Execution, SimError};

use crate::due::DuePoses;

const NANOSECONDS: u64 = 1_000_000_000;

/// Frame of the tool path where the poses do not name theirs: the arm's base is the origin of its model.
const BASE_FRAME: &str = "base_link";

/// Writes the trajectory, the poses and the executed tool path; stamps count from the trajectory's start.
pub(crate) fn write(
    path: &Path,
    trajectory: &JointTrajectory,
    due: &DuePoses,
    execution: &Execution,
) -> Result<(), SimError> {
    let frame_id = if due.frame_id.is_empty() { BASE_FRAME } else { &due.frame_id };
    let header = |nanos: u64| {
        let duration = duration(nanos);
        msg::Header { stamp: msg::Time { sec: duration.sec, nanosec: duration.nanosec }, frame_id: frame_id.to_owned() }
    };
    let mut bag = BagWriter::create(path)?;
    bag.write("/joint_trajectory", 0, &trajectory_message(trajectory))?;
    if !due.poses.is_empty() {
        let poses = due.poses.iter().map(Into::into).collect();
        bag.write("/reorder/poses", 0, &msg::PoseArray { header: header(0), poses })?;
    }
    let tool = execution.samples.iter().filter_map(|sample| {
        let pose = (&execution.tool_at(sample.time_s)?).into();
        Some(msg::PoseStamped { header: header(nanos(sample.time_s)), pose })
    });
    let end = execution.samples.last().map_or(0, |sample| nanos(sample.time_s));
    bag.write("/reorder/executed_path", end, &msg::Path { header: header(0), poses: tool.collect() })?;
    bag.finish()?;
    Ok(())
}

fn trajectory_message(trajectory: &JointTrajectory) -> msg::JointTrajectory {
    let point = |point: &JointPoint| msg::JointTrajectoryPoint {
        positions: point.positions.clone(),
        velocities: point.velocities.clone(),
        accelerations: point.accelerations.clone(),
        effort: Vec::new(),
        time_from_start: duration(nanos(point.time_s)),
    };
    msg::JointTrajectory {
        header: msg::Header::default(),
        joint_names: trajectory.joint_names.clone(),
        points: trajectory.points.iter().map(point).collect(),
    }
}

fn nanos(time_s: f64) -> u64 {
    (time_s * NANOSECONDS as f64).round() as u64
}

/// A run lasts an hour at most, so that the seconds fit.
fn duration(nanos: u64) -> msg::Duration {
    msg::Duration { sec: (nanos / NANOSECONDS) as i32, nanosec: (nanos % NANOSECONDS) as u32 }
}
