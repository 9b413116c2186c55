//! What users of other tools complain about in timing, and the limits beside velocity, acceleration and jerk.
#![allow(clippy::unwrap_used)]

mod support;

use manipulator::nalgebra::{DVector, Translation3, Vector3};
use manipulator::{
    AuditRules, JointLimits, JointPath, ManipulatorError, PathOptions, Robot, TimedPath, TimingOptions, audit_under,
    follow, time_path,
};
use support::curves::{spline, writing};
use support::{Random, random_path, ur5e};

fn without_jerk() -> TimingOptions {
    TimingOptions { limits: JointLimits::Acceleration, ..TimingOptions::default() }
}

fn written(robot: &Robot) -> JointPath {
    follow(robot, &spline(&writing(robot, 60)), Some(&robot.preferred), &PathOptions::default()).unwrap()
}

/// Speeds and accelerations of the tool by differences of its executed positions, ten times a published step.
fn tool_by_differences(robot: &Robot, timed: &TimedPath) -> Vec<(f64, f64)> {
    let step = 0.1 * timed.trajectory.points[1].time_s;
    let count = 10 * (timed.trajectory.points.len() - 1);
    let places: Vec<Vector3<f64>> =
        (0..=count).map(|k| robot.chain.forward(&timed.trajectory.at(k as f64 * step)[0]).translation.vector).collect();
    places
        .windows(3)
        .map(|p| ((p[2] - p[0]).norm() / (2.0 * step), (p[2] - p[1] * 2.0 + p[0]).norm() / (step * step)))
        .collect()
}

fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// moveit2 #2600, #3565 and toppra #150: 200 rad/s² were published where 0.2 was the limit.
#[test]
fn limits_are_not_broken_after_timing() {
    for name in Robot::shipped_names() {
        let robot = Robot::shipped(name).unwrap();
        let mut random = Random(71);
        for waves in [0.7, 2.0] {
            let path = random_path(&robot, waves, 60, &mut random);
            for options in [TimingOptions::default(), without_jerk()] {
                // These paths swing through positions beyond the limits of some arms, which the timing says.
                match time_path(&robot, &path, &options) {
                    Ok(timed) => {
                        assert!(timed.audit.limits_ok, "{name}: {:?}", timed.audit);
                        assert!(timed.audit.max_ratio.torque.unwrap() <= 1.0);
                        assert_eq!(timed.audit, audit_under(&robot, &timed.trajectory, options.audit_rules(), None));
                    }
                    Err(refused @ ManipulatorError::LimitsNotMet { .. }) => {
                        assert!(refused.to_string().contains("beyond a position limit"), "{name}: {refused}")
                    }
                    Err(other) => panic!("{name}: {other}"),
                }
            }
        }
    }
}

/// moveit2 #2741: equal stamps make controllers reject a trajectory.
#[test]
fn stamps_are_never_equal() {
    let robot = ur5e();
    let mut random = Random(73);
    for rate_hz in [10.0, 333.0, 10_000.0] {
        for options in
            [TimingOptions { rate_hz, ..without_jerk() }, TimingOptions { rate_hz, ..TimingOptions::default() }]
        {
            let path = random_path(&robot, 0.3, 30, &mut random);
            let timed = time_path(&robot, &path, &options).unwrap();
            assert!(timed.audit.times_increase);
            let stamps: Vec<u64> = timed.trajectory.points.iter().map(|p| (p.time_s * 1e9).round() as u64).collect();
            assert!(stamps.windows(2).all(|pair| pair[1] > pair[0]));
        }
    }
}

/// toppra #9 and noether #218: what is executed between points leaves the path. Each joint of this path only ever rises.
#[test]
fn executed_motion_does_not_overshoot_the_path() {
    let robot = ur5e();
    let from = DVector::from_element(6, -1.0);
    let path = {
        let end = manipulator::EndDerivatives { first: DVector::from_element(6, 1.0), second: DVector::zeros(6) };
        let parameters = [0.0, 0.5, 1.0, 1.5, 2.0];
        JointPath::through(&parameters, &parameters.map(|s| from.add_scalar(s)), [&end, &end]).unwrap()
    };
    for options in [TimingOptions::default(), without_jerk()] {
        let timed = time_path(&robot, &path, &options).unwrap();
        let duration = timed.trajectory.duration_s();
        let mut before = f64::NEG_INFINITY;
        for k in 0..=5000 {
            let [q, rates, ..] = timed.trajectory.at(duration * f64::from(k) / 5000.0);
            assert!(q[0] >= -1.0 - 1e-12 && q[0] <= 1.0 + 1e-12 && q[0] >= before - 1e-12 && rates[0] >= -1e-9);
            before = q[0];
        }
    }
}

#[test]
fn without_jerk_limits_motion_is_faster_and_the_audit_says_why() {
    let robot = ur5e();
    let mut random = Random(79);
    let path = random_path(&robot, 1.0, 60, &mut random);
    let smooth = time_path(&robot, &path, &TimingOptions::default()).unwrap();
    let fast = time_path(&robot, &path, &without_jerk()).unwrap();
    assert!(fast.trajectory.duration_s() < smooth.trajectory.duration_s());
    let ratio = fast.audit.max_ratio;
    assert!(
        fast.audit.limits_ok && ratio.velocity <= 1.0 && ratio.acceleration <= 1.0 && ratio.jerk > 2.0,
        "{ratio:?}"
    );
    assert!(!audit_under(&robot, &fast.trajectory, AuditRules::default(), None).limits_ok);
    // The averaging over a step and the audit's corrections: 0.01 s and a few parts in a thousand.
    let excess = fast.trajectory.duration_s() / fast.second_order_duration_s;
    assert!(excess > 1.0 - 1e-3 && excess < 1.02, "{excess}");
}

#[test]
fn tool_speed_and_acceleration_stay_below_their_limits() {
    let robot = ur5e();
    let path = written(&robot);
    for limits in [JointLimits::Jerk, JointLimits::Acceleration] {
        let options = TimingOptions {
            limits,
            tool_speed_m_s: Some(0.1),
            tool_acceleration_m_s2: Some(0.3),
            ..TimingOptions::default()
        };
        let timed = time_path(&robot, &path, &options).unwrap();
        let seen = tool_by_differences(&robot, &timed);
        let (speed, acceleration) = (greatest(seen.iter().map(|s| s.0)), greatest(seen.iter().map(|s| s.1)));
        // Second differences over 1 ms see rounding of 1e-16/1e-6.
        assert!(speed <= 0.1 + 1e-6 && acceleration <= 0.3 + 1e-6, "{speed} m/s, {acceleration} m/s²");
        assert!(speed > 0.097 && acceleration > 0.27, "{speed} m/s, {acceleration} m/s²");
    }
}

#[test]
fn constant_tool_speed_is_held_between_ramps_or_refused_with_what_can_be_held() {
    let robot = ur5e();
    let path = written(&robot);
    let timing = |speed: f64| {
        let options = TimingOptions { constant_tool_speed_m_s: Some(speed), ..TimingOptions::default() };
        time_path(&robot, &path, &options)
    };
    let assert_held = |timed: &TimedPath, speed: f64| {
        let seen = tool_by_differences(&robot, timed);
        let fast = |s: &(f64, f64)| s.0 >= 0.99 * speed;
        let (from, to) = (seen.iter().position(fast).unwrap(), seen.iter().rposition(fast).unwrap());
        assert!(seen[from..=to].iter().all(|s| (s.0 / speed - 1.0).abs() < 0.0101));
        to - from
    };
    let timed = timing(0.05).unwrap();
    let held = assert_held(&timed, 0.05);
    assert!(held * 2 > timed.trajectory.points.len() * 10, "the ramps take more than half");
    match timing(2.0).unwrap_err() {
        ManipulatorError::ConstantSpeed { wanted_m_s, greatest_m_s, pose } => {
            assert!(
                wanted_m_s == 2.0 && greatest_m_s > 0.05 && greatest_m_s < 2.0 && pose.is_none_or(|pose| pose < 60)
            );
            println!("{greatest_m_s} m/s at pose {pose:?}");
            assert_held(&timing(greatest_m_s).unwrap(), greatest_m_s);
        }
        other => panic!("{other}"),
    }
}

/// On a short path the ramps meet before a high speed is reached: that is not a matter of some pose, and touching is not holding.
#[test]
fn a_path_of_ramps_alone_holds_no_constant_speed() {
    let robot = ur5e();
    let home = robot.chain.forward(&robot.preferred);
    let line = |i: usize| Translation3::new(0.0, 0.0, 0.002 * i as f64) * home;
    let curve = spline(&(0..15).map(line).collect::<Vec<_>>());
    let path = follow(&robot, &curve, Some(&robot.preferred), &PathOptions::default()).unwrap();
    let timing = |limits: JointLimits, speed: f64| {
        let options = TimingOptions { limits, constant_tool_speed_m_s: Some(speed), ..TimingOptions::default() };
        time_path(&robot, &path, &options)
    };
    for limits in [JointLimits::Jerk, JointLimits::Acceleration] {
        let refused = timing(limits, 5.0).unwrap_err();
        let message = refused.to_string();
        let ManipulatorError::ConstantSpeed { pose: None, greatest_m_s, .. } = refused else { panic!("{message}") };
        assert!(message.contains("ramps up and down, which fill the path"), "{message}");
        let mut held = 0;
        for part in [0.8, 1.0, 1.1, 1.15, 1.165, 1.18, 1.2, 1.3] {
            let speed = part * greatest_m_s;
            let Ok(timed) = timing(limits, speed) else {
                assert!(part > 1.0, "{limits:?}: {greatest_m_s} m/s cannot be held after all");
                continue;
            };
            let seen = tool_by_differences(&robot, &timed);
            let fast = |s: &(f64, f64)| s.0 >= 0.99 * speed;
            let (from, to) = (seen.iter().position(fast).unwrap(), seen.iter().rposition(fast).unwrap());
            // Differences see the speed a place late.
            assert!(to - from + 2 > from.min(seen.len() - to) / 5, "{limits:?}, {part}: touched from {from} to {to}");
            held += 1;
        }
        assert!(held < 8, "{limits:?}: no speed was too high: the test shows nothing");
    }
}

#[test]
fn near_straight_and_tiny_moves_are_timed_under_every_option() {
    let robot = ur5e();
    let base = DVector::from_fn(6, |j, _| -0.5 - 0.1 * j as f64);
    for length in [1.0, 2e-3, 1.1e-3, 0.9e-3, 1e-6] {
        for bend in [0.0, 1e-9, 1e-4] {
            let values: Vec<_> = (0..9)
                .map(|i| {
                    let s = f64::from(i) / 8.0;
                    &base + DVector::from_fn(6, |j, _| length * (s + bend * (5.0 * s + j as f64).sin()))
                })
                .collect();
            let parameters: Vec<f64> = (0..9).map(|i| f64::from(i) / 8.0).collect();
            let end =
                manipulator::EndDerivatives { first: DVector::from_element(6, length), second: DVector::zeros(6) };
            let path = JointPath::through(&parameters, &values, [&end, &end]).unwrap();
            for options in [TimingOptions::default(), without_jerk()] {
                let options = TimingOptions { tool_speed_m_s: Some(0.2), tool_acceleration_m_s2: Some(1.0), ..options };
                let timed = time_path(&robot, &path, &options).unwrap();
                assert!(timed.audit.limits_ok, "{length} {bend}: {:?}", timed.audit);
            }
        }
    }
}

#[test]
fn options_out_of_range_are_refused_by_name() {
    let path = random_path(&ur5e(), 0.5, 40, &mut Random(97));
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for (name, options) in [
            ("tool_speed_m_s", TimingOptions { tool_speed_m_s: Some(value), ..TimingOptions::default() }),
            (
                "tool_acceleration_m_s2",
                TimingOptions { tool_acceleration_m_s2: Some(value), ..TimingOptions::default() },
            ),
            (
                "constant_tool_speed_m_s",
                TimingOptions { constant_tool_speed_m_s: Some(value), ..TimingOptions::default() },
            ),
        ] {
            let refused = time_path(&ur5e(), &path, &options).unwrap_err();
            assert!(
                matches!(refused, ManipulatorError::InvalidOption { name: named, .. } if named == name),
                "{refused}"
            );
        }
    }
}
