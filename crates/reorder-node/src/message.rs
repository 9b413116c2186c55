//! ROS messages to planner types and back; the only place that knows both.

use planner::manipulator::JointTrajectory;
use planner::manipulator::nalgebra::Vector3;
use planner::se3_geom::{Pose, pose_from_xyzw, xyzw_from_rotation};
use planner::{Input, RawPose};
use r2r::ParameterValue;
use r2r::builtin_interfaces::msg::{Duration, Time};
use r2r::diagnostic_msgs::msg::{DiagnosticArray, DiagnosticStatus, KeyValue};
use r2r::geometry_msgs::msg as geometry;
use r2r::nav_msgs::msg::Path;
use r2r::rcl_interfaces::msg as parameters;
use r2r::sensor_msgs::msg::JointState;
use r2r::std_msgs::msg::Header;
use r2r::trajectory_msgs::msg as trajectory;

use crate::diagnostics::Status;

const NANOS: i64 = 1_000_000_000;

pub(crate) fn poses_input(message: geometry::PoseArray) -> Input {
    let frame_id = frame_name(&message.header.frame_id).to_owned();
    Input::Poses { stamp_ns: stamp_ns(&message.header.stamp), poses: message.poses.iter().map(raw).collect(), frame_id }
}

/// Poses that `transform` takes into the robot's base frame. What is no pose stays as it is, for the session to refuse by its index.
pub(crate) fn transformed(message: &geometry::PoseArray, base: &str, transform: &Pose) -> Input {
    let placed = |pose: &geometry::Pose| {
        let raw = raw(pose);
        let Ok(pose) = pose_from_xyzw(raw.position, raw.quaternion_xyzw) else { return raw };
        let pose = transform * pose;
        let quaternion_xyzw = xyzw_from_rotation(&pose.rotation);
        RawPose { position: pose.translation.vector.into(), quaternion_xyzw }
    };
    let poses = message.poses.iter().map(placed).collect();
    Input::Poses { stamp_ns: stamp_ns(&message.header.stamp), poses, frame_id: base.to_owned() }
}

fn raw(pose: &geometry::Pose) -> RawPose {
    let (p, q) = (&pose.position, &pose.orientation);
    RawPose { position: [p.x, p.y, p.z], quaternion_xyzw: [q.x, q.y, q.z, q.w] }
}

/// Parent, child, stamp in ns and `parent_from_child` of a transform; `None` where its numbers are none.
pub(crate) fn transform(message: &geometry::TransformStamped) -> Option<(&str, &str, i64, Pose)> {
    let (p, q) = (&message.transform.translation, &message.transform.rotation);
    let pose = pose_from_xyzw([p.x, p.y, p.z], [q.x, q.y, q.z, q.w]).ok()?;
    let [parent, child] = [&message.header.frame_id, &message.child_frame_id].map(|frame| frame_name(frame));
    Some((parent, child, stamp_ns(&message.header.stamp), pose))
}

/// ROS 1 wrote frames with a leading slash, and some sources still do.
pub(crate) fn frame_name(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

pub(crate) fn stamp_ns(stamp: &Time) -> i64 {
    i64::from(stamp.sec) * NANOS + i64::from(stamp.nanosec)
}

pub(crate) fn joint_state_input(message: JointState) -> Input {
    Input::JointState { names: message.name, positions: message.position, velocities: message.velocity }
}

pub(crate) fn time(stamp_ns: i64) -> Time {
    Time { sec: stamp_ns.div_euclid(NANOS) as i32, nanosec: stamp_ns.rem_euclid(NANOS) as u32 }
}

pub(crate) fn header(frame_id: &str, stamp_ns: i64) -> Header {
    Header { stamp: time(stamp_ns), frame_id: frame_id.to_owned() }
}

fn point(p: &Vector3<f64>) -> geometry::Point {
    geometry::Point { x: p.x, y: p.y, z: p.z }
}

pub(crate) fn pose_message(pose: &Pose) -> geometry::Pose {
    let [x, y, z, w] = xyzw_from_rotation(&pose.rotation);
    geometry::Pose { position: point(&pose.translation.vector), orientation: geometry::Quaternion { x, y, z, w } }
}

pub(crate) fn pose_array(poses: &[Pose], header: Header) -> geometry::PoseArray {
    geometry::PoseArray { header, poses: poses.iter().map(pose_message).collect() }
}

pub(crate) fn path_message(poses: &[Pose], header: Header) -> Path {
    let stamped = |pose| geometry::PoseStamped { header: header.clone(), pose: pose_message(pose) };
    Path { poses: poses.iter().map(stamped).collect(), header }
}

/// The stamp says when the controller is at time 0 of the trajectory; zero asks it to start at once.
pub(crate) fn trajectory_message(
    planned: &JointTrajectory,
    base_frame: &str,
    stamp_ns: i64,
) -> trajectory::JointTrajectory {
    let recorded = planner::trajectory_message(planned, Default::default());
    let points = recorded.points.into_iter().map(|point| trajectory::JointTrajectoryPoint {
        positions: point.positions,
        velocities: point.velocities,
        accelerations: point.accelerations,
        effort: point.effort,
        time_from_start: Duration { sec: point.time_from_start.sec, nanosec: point.time_from_start.nanosec },
    });
    trajectory::JointTrajectory {
        header: header(base_frame, stamp_ns),
        joint_names: recorded.joint_names,
        points: points.collect(),
    }
}

pub(crate) fn diagnostics_message(statuses: Vec<Status>, hardware_id: &str, stamp_ns: i64) -> DiagnosticArray {
    let message = |status: Status| DiagnosticStatus {
        level: status.level as u8,
        name: status.name,
        message: status.message,
        hardware_id: hardware_id.to_owned(),
        values: status.values.into_iter().map(|(key, value)| KeyValue { key: key.into(), value }).collect(),
    };
    DiagnosticArray { header: header("", stamp_ns), status: statuses.into_iter().map(message).collect() }
}

pub(crate) fn parameter_from_message(message: &parameters::Parameter) -> (String, ParameterValue) {
    let value = &message.value;
    let converted = match i64::from(value.type_) {
        1 => ParameterValue::Bool(value.bool_value),
        2 => ParameterValue::Integer(value.integer_value),
        3 => ParameterValue::Double(value.double_value),
        4 => ParameterValue::String(value.string_value.clone()),
        5 => ParameterValue::ByteArray(value.byte_array_value.clone()),
        6 => ParameterValue::BoolArray(value.bool_array_value.clone()),
        7 => ParameterValue::IntegerArray(value.integer_array_value.clone()),
        8 => ParameterValue::DoubleArray(value.double_array_value.clone()),
        9 => ParameterValue::StringArray(value.string_array_value.clone()),
        _ => ParameterValue::NotSet,
    };
    (message.name.clone(), converted)
}

/// Of the types that the table has; anything else is told as not set.
pub(crate) fn parameter_value_message(value: Option<ParameterValue>) -> parameters::ParameterValue {
    let empty = parameters::ParameterValue::default();
    match value {
        Some(ParameterValue::Bool(bool_value)) => parameters::ParameterValue { type_: 1, bool_value, ..empty },
        Some(ParameterValue::Integer(integer_value)) => parameters::ParameterValue { type_: 2, integer_value, ..empty },
        Some(ParameterValue::Double(double_value)) => parameters::ParameterValue { type_: 3, double_value, ..empty },
        Some(ParameterValue::String(string_value)) => parameters::ParameterValue { type_: 4, string_value, ..empty },
        _ => empty,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quaternions_cross_the_boundary_in_ros_order() {
        let pose = geometry::Pose {
            position: geometry::Point { x: 1.0, y: 2.0, z: 3.0 },
            orientation: geometry::Quaternion { x: 0.1, y: 0.2, z: 0.3, w: 0.927_361_849_549_570_4 },
        };
        let message = geometry::PoseArray { header: header("base_link", 1_500_000_007), poses: vec![pose.clone()] };
        let Input::Poses { frame_id, stamp_ns, poses } = poses_input(message) else { panic!() };
        assert_eq!((frame_id.as_str(), stamp_ns), ("base_link", 1_500_000_007));
        assert_eq!(poses[0].position, [1.0, 2.0, 3.0]);
        assert_eq!(poses[0].quaternion_xyzw, [0.1, 0.2, 0.3, 0.927_361_849_549_570_4]);
        let inside = planner::se3_geom::pose_from_xyzw(poses[0].position, poses[0].quaternion_xyzw).unwrap();
        let back = pose_message(&inside);
        assert_eq!(back.position, pose.position);
        for (a, b) in [(back.orientation.x, 0.1), (back.orientation.y, 0.2), (back.orientation.z, 0.3)] {
            assert!((a - b).abs() < 1e-15);
        }
        assert!((back.orientation.w - pose.orientation.w).abs() < 1e-15);
    }
}
