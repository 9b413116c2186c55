//! The controller without simulation: what it plays, and what it refuses.

use manipulator::rest_to_rest;

use super::*;

const HOME: [f64; 6] = [-1.57, -1.57, 1.57, -1.57, -1.57, 0.0];
const STEP_S: f64 = 0.002;

fn controller() -> Controller {
    Controller::at_rest(Robot::shipped("ur5e").unwrap(), &HOME)
}

/// One rad of the first joint.
fn swing(from: f64, to: f64) -> JointTrajectory {
    let place = |first: f64| {
        let mut q = HOME;
        q[0] = first;
        DVector::from_column_slice(&q)
    };
    let robot = Robot::shipped("ur5e").unwrap();
    rest_to_rest(&robot, &place(from), &place(to), &TimingOptions::default()).unwrap()
}

/// The greatest steps of position and velocity of the first joint over some time.
fn roughness(controller: &Controller, from_s: f64, to_s: f64) -> [f64; 2] {
    let steps = ((to_s - from_s) / STEP_S) as usize;
    let at = |step: usize| controller.at(from_s + step as f64 * STEP_S);
    let mut worst = [0.0_f64; 2];
    for step in 0..steps {
        let (a, b) = (at(step), at(step + 1));
        worst[0] = worst[0].max((a[0][0] - b[0][0]).abs());
        worst[1] = worst[1].max((a[1][0] - b[1][0]).abs());
    }
    worst
}

#[test]
fn a_trajectory_is_played_from_its_stamp_on() {
    let mut controller = controller();
    let trajectory = swing(HOME[0], HOME[0] + 1.0);
    let duration_s = trajectory.duration_s();
    controller.play(1.0, Some(2.0), trajectory.clone()).unwrap();
    assert_eq!(controller.at(1.9)[0].as_slice(), HOME);
    assert!((controller.at(2.0 + duration_s)[0][0] - HOME[0] - 1.0).abs() < 1e-12);
    assert!((controller.ends_at_s() - 2.0 - duration_s).abs() < 1e-9);
    assert_eq!(controller.goal()[0], HOME[0] + 1.0);
    // In the middle, as the trajectory has it.
    let expected = trajectory.at(0.5 * duration_s)[1][0];
    assert!((controller.at(2.0 + 0.5 * duration_s)[1][0] - expected).abs() < 1e-9);
}

#[test]
fn a_stop_is_smooth_and_short_of_the_goal() {
    let mut controller = controller();
    let trajectory = swing(HOME[0], HOME[0] + 1.0);
    let middle_s = 0.5 * trajectory.duration_s();
    controller.play(0.0, None, trajectory).unwrap();
    let before = controller.at(middle_s);
    controller.stop(middle_s);
    let after = controller.at(middle_s);
    assert_eq!(after[..2], before[..2]);
    let goal = controller.goal()[0];
    assert!(goal > HOME[0] + 0.3 && goal < HOME[0] + 0.95, "{goal}");
    let [position, velocity] = roughness(&controller, middle_s, controller.ends_at_s());
    // At most the arm's 3.14 rad/s and 5 rad/s² (config/robots/ur5e.yaml) over a step.
    assert!(position < 3.15 * STEP_S && velocity < 5.1 * STEP_S, "{position} {velocity}");
}

/// From elsewhere come trajectories that break limits; they too have to stop when they are told.
#[test]
fn what_breaks_limits_stops_as_well() {
    let mut controller = controller();
    let mut hasty = swing(HOME[0], HOME[0] + 1.0);
    // Three times as fast: nine times the acceleration, 45 rad/s².
    for point in &mut hasty.points {
        point.time_s /= 3.0;
        point.velocities.iter_mut().for_each(|v| *v *= 3.0);
        point.accelerations.iter_mut().for_each(|a| *a *= 9.0);
    }
    let middle_s = 0.5 * hasty.duration_s();
    controller.play(0.0, None, hasty).unwrap();
    let before = controller.at(middle_s);
    controller.stop(middle_s);
    let after = controller.at(middle_s);
    assert!((after[0][0] - before[0][0]).abs() < 1e-12 && (after[1][0] - before[1][0]).abs() < 1e-12);
    let ends_at_s = controller.ends_at_s();
    assert!(controller.at(ends_at_s)[1].amax() < 1e-12);
    let goal = controller.goal()[0];
    assert!(goal < HOME[0] + 0.95, "{goal}");
    let [position, velocity] = roughness(&controller, middle_s, ends_at_s);
    // No faster than it was; what the trajectory decelerates itself and what its slowing clock adds are at most 45 rad/s² each.
    assert!(position <= before[1][0].abs() * STEP_S * 1.001 && velocity < 90.0 * STEP_S, "{position} {velocity}");
}

#[test]
fn a_trajectory_begins_at_rest_or_at_once() {
    let mut late = swing(HOME[0], HOME[0] + 1.0);
    // As if its first half was cut off, and its times not set back.
    late.points.drain(..late.points.len() / 2);
    let why = controller().play(0.0, None, late).unwrap_err().to_string();
    assert_eq!(why, "nothing leads to the speed of the first point, whose time is not 0");
}

/// On the way a trajectory takes over only where it has the arm's state.
#[test]
fn jumps_are_refused_and_change_nothing() {
    let mut controller = controller();
    let first = swing(HOME[0], HOME[0] + 1.0);
    let middle_s = 0.5 * first.duration_s();
    controller.play(0.0, None, first.clone()).unwrap();
    let before = controller.at(middle_s);
    let why = controller.play(middle_s, None, swing(HOME[0], HOME[0] - 1.0)).unwrap_err().to_string();
    assert!(why.starts_with("shoulder_pan_joint would begin with a jump of its position by"), "{why}");
    let there = before[0][0];
    let why = controller.play(middle_s, None, swing(there, there + 0.5)).unwrap_err().to_string();
    assert!(why.contains("velocity"), "{why}");
    assert_eq!(controller.at(middle_s), before);
    // What is left of it, by its stamp, does.
    controller.play(middle_s, Some(0.0), first).unwrap();
    assert!((controller.at(middle_s)[0][0] - there).abs() < 1e-12);
}

#[test]
fn what_is_no_trajectory_for_the_arm_is_refused() {
    let mut controller = controller();
    let good = swing(HOME[0], HOME[0] + 0.1);
    let mut refused = |change: fn(&mut JointTrajectory)| {
        let mut bad = good.clone();
        change(&mut bad);
        controller.play(0.0, None, bad).unwrap_err()
    };
    assert!(matches!(refused(|t| t.joint_names[0] = "elbow".into()), Refused::Joints(_)));
    assert!(matches!(refused(|t| t.joint_names.push("seventh".into())), Refused::Joints(_)));
    for change in [
        (|t| t.points.clear()) as fn(&mut JointTrajectory),
        |t| t.points[1].positions[2] = f64::NAN,
        |t| t.points[1].accelerations.clear(),
        |t| t.points[1].time_s = 0.0,
        |t| {
            let middle = t.points.len() / 2;
            t.points.truncate(middle);
        },
    ] {
        assert!(matches!(refused(change), Refused::Goal(_)));
    }
    let ended = controller.play(100.0, Some(1.0), good).unwrap_err();
    assert!(matches!(ended, Refused::Old { ago_s } if ago_s > 90.0), "{ended}");
}
