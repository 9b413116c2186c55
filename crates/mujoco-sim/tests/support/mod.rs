//! The UR5e of the set-up, and moves for it.

// Each test binary uses its part of this.
#![allow(dead_code)]

use mujoco_sim::planner::manipulator::{JointPoint, JointTrajectory};
use mujoco_sim::{SimulatedArm, TOOL_SITE, model_file};

pub const JOINTS: [&str; 6] =
    ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"];

pub const HOME: [f64; 6] = [-1.5708, -1.5708, 1.5708, -1.5708, -1.5708, 0.0];

/// Its forearm lies in its upper arm.
pub const FOLDED: [f64; 6] = [0.0, -1.57, 2.9, 0.0, 0.0, 0.0];

pub fn ur5e() -> SimulatedArm {
    SimulatedArm::load(model_file("ur5e").unwrap(), TOOL_SITE).expect("the set-up has fetched the model")
}

/// From rest to rest: between two points at rest a trajectory is the quintic D(10τ³ − 15τ⁴ + 6τ⁵).
pub fn quintic_move(from: [f64; 6], to: [f64; 6], duration_s: f64) -> JointTrajectory {
    let at_rest = |time_s: f64, q: [f64; 6]| JointPoint {
        time_s,
        positions: q.to_vec(),
        velocities: vec![0.0; 6],
        accelerations: vec![0.0; 6],
    };
    JointTrajectory {
        joint_names: JOINTS.map(str::to_owned).to_vec(),
        points: vec![at_rest(0.0, from), at_rest(duration_s, to)],
    }
}
