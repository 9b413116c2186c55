//! From poses in any order to the tool passing each of them, in simulation.

use mujoco_sim::planner::manipulator::Robot;
use mujoco_sim::planner::manipulator::nalgebra::{UnitQuaternion, Vector3};
use mujoco_sim::planner::se3_geom::Pose;
use mujoco_sim::planner::{Config, Request, plan};
use mujoco_sim::{ExecuteOptions, SimulatedArm, TOOL_SITE, model_file};

#[test]
fn the_ur5e_takes_its_tool_through_every_pose() {
    assert_takes_its_tool_through_every_pose("ur5e");
}

#[test]
fn the_viperx_takes_its_tool_through_every_pose() {
    assert_takes_its_tool_through_every_pose("vx300s");
}

#[test]
fn the_panda_takes_its_tool_through_every_pose() {
    assert_takes_its_tool_through_every_pose("panda");
}

fn assert_takes_its_tool_through_every_pose(name: &str) {
    let robot = Robot::shipped(name).expect("it is shipped");
    let first = robot.chain.forward(&robot.preferred);
    // Half a circle of 8 cm radius with the tool swinging along, its 24 poses dealt out by a stride coprime to their number.
    const COUNT: usize = 24;
    let poses: Vec<Pose> = (0..COUNT)
        .map(|i| {
            let angle = std::f64::consts::PI * ((i * 7) % COUNT) as f64 / COUNT as f64;
            let mut pose = first;
            pose.translation.vector += 0.08 * Vector3::new(1.0 - angle.cos(), angle.sin(), 0.3 * angle.sin());
            pose.rotation *= UnitQuaternion::from_scaled_axis(Vector3::new(0.2, -0.3, 0.1) * angle.sin());
            pose
        })
        .collect();
    let request =
        Request { poses: poses.clone(), start: Some(robot.preferred.as_slice().to_vec()), ..Request::default() };
    let plan = plan(&robot, &Config::default(), &request).expect("an easy curve within reach");
    assert!(plan.audit.limits_ok);

    let mut arm =
        SimulatedArm::load(model_file(name).expect("a known name"), TOOL_SITE).expect("the set-up has fetched it");
    let execution = arm.execute(&plan.trajectory, &ExecuteOptions::default()).expect("the same joints");
    let errors = execution.pose_errors(&poses, &plan.pose_times_s).expect("times within the run");
    println!(
        "{name}: {:.2} s, {:.1e} rad, {:.1e} m, {:.1e} rad, torque {:.2}",
        execution.duration_s, execution.tracking_max_rad, errors.max_m, errors.max_rad, execution.max_torque_ratio
    );
    assert!(execution.tracking_max_rad < 0.01, "{} rad", execution.tracking_max_rad);
    assert!(errors.max_m < 0.002 && errors.max_rad < 0.02, "{errors:?}");
    // The plan's own error and what tracking adds, over arms of at most 1.3 m and seven joints.
    let tracking_m = 7.0 * 1.3 * execution.tracking_max_rad;
    assert!((errors.max_m - plan.pose_error_max_m).abs() < tracking_m + 1e-5, "{errors:?}");
    assert!(execution.contacts.is_empty() && execution.saturated_steps == 0 && execution.max_torque_ratio < 0.9);

    // One pose later than planned for, everything is missed: the order and the times are those of the poses.
    let mut rotated = plan.pose_times_s.clone();
    rotated.rotate_left(1);
    assert!(execution.pose_errors(&poses, &rotated).expect("the same times").max_m > 0.01);
}
