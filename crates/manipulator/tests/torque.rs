//! Effort limits: kept where they are what limits, refused by name where an arm is too weak.
#![allow(clippy::unwrap_used)]

mod support;

use manipulator::nalgebra::DVector;
use manipulator::{
    AuditRules, JointLimits, JointPath, ManipulatorError, Robot, TimingOptions, audit_under, rest_to_rest, time_path,
};
use support::{Random, random_path, ur5e};

#[test]
fn torque_limits_hold_where_they_are_what_limits() {
    let mut robot = Robot::shipped("panda").unwrap();
    let mut random = Random(83);
    let path = random_path(&robot, 0.5, 40, &mut random);
    robot.limits.lower.fill(-10.0);
    robot.limits.upper.fill(10.0);
    // Without gravity, so that the least effort is a matter of speed alone.
    let yaml = include_str!("../../../config/robots/panda.yaml");
    robot.dynamics = Robot::shipped_with("panda", &format!("gravity_m_s2: [0, 0, 0]\n{yaml}")).unwrap().dynamics;
    for limits in [JointLimits::Jerk, JointLimits::Acceleration] {
        let options = TimingOptions { limits, ..TimingOptions::default() };
        robot.limits.effort.fill(1e3);
        let strong = time_path(&robot, &path, &options).unwrap();
        let peak = 1e3 * strong.audit.max_ratio.torque.unwrap();
        robot.limits.effort.fill(0.5 * peak);
        let weak = time_path(&robot, &path, &options).unwrap();
        let ratio = weak.audit.max_ratio;
        assert!(weak.audit.limits_ok && ratio.torque.unwrap() <= 1.0 && ratio.torque.unwrap() > 0.95, "{ratio:?}");
        // Half the torque: at most √2 slower where all of it moves links, which a uniform slowdown would cost.
        let slower = weak.trajectory.duration_s() / strong.trajectory.duration_s();
        assert!(slower > 1.0 && slower < 1.3, "{slower}");
        let ignored = time_path(&robot, &path, &TimingOptions { torque: false, ..options }).unwrap();
        assert!(ignored.audit.limits_ok && ignored.audit.max_ratio.torque.unwrap() > 1.5);
    }
}

#[test]
fn an_arm_too_weak_to_hold_itself_is_refused_by_name() {
    let mut robot = ur5e();
    robot.limits.effort[1] = 5.0;
    let mut random = Random(89);
    let path = random_path(&robot, 0.5, 40, &mut random);
    let refused = time_path(&robot, &path, &TimingOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("hold the arm still near pose"), "{refused}");
    let path_place = assert_too_weak(&robot, refused);
    let poses = path.pose_parameters();
    let nearest = &path.at(poses[path_place.0.unwrap()])[0];
    let spacing = poses.windows(2).map(|pair| (&path.at(pair[1])[0] - &path.at(pair[0])[0]).amax()).fold(0.0, f64::max);
    assert!((nearest - &path_place.1).amax() <= spacing, "the pose is not the nearest");

    let (from, to) = (DVector::zeros(6), DVector::from_element(6, -0.1));
    let refused = rest_to_rest(&robot, &from, &to, &TimingOptions::default()).unwrap_err();
    let message = refused.to_string();
    assert!(message.contains("\"shoulder_lift_joint\" needs") && message.contains("more than its limit"), "{message}");
    let (pose, at) = assert_too_weak(&robot, refused);
    assert!(pose.is_none() && (0..6).all(|j| at[j] <= 1e-12 && at[j] >= -0.1 - 1e-12), "{at}");
}

/// Dry friction hinders who lifts and helps who lowers: it is no reason to refuse what goes down, and none to say that the arm falls.
#[test]
fn dry_friction_counts_against_the_motion_only() {
    let urdf = include_str!("../../../config/robots/ur5e.urdf");
    let limit =
        r#"<limit lower="-6.283185307179586" upper="6.283185307179586" effort="150" velocity="3.141592653589793"/>"#;
    // The second such line is that of the shoulder's lift.
    let (pan, rest) = urdf.split_at(urdf.find(limit).unwrap() + limit.len());
    let rubbing = rest.replacen(limit, &format!("{limit}<dynamics friction=\"20\"/>"), 1);
    let mut robot =
        Robot::from_urdf(&format!("{pan}{rubbing}"), include_str!("../../../config/robots/ur5e.yaml")).unwrap();
    let dynamics = robot.dynamics.clone().unwrap();
    assert_eq!(dynamics.drives().map(|drive| drive.friction_n_m).collect::<Vec<_>>(), [0.0, 20.0, 0.0, 0.0, 0.0, 0.0]);
    // The arm stretched out, level at 0 and above that at negative angles, so that gravity loads the joint all the way.
    let at = |lift: f64| DVector::from_column_slice(&[0.0, lift, 0.0, 0.0, 0.0, 0.0]);
    let held = |lift: f64| {
        let mut torque = [0.0; 6];
        dynamics.torque(at(lift).as_slice(), &[0.0; 6], &[0.0; 6], &mut torque);
        torque[1].abs()
    };
    let (high, low) = (-0.6, -0.3);
    assert!(held(high) > 20.0 && held(low) > held(high), "{} {}", held(high), held(low));
    robot.limits.effort[1] = held(low) + 10.0;
    let options = TimingOptions::default();
    let down = rest_to_rest(&robot, &at(high), &at(low), &options).unwrap();
    assert!(audit_under(&robot, &down, AuditRules::default(), None).limits_ok);
    let end = |rise: f64| manipulator::EndDerivatives { first: at(rise), second: DVector::zeros(6) };
    let path = |from: f64, to: f64| {
        let ends = end(to - from);
        JointPath::through(&[0.0, 1.0], &[at(from), at(to)], [&ends, &ends]).unwrap()
    };
    for limits in [JointLimits::Jerk, JointLimits::Acceleration] {
        let options = TimingOptions { limits, ..options.clone() };
        assert!(time_path(&robot, &path(high, low), &options).unwrap().audit.limits_ok);
    }
    for refused in [
        rest_to_rest(&robot, &at(low), &at(high), &options).unwrap_err(),
        time_path(&robot, &path(low, high), &options).unwrap_err(),
    ] {
        let message = refused.to_string();
        let ManipulatorError::HoldingTorque { moving: true, needed, effort, unit: "N·m", .. } = refused else {
            panic!("{message}")
        };
        assert!(needed > effort && needed <= held(low) + 20.0 + 1e-9, "{message}");
        assert!(message.contains("to move the arm against gravity and dry friction"), "{message}");
    }
    // Exactly as much as there is: nothing is left to move with, and it is not "0 more".
    robot.dynamics = ur5e().dynamics;
    robot.limits.effort[1] = held(low);
    let message = rest_to_rest(&robot, &at(low), &at(high), &options).unwrap_err().to_string();
    assert!(message.contains("to hold the arm still") && message.ends_with("all that its limit allows"), "{message}");
}

/// The pose and the configuration that a refusal names; the joint does need that much there, by the dynamics themselves.
fn assert_too_weak(robot: &Robot, refused: ManipulatorError) -> (Option<usize>, DVector<f64>) {
    let ManipulatorError::HoldingTorque { joint, pose, configuration, needed, effort, .. } = refused else {
        panic!("{refused}")
    };
    assert!(joint == "shoulder_lift_joint" && needed > 5.0 && effort == 5.0);
    let mut torque = [0.0; 6];
    robot.dynamics.as_ref().unwrap().torque(&configuration, &[0.0; 6], &[0.0; 6], &mut torque);
    // The same function at the same place; friction of this arm is none.
    assert_eq!(torque[1].abs(), needed);
    (pose, DVector::from_vec(configuration))
}
