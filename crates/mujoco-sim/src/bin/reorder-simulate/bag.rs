//! The run as a bag of ROS messages.

use std::path::Path;

use mujoco_sim::planner::manipulator::JointTrajectory;
use mujoco_sim::planner::pose_bag::{BagWriter, msg};
use mujoco_sim::planner::trajectory_message;
use mujoco_sim::{Execution, SimError};

use crate::due::DuePoses;

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
    let header = |nanos: i64| msg::Header {
        // A run lasts an hour at most, so that its seconds fit.
        stamp: msg::Time::from_nanos(nanos).unwrap_or_default(),
        frame_id: frame_id.to_owned(),
    };
    let mut bag = BagWriter::create(path)?;
    bag.write("/joint_trajectory", 0, &trajectory_message(trajectory, msg::Header::default()))?;
    if !due.poses.is_empty() {
        let poses = due.poses.iter().map(Into::into).collect();
        bag.write("/reorder/poses", 0, &msg::PoseArray { header: header(0), poses })?;
    }
    let tool = execution.samples.iter().filter_map(|sample| {
        let pose = (&execution.tool_at(sample.time_s)?).into();
        Some(msg::PoseStamped { header: header(nanos(sample.time_s)), pose })
    });
    let end = execution.samples.last().map_or(0, |sample| nanos(sample.time_s));
    bag.write("/reorder/executed_path", end.unsigned_abs(), &msg::Path { header: header(0), poses: tool.collect() })?;
    bag.finish()?;
    Ok(())
}

fn nanos(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}
