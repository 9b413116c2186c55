//! The UR5e of the set-up, and moves for it.

// Each test binary uses its part of this.
#![allow(dead_code)]

use std::f64::consts::FRAC_PI_2;

use mujoco_sim::planner::manipulator::{JointPoint, JointTrajectory};
use mujoco_sim::{SimulatedArm, TOOL_SITE, model_file};

pub(crate) const JOINTS: [&str; 6] =
    ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"];

pub(crate) const HOME: [f64; 6] = [-FRAC_PI_2, -FRAC_PI_2, FRAC_PI_2, -FRAC_PI_2, -FRAC_PI_2, 0.0];

/// Its forearm lies in its upper arm.
pub(crate) const FOLDED: [f64; 6] = [0.0, -1.57, 2.9, 0.0, 0.0, 0.0];

pub(crate) fn ur5e() -> SimulatedArm {
    SimulatedArm::load(model_file("ur5e").expect("a known name"), TOOL_SITE).expect("the set-up has fetched the model")
}

/// From rest to rest: between two points at rest a trajectory is the quintic D(10τ³ − 15τ⁴ + 6τ⁵).
pub(crate) fn quintic_move(from: [f64; 6], to: [f64; 6], duration_s: f64) -> JointTrajectory {
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
