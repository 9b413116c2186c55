//! Trajectories: legal, continuous, at rest at both ends, on the path.
#![allow(clippy::unwrap_used)]

mod support;

use manipulator::nalgebra::DVector;
use manipulator::{
    EndDerivatives, JointPath, JointTrajectory, ManipulatorError, PathOptions, Robot, TimingOptions, audit, follow,
    least_duration_s, rest_to_rest, time_path, uncorrected_duration_s,
};
use support::curves::{spline, writing};
use support::{Random, random_configuration, random_path, ur5e};

/// Peak over limit on ten places an interval, by differences of the executed positions alone: knows nothing of the audit's algebra.
fn ratios_by_differences(robot: &Robot, trajectory: &JointTrajectory) -> [f64; 3] {
    let mut worst = [0.0_f64; 3];
    let (times, limits) = (&trajectory.points, &robot.limits);
    for pair in times.windows(2) {
        let d = 0.05 * (pair[1].time_s - pair[0].time_s);
        for k in 2..=18 {
            let t = pair[0].time_s + d * f64::from(k);
            let [a, b, c, e] = [-1.5, -0.5, 0.5, 1.5].map(|m| trajectory.at(t + m * d)[0].clone());
            let slopes =
                [(&c - &b) / d, (&e - &c - &b + &a) / (2.0 * d * d), (e - c * 3.0 + b * 3.0 - a) / (d * d * d)];
            let bounds = [&limits.velocity, &limits.acceleration, &limits.jerk];
            for ((ratio, slope), bound) in worst.iter_mut().zip(slopes).zip(bounds) {
                *ratio = ratio.max(slope.component_div(bound).amax());
            }
        }
    }
    worst
}

fn assert_executable(robot: &Robot, trajectory: &JointTrajectory) {
    let report = audit(robot, trajectory);
    let ratio = report.max_ratio;
    assert!(report.limits_ok && report.times_increase && report.starts_and_ends_at_rest, "{report:?}");
    assert!(ratio.velocity <= 1.0 && ratio.acceleration <= 1.0 && ratio.jerk <= 1.0 && report.position_margin >= 0.0);
    let [first, last] = [&trajectory.points[0], &trajectory.points[trajectory.points.len() - 1]];
    for point in [first, last] {
        assert!(point.velocities.iter().chain(&point.accelerations).all(|&x| x == 0.0));
    }
    let step = trajectory.points[1].time_s;
    for (k, pair) in trajectory.points.windows(2).enumerate() {
        assert!(((pair[1].time_s - pair[0].time_s) - step).abs() < 1e-9, "step {k} is uneven");
        assert_eq!(pair[1].time_s, (pair[1].time_s * 1e9).round() * 1e-9, "whole nanoseconds");
        for j in 0..robot.chain.dof() {
            // The acceleration jumps by no more than the jerk limit allows, point to point and at every point.
            let jump = (pair[1].accelerations[j] - pair[0].accelerations[j]).abs();
            assert!(jump <= robot.limits.jerk[j] * step * (1.0 + 1e-9));
        }
        let (before, after) = (trajectory.at(pair[1].time_s - 1e-9), trajectory.at(pair[1].time_s));
        // 1e-9 s of the highest legal jerk, and rounding of second derivatives over a step: 1e-15·6/(0.01)²·10.
        assert!((&after[2] - &before[2]).amax() < 1e-9 * robot.limits.jerk.max() + 1e-9);
    }
    let independent = ratios_by_differences(robot, trajectory);
    // Fourth-point differences 0.5 ms apart see the position's rounding (1e-15) divided by d³ = 1e-10 and their own truncation.
    for (seen, exact) in independent.into_iter().zip([ratio.velocity, ratio.acceleration, ratio.jerk]) {
        assert!(seen <= exact * 1.002 + 1e-4, "differences see {seen}, the audit {exact}");
    }
}

#[test]
fn random_paths_become_executable_and_nearly_time_optimal() {
    let robot = ur5e();
    let mut random = Random(17);
    for i in 0..24 {
        let path = random_path(&robot, [0.5, 1.0, 1.5, 2.0][i % 4], 60, &mut random);
        let timed = time_path(&robot, &path, &TimingOptions::default()).unwrap();
        assert_executable(&robot, &timed.trajectory);
        assert_eq!(timed.audit, audit(&robot, &timed.trajectory));
        let ratio = timed.trajectory.duration_s() / timed.second_order_duration_s;
        // Reaching 5 rad/s² at 50 rad/s³ costs 0.1 s at each reversal; measured on these paths: 1.03 to 1.12.
        assert!(ratio > 1.0 && ratio < 1.25, "path {i}: {ratio} of the duration without jerk limits");
        // What the audit corrects between gridpoints is to cost a few per cent. Both are solved to 1e-3.
        if i % 4 == 0 {
            let uncorrected = uncorrected_duration_s(&robot, &path, &TimingOptions::default()).unwrap();
            let cost = timed.trajectory.duration_s() / uncorrected;
            println!("path {i}: {cost} of the uncorrected solution");
            assert!((0.999..1.06).contains(&cost), "path {i}: {cost} of the uncorrected solution");
        }
        // Time-optimal means that some limit is nearly reached somewhere.
        let peaks = timed.audit.max_ratio;
        assert!(peaks.velocity.max(peaks.acceleration).max(peaks.jerk) > 0.97);
    }
}

#[test]
fn a_written_line_is_passed_pose_by_pose_in_order() {
    let robot = ur5e();
    let poses = writing(&robot, 300);
    let path = follow(&robot, &spline(&poses), Some(&robot.preferred), &PathOptions::default()).unwrap();
    let timed = time_path(&robot, &path, &TimingOptions::default()).unwrap();
    assert_executable(&robot, &timed.trajectory);
    assert_eq!(timed.knot_times_s.len(), poses.len());
    assert!(timed.knot_times_s.windows(2).all(|t| t[1] > t[0]));
    assert_eq!((timed.knot_times_s[0], timed.knot_times_s[299]), (0.0, timed.trajectory.duration_s()));
    for (pose, &t) in poses.iter().zip(&timed.knot_times_s) {
        let tool = robot.chain.forward(&timed.trajectory.at(t)[0]);
        // Quintics over 10 ms deviate by h⁶/46080·(sixth derivative): some 1e-9 m; a dropped or exchanged pose, by a millimetre.
        assert!((tool.translation.vector - pose.translation.vector).norm() < 1e-7);
        assert!(tool.rotation.angle_to(&pose.rotation) < 1e-6);
    }
}

#[test]
fn every_rate_and_scale_is_legal() {
    let robot = ur5e();
    let mut random = Random(29);
    let path = random_path(&robot, 1.0, 60, &mut random);
    for rate_hz in [20.0, 125.0, 500.0] {
        let timed = time_path(&robot, &path, &TimingOptions { rate_hz, ..TimingOptions::default() }).unwrap();
        assert_executable(&robot, &timed.trajectory);
        let step = timed.trajectory.points[1].time_s;
        assert!(step <= 1.0 / rate_hz + 1e-9 && step > 0.9 / rate_hz);
    }
    let gentle =
        TimingOptions { velocity_scale: 0.3, acceleration_scale: 0.2, jerk_scale: 0.1, ..TimingOptions::default() };
    let timed = time_path(&robot, &path, &gentle).unwrap();
    let peaks = timed.audit.max_ratio;
    assert!(peaks.velocity <= 0.3 && peaks.acceleration <= 0.2 && peaks.jerk <= 0.1, "{peaks:?}");
    let invalid = TimingOptions { jerk_scale: 1.5, ..TimingOptions::default() };
    assert!(matches!(
        time_path(&robot, &path, &invalid),
        Err(ManipulatorError::InvalidOption { name: "jerk_scale", .. })
    ));
}

fn straight(robot: &Robot, length: f64) -> JointPath {
    let direction = DVector::from_fn(robot.chain.dof(), |j, _| length / (j + 1) as f64);
    let end = EndDerivatives { first: direction.clone(), second: DVector::zeros(6) };
    let parameters: Vec<f64> = (0..9).map(|i| f64::from(i) / 8.0).collect();
    let values: Vec<_> = parameters.iter().map(|s| &direction * *s).collect();
    JointPath::through(&parameters, &values, [&end, &end]).unwrap()
}

#[test]
fn straight_and_tiny_paths_work() {
    let robot = ur5e();
    for length in [2.0, 0.1, 1.1e-3, 0.9e-3, 1e-5, 1e-9, 0.0] {
        let timed = time_path(&robot, &straight(&robot, length), &TimingOptions::default()).unwrap();
        assert_executable(&robot, &timed.trajectory);
        let reached = timed.trajectory.at(timed.trajectory.duration_s())[0][0];
        assert!((reached - length).abs() < 1e-14);
    }
}

#[test]
fn rest_to_rest_is_the_quintic_at_its_limits() {
    let robot = ur5e();
    let options = TimingOptions::default();
    let mut random = Random(41);
    for size in [3.0, 0.5, 0.01, 1e-6] {
        let (from, to) =
            (random_configuration(&robot, size, &mut random), random_configuration(&robot, size, &mut random));
        let trajectory = rest_to_rest(&robot, &from, &to, &options).unwrap();
        assert_executable(&robot, &trajectory);
        assert_eq!(trajectory.points[0].positions, from.as_slice());
        assert_eq!(trajectory.points[trajectory.points.len() - 1].positions, to.as_slice());
        let peaks = audit(&robot, &trajectory).max_ratio;
        let steps = trajectory.points.len() as f64 - 1.0;
        // Rounding the duration up to nanoseconds and a margin of 1e-4 cost little; a whole step is never added.
        assert!(peaks.velocity.max(peaks.acceleration).max(peaks.jerk) > 0.999 - 1e-3 / steps, "{peaks:?}");
        // On a straight line: the middle is reached at half time.
        let middle = &trajectory.at(0.5 * trajectory.duration_s())[0];
        assert!((middle - (&from + &to) * 0.5).amax() < 1e-9 * size);
    }
    let here = robot.preferred.clone();
    let standing = rest_to_rest(&robot, &here, &here, &options).unwrap();
    assert_eq!(standing.points.len(), 1);
    assert!(audit(&robot, &standing).limits_ok);
    let beyond = DVector::from_element(6, 6.5);
    assert!(matches!(rest_to_rest(&robot, &here, &beyond, &options), Err(ManipulatorError::BeyondLimits { .. })));
    let nan = DVector::from_element(6, f64::NAN);
    assert!(matches!(rest_to_rest(&robot, &nan, &here, &options), Err(ManipulatorError::NonFinite { .. })));
}

/// What a reader of the published points could get wrong must not pass the audit.
#[test]
fn spoilt_trajectories_fail_the_audit() {
    let robot = ur5e();
    let mut random = Random(53);
    let path = random_path(&robot, 1.0, 60, &mut random);
    let good = time_path(&robot, &path, &TimingOptions::default()).unwrap().trajectory;
    let middle = good.points.len() / 2;
    let spoil = |change: &dyn Fn(&mut JointTrajectory)| {
        let mut trajectory = good.clone();
        change(&mut trajectory);
        audit(&robot, &trajectory)
    };
    assert!(spoil(&|_| ()).limits_ok);
    assert!(!spoil(&|t| drop(t.points.pop())).starts_and_ends_at_rest);
    assert!(!spoil(&|t| t.points.reverse()).times_increase);
    assert!(spoil(&|t| t.points[middle].velocities[2] *= -1.0).max_ratio.acceleration > 1.0);
    assert!(spoil(&|t| t.points[middle].accelerations[0] += 1.0).max_ratio.jerk > 1.0);
    assert!(spoil(&|t| t.points[middle].positions[5] += 1e-4).max_ratio.jerk > 1.0);
    assert!(spoil(&|t| t.points.iter_mut().for_each(|p| p.positions[2] += 4.0)).position_margin < 0.0);
    assert!(spoil(&|t| t.points.iter_mut().for_each(|p| p.time_s *= 0.99)).max_ratio.jerk > 1.0);
    for spoilt in [
        spoil(&|t| t.points[middle].positions[0] = f64::NAN),
        spoil(&|t| t.points[middle].positions.truncate(5)),
        spoil(&|t| t.points[middle].time_s = t.points[middle - 1].time_s),
        spoil(&|t| t.points.clear()),
        spoil(&|t| t.points[0].velocities[1] = 1e-12),
    ] {
        assert!(!spoilt.limits_ok, "{spoilt:?}");
    }
}

#[test]
fn a_path_of_nan_or_of_the_wrong_size_is_refused() {
    let robot = ur5e();
    let zero = EndDerivatives { first: DVector::zeros(6), second: DVector::zeros(6) };
    let values = [DVector::zeros(6), DVector::from_element(6, f64::NAN)];
    assert!(matches!(
        JointPath::through(&[0.0, 1.0], &values, [&zero, &zero]),
        Err(ManipulatorError::NonFinite { .. })
    ));
    let values = [DVector::zeros(6), DVector::from_element(6, 1.0)];
    assert!(matches!(
        JointPath::through(&[0.0, 0.0], &values, [&zero, &zero]),
        Err(ManipulatorError::ParametersNotIncreasing { index: 1, .. })
    ));
    for dof in [5, 7] {
        let other = EndDerivatives { first: DVector::zeros(dof), second: DVector::zeros(dof) };
        let values = [DVector::zeros(dof), DVector::from_element(dof, 1.0)];
        let path = JointPath::through(&[0.0, 1.0], &values, [&other, &other]).unwrap();
        let options = TimingOptions::default();
        let refused = [
            time_path(&robot, &path, &options).map(drop).unwrap_err(),
            least_duration_s(&robot, &path, &options, 100).map(drop).unwrap_err(),
        ];
        for refused in refused {
            assert_eq!(refused, ManipulatorError::WrongSize { what: "the joint path", expected: 6, given: dof });
        }
    }
}

/// A trajectory of hours at the highest rate is refused before memory is asked for.
#[test]
fn a_trajectory_of_too_many_points_is_refused() {
    let mut robot = Robot::shipped("ur5e").unwrap();
    robot.limits.velocity *= 1e-9;
    let from = DVector::from_element(6, -1.0);
    let refused = rest_to_rest(&robot, &from, &from.add_scalar(0.2), &TimingOptions::default()).unwrap_err();
    assert!(matches!(refused, ManipulatorError::TooLong { .. }), "{refused}");
    let beyond = DVector::from_element(6, 100.0);
    let refused = rest_to_rest(&robot, &from, &beyond, &TimingOptions::default()).unwrap_err();
    assert!(matches!(refused, ManipulatorError::BeyondLimits { .. }), "{refused}");
}
