//! One trajectory takes over from another while the arm moves, in simulation: it follows across the switch as anywhere else.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use mujoco_sim::planner::manipulator::Robot;
use mujoco_sim::planner::manipulator::nalgebra::Vector3;
use mujoco_sim::planner::se3_geom::Pose;
use mujoco_sim::planner::{Config, Handover, Request, plan};
use mujoco_sim::{ExecuteOptions, SimulatedArm, TOOL_SITE, model_file};

#[test]
fn every_arm_goes_over_to_a_new_curve_while_it_moves() {
    for name in Robot::shipped_names() {
        let robot = Robot::shipped(name).unwrap();
        let start = Some(robot.preferred.as_slice().to_vec());
        let first = Request { poses: arc(&robot, 0.08), start, ..Request::default() };
        let first = Arc::new(plan(&robot, &Config::default(), &first).unwrap().trajectory);
        let at_s = (0.5e9 * first.duration_s()).round() * 1e-9;
        let handover = Handover { trajectory: Arc::clone(&first), at_s };
        let poses = arc(&robot, -0.05);
        let request = Request { poses: poses.clone(), handover: Some(handover), ..Request::default() };
        let second = plan(&robot, &Config::default(), &request).unwrap();
        let switch = first.at(at_s);
        assert!(switch[1].amax() > 0.05, "{name} moves when it is told: {}", switch[1]);
        let executed = first.switched(at_s, &second.trajectory);

        let mut arm = SimulatedArm::load(model_file(name).unwrap(), TOOL_SITE).unwrap();
        let every_step = ExecuteOptions { sample_rate_hz: 1e4, ..ExecuteOptions::default() };
        let execution = arm.execute(&executed, &every_step).unwrap();
        let times_s: Vec<f64> = second.pose_times_s.iter().map(|time_s| at_s + time_s).collect();
        let errors = execution.pose_errors(&poses, &times_s).unwrap();
        // From step to step an acceleration changes by the jerk limit times the step, across the switch too. A jump of a tenth of
        // 1 rad/s² within a step of 2 ms would be 50 rad/s³. A tenth is left to the servo.
        let h = execution.timestep_s;
        let jump = execution.samples.windows(3).map(|three| {
            let [before, now, after] = [&three[0].velocity, &three[1].velocity, &three[2].velocity];
            ((after - now * 2.0 + before) / h).component_div(&(&robot.limits.jerk * h)).amax()
        });
        let jump = jump.fold(0.0, f64::max);
        println!("{name}: {:.1e} rad, {errors:?}, jerk {jump:.2} of its limit", execution.tracking_max_rad);
        assert!(
            execution.tracking_max_rad <= 0.01 && execution.contacts.is_empty(),
            "{name}: {:?}",
            execution.contacts
        );
        assert!(errors.max_m <= 2e-3 && errors.max_rad <= 0.02, "{name}: {errors:?}");
        assert!(jump <= 1.1, "{name}: jerk is {jump} of its limit");
    }
}

/// Part of a circle before the arm, aside by its radius.
fn arc(robot: &Robot, radius_m: f64) -> Vec<Pose> {
    let home = robot.chain.forward(&robot.preferred);
    let at = |i: i32| {
        let angle = 0.08 * f64::from(i);
        let mut pose = home;
        pose.translation.vector += radius_m * Vector3::new(1.0 - angle.cos(), angle.sin(), 0.3 * angle.sin());
        pose
    };
    (0..30).map(at).collect()
}
