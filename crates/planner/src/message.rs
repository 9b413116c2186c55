//! A planned trajectory as the ROS message that bags hold.

use manipulator::{JointPoint, JointTrajectory};
use pose_bag::msg;

const NANOS: u64 = 1_000_000_000;

/// The message of a trajectory, with an empty effort. A zero stamp in `header` asks a controller to start at once.
pub fn trajectory_message(trajectory: &JointTrajectory, header: msg::Header) -> msg::JointTrajectory {
    let point = |point: &JointPoint| msg::JointTrajectoryPoint {
        positions: point.positions.clone(),
        velocities: point.velocities.clone(),
        accelerations: point.accelerations.clone(),
        effort: Vec::new(),
        time_from_start: duration(point.time_s),
    };
    let points = trajectory.points.iter().map(point).collect();
    msg::JointTrajectory { header, joint_names: trajectory.joint_names.clone(), points }
}

/// To the nearest nanosecond; trajectories start at 0 and last minutes, so the seconds fit.
fn duration(time_s: f64) -> msg::Duration {
    let nanos = (time_s * NANOS as f64).round() as u64;
    msg::Duration { sec: (nanos / NANOS) as i32, nanosec: (nanos % NANOS) as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_round_to_the_nearest_nanosecond() {
        assert_eq!(duration(1.999_999_999_6), msg::Duration { sec: 2, nanosec: 0 });
        assert_eq!(duration(0.01), msg::Duration { sec: 0, nanosec: 10_000_000 });
    }
}
