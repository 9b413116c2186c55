//! ROS messages to trajectories and back; the only place that knows both.

use planner::manipulator::{JointPoint, JointTrajectory};
use r2r::builtin_interfaces::msg::{Duration, Time};
use r2r::sensor_msgs::msg::JointState;
use r2r::std_msgs::msg::Header;
use r2r::trajectory_msgs::msg as trajectory;

const NANOS: i64 = 1_000_000_000;

pub(crate) fn trajectory(message: &trajectory::JointTrajectory) -> JointTrajectory {
    let seconds = |time: &Duration| f64::from(time.sec) + f64::from(time.nanosec) * 1e-9;
    let point = |point: &trajectory::JointTrajectoryPoint| JointPoint {
        time_s: seconds(&point.time_from_start),
        positions: point.positions.clone(),
        velocities: point.velocities.clone(),
        accelerations: point.accelerations.clone(),
    };
    JointTrajectory { joint_names: message.joint_names.clone(), points: message.points.iter().map(point).collect() }
}

pub(crate) fn point(
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
) -> trajectory::JointTrajectoryPoint {
    trajectory::JointTrajectoryPoint { positions, velocities, accelerations, ..Default::default() }
}

pub(crate) fn time(stamp_ns: i64) -> Time {
    Time { sec: stamp_ns.div_euclid(NANOS) as i32, nanosec: stamp_ns.rem_euclid(NANOS) as u32 }
}

pub(crate) fn stamp_ns(stamp: &Time) -> i64 {
    i64::from(stamp.sec) * NANOS + i64::from(stamp.nanosec)
}

pub(crate) fn header(stamp_ns: i64) -> Header {
    Header { stamp: time(stamp_ns), frame_id: String::new() }
}

pub(crate) fn joint_state(names: &[String], position: Vec<f64>, velocity: Vec<f64>, stamp_ns: i64) -> JointState {
    JointState { header: header(stamp_ns), name: names.to_vec(), position, velocity, effort: Vec::new() }
}
