//! Plans through every recording, executed in MuJoCo: the arm is where it should be, when it should be, and touches nothing.
#![allow(clippy::unwrap_used, missing_docs)]

use end_to_end::recording;
use mujoco_sim::{ExecuteOptions, SimulatedArm, TOOL_SITE, model_file};
use planner::manipulator::{JointTrajectory, Robot};
use planner::se3_geom::Pose;
use planner::{Config, Plan, Request, plan};

const HOME: [f64; 6] = [-1.57, -1.57, 1.57, -1.57, -1.57, 0.0];

/// What the demo promises of every shape.
const TRACKING_RAD: f64 = 0.01;
const POSE_M: f64 = 0.002;
const POSE_RAD: f64 = 0.02;

fn planned(shape: &str) -> (Vec<Pose>, Plan) {
    let (poses, _) = recording(shape);
    let request = Request { poses: poses.clone(), start: Some(HOME.to_vec()), ..Request::default() };
    (poses, plan(&Robot::shipped("ur5e").unwrap(), &Config::default(), &request).unwrap())
}

/// Greatest distance of the simulated tool from the poses at their times, in m and rad.
fn executed(trajectory: &JointTrajectory, poses: &[Pose], times_s: &[f64]) -> (mujoco_sim::Execution, f64, f64) {
    let mut arm = SimulatedArm::load(model_file("ur5e").unwrap(), TOOL_SITE).unwrap();
    let execution = arm.execute(trajectory, &ExecuteOptions::default()).unwrap();
    let errors = execution.pose_errors(poses, times_s).unwrap();
    (execution, errors.max_m, errors.max_rad)
}

fn passes_every_pose_in_time(shape: &str) {
    let (poses, plan) = planned(shape);
    let (execution, max_m, max_rad) = executed(&plan.trajectory, &poses, &plan.pose_times_s);
    assert!(execution.tracking_max_rad <= TRACKING_RAD, "{shape}: {}", execution.tracking_max_rad);
    assert!(max_m <= POSE_M && max_rad <= POSE_RAD, "{shape}: {max_m} m, {max_rad} rad");
    assert!(execution.contacts.is_empty(), "{shape}: {:?}", execution.contacts);
    // It did move: at least along the drawing, which is 0.3 m wide.
    let spread = poses.iter().map(|p| (p.translation.vector - poses[0].translation.vector).norm()).fold(0.0, f64::max);
    assert!(spread > 0.1 && execution.duration_s > 1.0);
}

#[test]
fn the_simulated_arm_passes_every_pose_of_angle_in_time() {
    passes_every_pose_in_time("lasa_angle");
}

#[test]
fn the_simulated_arm_passes_every_pose_of_gshape_in_time() {
    passes_every_pose_in_time("lasa_gshape");
}

#[test]
fn the_simulated_arm_passes_every_pose_of_sine_in_time() {
    passes_every_pose_in_time("lasa_sine");
}

#[test]
fn the_simulated_arm_passes_every_pose_of_zshape_in_time() {
    passes_every_pose_in_time("lasa_zshape");
}

/// The check above can fail: the same trajectory with poses in the wrong order, or without its last pose's place, is seen.
#[test]
fn a_wrong_order_is_seen_in_simulation() {
    let (poses, plan) = planned("lasa_sine");
    let mut swapped = plan.pose_times_s.clone();
    let (first, last) = (plan.ordering.order[0], *plan.ordering.order.last().unwrap());
    swapped.swap(first, last);
    let (_, max_m, _) = executed(&plan.trajectory, &poses, &swapped);
    assert!(max_m > 10.0 * POSE_M, "{max_m}");
    // w, x, y, z read as x, y, z, w is another rotation.
    let mut misread = poses.clone();
    for pose in &mut misread {
        let [x, y, z, w] = planner::se3_geom::xyzw_from_rotation(&pose.rotation);
        pose.rotation = planner::se3_geom::rotation_from_xyzw([w, x, y, z]).unwrap();
    }
    let (_, _, max_rad) = executed(&plan.trajectory, &misread, &plan.pose_times_s);
    assert!(max_rad > 10.0 * POSE_RAD, "{max_rad}");
}
