//! What an audit finds, and says.
#![allow(clippy::unwrap_used)]

use manipulator::nalgebra::DVector;
use manipulator::{AuditRules, JointTrajectory, Robot, TimingOptions, audit, audit_under, rest_to_rest};

/// Points so large that the polynomial between them overflows, and joints under other names, are not legal.
#[test]
fn what_cannot_be_judged_does_not_pass_the_audit() {
    let robot = Robot::shipped("ur5e").unwrap();
    let from = DVector::from_element(6, -1.0);
    let legal = rest_to_rest(&robot, &from, &from.add_scalar(0.2), &TimingOptions::default()).unwrap();
    assert!(audit(&robot, &legal).limits_ok);
    let middle = legal.points.len() / 2;
    let huge = 1.7e308;
    let mut position = legal.clone();
    position.points[middle].positions[2] = huge;
    let mut velocity = legal.clone();
    velocity.points[middle].velocities[2] = huge;
    let mut acceleration = legal.clone();
    acceleration.points[middle].accelerations[2] = huge;
    let mut reversed = legal.clone();
    reversed.joint_names.reverse();
    for wrong in [position, velocity, acceleration, reversed] {
        let found = audit(&robot, &wrong);
        assert!(!found.limits_ok && found.max_ratio.jerk > 1.0, "{found:?}");
        assert_ne!(found.faults(&AuditRules::default()), "");
    }
}

/// Each fault is told by itself, by how much and of what limit; what does not count is not told.
#[test]
fn an_audit_says_in_words_what_is_wrong() {
    let robot = Robot::shipped("ur5e").unwrap();
    let from = DVector::from_element(6, -1.0);
    let legal = rest_to_rest(&robot, &from, &from.add_scalar(0.2), &TimingOptions::default()).unwrap();
    let words = |trajectory: &JointTrajectory, rules: AuditRules| {
        let found = audit_under(&robot, trajectory, rules, None);
        assert_eq!(found.limits_ok, found.faults(&rules).is_empty());
        found.faults(&rules)
    };
    let all = AuditRules::default();
    assert_eq!(words(&legal, all), "");
    let quick = AuditRules { tool_speed_m_s: Some(0.01), ..all };
    assert!(words(&legal, quick).starts_with("the tool's speed goes "));
    assert!(words(&legal, quick).ends_with(" % above its limit of 0.01 m/s"));
    let mut faster = legal.clone();
    // Time runs faster by a tenth: the jerk, which this move is bounded by, grows by a third.
    for point in &mut faster.points {
        point.time_s /= 1.1;
        point.velocities.iter_mut().for_each(|v| *v *= 1.1);
        point.accelerations.iter_mut().for_each(|a| *a *= 1.21);
    }
    let found = words(&faster, all);
    let percent: f64 = found.split(' ').nth(4).unwrap().parse().unwrap();
    assert!(found.starts_with("a joint's jerk goes 33.0") && (percent - 33.1).abs() < 0.1, "{found}");
    assert_eq!(words(&faster, AuditRules { jerk: false, ..all }), "");
    let mut unfinished = legal.clone();
    unfinished.points.pop();
    assert_eq!(words(&unfinished, all), "it does not begin as it must or does not end at rest");
    let mut beyond = legal;
    for point in &mut beyond.points {
        point.positions[2] += std::f64::consts::PI;
    }
    assert_eq!(words(&beyond, all), "");
    for point in &mut beyond.points {
        point.positions[2] += 1.0;
    }
    // From -1 + π + 1 on it rises by 0.2.
    assert_eq!(words(&beyond, all), "a joint goes 0.2000 rad (or m) beyond a position limit");
}
