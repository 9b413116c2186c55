//! ROS messages to planner types and back; the only place that knows both.

use planner::manipulator::JointTrajectory;
use planner::se3_geom::{Pose, xyzw_from_rotation};
use planner::{Input, RawPose};
use r2r::builtin_interfaces::msg::{Duration, Time};
use r2r::geometry_msgs::msg as geometry;
use r2r::nav_msgs::msg::Path;
use r2r::sensor_msgs::msg::JointState;
use r2r::std_msgs::msg::Header;
use r2r::trajectory_msgs::msg as trajectory;

const NANOS: i64 = 1_000_000_000;

pub(crate) fn poses_input(message: geometry::PoseArray) -> Input {
    let raw = |pose: &geometry::Pose| {
        let (p, q) = (&pose.position, &pose.orientation);
        RawPose { position: [p.x, p.y, p.z], quaternion_xyzw: [q.x, q.y, q.z, q.w] }
    };
    let stamp = &message.header.stamp;
    Input::Poses {
        stamp_ns: i64::from(stamp.sec) * NANOS + i64::from(stamp.nanosec),
        poses: message.poses.iter().map(raw).collect(),
        frame_id: message.header.frame_id,
    }
}

pub(crate) fn joint_state_input(message: JointState) -> Input {
    Input::JointState { names: message.name, positions: message.position, velocities: message.velocity }
}

pub(crate) fn header(frame_id: &str, stamp_ns: i64) -> Header {
    let stamp = Time { sec: stamp_ns.div_euclid(NANOS) as i32, nanosec: stamp_ns.rem_euclid(NANOS) as u32 };
    Header { stamp, frame_id: frame_id.to_owned() }
}

fn pose_message(pose: &Pose) -> geometry::Pose {
    let [x, y, z, w] = xyzw_from_rotation(&pose.rotation);
    let p = &pose.translation.vector;
    geometry::Pose {
        position: geometry::Point { x: p.x, y: p.y, z: p.z },
        orientation: geometry::Quaternion { x, y, z, w },
    }
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
