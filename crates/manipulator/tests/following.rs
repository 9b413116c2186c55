//! Inverse kinematics of single poses and along curves.
#![allow(clippy::unwrap_used)]

mod support;

use std::f64::consts::{PI, TAU};

use manipulator::nalgebra::{DVector, Vector3};
use manipulator::{
    IkOptions, JointPath, ManipulatorError, PathOptions, Robot, TimingOptions, follow, solve_ik, time_path,
};
use se3_geom::{Ends, Manifold, Pose, PoseSpline, Se3, So3, Twist, centripetal_knots, pose_from_xyzw};
use support::curves::{spline, writing};
use support::{Random, configuration_within, mounted_ur5e, random_configuration, ur5e};

fn off(a: &Pose, b: &Pose) -> (f64, f64) {
    ((a.translation.vector - b.translation.vector).norm(), So3.distance(&a.rotation, &b.rotation))
}

/// The tool's greatest distance and angle from the curve, on a grid that no sample spacing divides.
fn greatest_deviation(robot: &Robot, curve: &PoseSpline, path: &JointPath) -> (f64, f64) {
    let (first, last) = curve.domain();
    (0..=4999).fold((0.0_f64, 0.0_f64), |worst, i| {
        let s = first + (last - first) * f64::from(i) / 4999.0;
        let (metres, radians) = off(&robot.chain.forward(&path.at(s)[0]), &curve.pose(s));
        (worst.0.max(metres), worst.1.max(radians))
    })
}

#[test]
fn inverse_kinematics_reaches_what_forward_kinematics_gives() {
    let robot = ur5e();
    let options = IkOptions::default();
    let mut random = Random(3);
    for _ in 0..200 {
        let q = random_configuration(&robot, 2.5, &mut random);
        let target = robot.chain.forward(&q);
        // From nearby, so that one descent must suffice.
        let seed = &q + random_configuration(&robot, 0.1, &mut random);
        let found = solve_ik(&robot, &target, &seed, &options).unwrap();
        let (metres, radians) = off(&robot.chain.forward(&found), &target);
        assert!(metres <= options.tolerance_m && radians <= options.tolerance_rad);
        assert!((0..6).all(|i| found[i].abs() <= robot.limits.upper[i]));
    }
}

#[test]
fn whole_turns_stay_with_the_seed() {
    let robot = ur5e();
    let mut q = robot.preferred.clone();
    q[3] += TAU;
    q[5] = -5.0;
    let found = solve_ik(&robot, &robot.chain.forward(&q), &q, &IkOptions::default()).unwrap();
    assert!((found - q).amax() < 1e-6);
}

#[test]
fn a_pose_out_of_reach_is_refused_with_the_distance() {
    let robot = ur5e();
    let mut target = robot.chain.forward(&robot.preferred);
    target.translation.vector = Vector3::new(0.0, -3.0, 0.163);
    let Err(ManipulatorError::IkNotConverged { position_error_m, .. }) =
        solve_ik(&robot, &target, &robot.preferred, &IkOptions::default())
    else {
        panic!("reached a pose 3 m away");
    };
    // The links add up to less than 1.2 m.
    assert!(position_error_m > 1.8, "{position_error_m}");
    target.translation.vector.x = f64::NAN;
    let refused = solve_ik(&robot, &target, &robot.preferred, &IkOptions::default());
    assert_eq!(refused, Err(ManipulatorError::NonFinite { what: "the target pose" }));
    let short = DVector::zeros(5);
    assert!(matches!(
        solve_ik(&robot, &Pose::identity(), &short, &IkOptions::default()),
        Err(ManipulatorError::WrongSize { expected: 6, given: 5, .. })
    ));
}

#[test]
fn the_tool_keeps_to_the_curve_and_passes_every_pose() {
    let robot = ur5e();
    let options = PathOptions::default();
    for count in [6, 40, 300] {
        let poses = writing(&robot, count);
        let curve = spline(&poses);
        let path = follow(&robot, &curve, Some(&robot.preferred), &options).unwrap();
        assert_eq!(path.pose_parameters(), curve.knots());
        for (pose, &s) in poses.iter().zip(path.pose_parameters()) {
            // Samples are solved to 1e-9 m and rad.
            let (metres, radians) = off(&robot.chain.forward(&path.at(s)[0]), pose);
            assert!(metres < 2e-9 && radians < 2e-9);
        }
        let (metres, radians) = greatest_deviation(&robot, &curve, &path);
        // Checked at three places an interval; the greatest in between is at most a tenth more (deviation ∝ u³(1 − u)³).
        assert!(metres < 1.1 * options.tolerance_m && radians < 1.1 * options.tolerance_rad, "{metres} {radians}");
        assert!((&path.at(curve.domain().0)[0] - &robot.preferred).amax() < 1e-6, "starts where the robot is");
    }
}

#[test]
fn a_tighter_tolerance_is_met_by_more_samples() {
    let robot = ur5e();
    let curve = spline(&writing(&robot, 12));
    let tight = PathOptions { tolerance_m: 1e-7, tolerance_rad: 1e-6, ..PathOptions::default() };
    let path = follow(&robot, &curve, None, &tight).unwrap();
    let (metres, radians) = greatest_deviation(&robot, &curve, &path);
    assert!(metres < 1.1e-7 && radians < 1.1e-6, "{metres} {radians}");
}

/// Left and right limits of the first four derivatives at every knot, from the values beside it.
#[test]
fn the_joint_path_has_four_continuous_derivatives() {
    let robot = ur5e();
    let curve = spline(&writing(&robot, 40));
    let path = follow(&robot, &curve, None, &PathOptions::default()).unwrap();
    let mean = (curve.domain().1 - curve.domain().0) / 39.0;
    for (i, &knot) in path.knots().iter().enumerate().skip(1).take(path.knots().len() - 2) {
        let h = 1e-4 * (path.knots()[i + 1] - knot).min(knot - path.knots()[i - 1]);
        let [left, right] = [path.at(knot - h), path.at(knot + h)];
        for order in 0..3 {
            let jump = (&right[order] - &left[order] - (&left[order + 1] + &right[order + 1]) * h).amax();
            // Trapezoid rule on the next derivative: O(h³) and rounding.
            assert!(jump < 1e-7 * (1.0 + left[order].amax()), "order {order} at knot {i}: {jump}");
        }
        // The fourth derivative as slope of the third on either side; a spline that is only C³ would show jumps of its own size.
        let slope = |a: &[DVector<f64>; 4], b: &[DVector<f64>; 4]| (&b[3] - &a[3]) / h;
        let inner_left = slope(&path.at(knot - 2.0 * h), &left);
        let inner_right = slope(&right, &path.at(knot + 2.0 * h));
        let size = 1e-2 * (inner_left.amax() + inner_right.amax()) + 1e-2 * left[3].amax() / mean;
        assert!((inner_right - inner_left).amax() < size, "knot {i}");
    }
}

/// The second derivative that the path has at its start is the limit of second differences of inverse kinematics, which come
/// closer in proportion to their step. The clamped end gives the curve an acceleration there.
#[test]
fn the_path_starts_with_the_second_derivative_of_the_curve() {
    let robot = ur5e();
    let poses = writing(&robot, 12);
    let ends = Ends::Clamped {
        start: Twist::new(Vector3::new(0.02, -0.01, 0.03), Vector3::new(0.3, 0.2, -0.1)),
        end: Twist::zero(),
    };
    let curve = PoseSpline::through(&poses, &centripetal_knots(&Se3::default(), &poses), ends).unwrap();
    let path = follow(&robot, &curve, None, &PathOptions::default()).unwrap();
    let [start, _, second, _] = path.at(0.0);
    let exact = IkOptions { tolerance_m: 1e-13, tolerance_rad: 1e-13, ..IkOptions::default() };
    let at = |s: f64| solve_ik(&robot, &curve.pose(s), &start, &exact).unwrap();
    let defect = |h: f64| ((at(2.0 * h) - at(h) * 2.0 + at(0.0)) / (h * h) - &second).norm();
    let ratio = defect(2e-3) / defect(1e-3);
    assert!((ratio - 2.0).abs() < 0.2 && defect(1e-3) < 0.05 * second.norm(), "{ratio} {}", defect(1e-3));
}

/// What the arm does must not depend on where the base stands: moved with the poses, it makes the same joint path.
#[test]
fn moving_base_and_poses_together_changes_nothing() {
    let ((g, mounted), robot) = (mounted_ur5e(), ur5e());
    let poses = writing(&robot, 40);
    let moved: Vec<Pose> = poses.iter().map(|pose| g * pose).collect();
    let [path, moved_path] = [(&robot, poses), (&mounted, moved)]
        .map(|(robot, poses)| follow(robot, &spline(&poses), None, &PathOptions::default()).unwrap());
    for i in 0..=100 {
        let s = path.domain().1 * f64::from(i) / 100.0;
        // Both solve to 1e-9 and quadratic convergence leaves far less.
        assert!((&path.at(s)[0] - &moved_path.at(s)[0]).amax() < 1e-7);
    }
}

#[test]
fn reversed_poses_reverse_the_path() {
    let robot = ur5e();
    let poses = writing(&robot, 40);
    let backward: Vec<Pose> = poses.iter().rev().copied().collect();
    let path = follow(&robot, &spline(&poses), None, &PathOptions::default()).unwrap();
    let end = path.at(path.domain().1)[0].clone();
    let reversed = follow(&robot, &spline(&backward), Some(&end), &PathOptions::default()).unwrap();
    for i in 0..=100 {
        let s = path.domain().1 * f64::from(i) / 100.0;
        // Samples agree to 1e-9; between them the tolerance of 1e-4 m at the tool, 1e-3 rad at the joints, leaves room.
        assert!((&path.at(s)[0] - &reversed.at(path.domain().1 - s)[0]).amax() < 1e-3);
        assert!(i == 50 || (&path.at(s)[0] - &reversed.at(s)[0]).amax() > 1e-3, "reversal changed nothing");
    }
}

#[test]
fn the_pose_out_of_reach_is_named() {
    let robot = ur5e();
    let mut poses = writing(&robot, 30);
    for (k, pose) in poses.iter_mut().enumerate().skip(20) {
        pose.translation.vector.y -= 0.15 * (k - 19) as f64;
    }
    let error = follow(&robot, &spline(&poses), None, &PathOptions::default()).unwrap_err();
    let ManipulatorError::Unreachable(out) = &error else { panic!("{error}") };
    let first = out.misses[0];
    // The arm reaches y ≈ −1.0 m from about −0.5 m: four steps of 0.15 m, give or take one.
    assert!((22..=25).contains(&first.pose), "{error}");
    assert!(first.position_error_m > 1e-3 && first.position_error_m < 0.2, "{error}");
    let mut first_is_far = writing(&robot, 5);
    first_is_far[0].translation.vector.z += 2.0;
    let error = follow(&robot, &spline(&first_is_far), None, &PathOptions::default()).unwrap_err();
    assert!(matches!(&error, ManipulatorError::Unreachable(out) if out.reachable() == [(1, 4)]), "{error}");
}

/// Where the joints of an arm lead, the arm can reach: of curves that leave its reach in the middle only what is outside is named.
#[test]
fn no_pose_that_joints_lead_to_is_called_out_of_reach() {
    let mut random = Random(12);
    for name in ["vx300s", "panda", "ur5e"] {
        let robot = Robot::shipped(name).unwrap();
        for _ in 0..8 {
            let [from, to] = [(); 2].map(|()| configuration_within(&robot, 0.95, &mut random));
            let mut poses: Vec<Pose> =
                (0..30).map(|k| robot.chain.forward(&from.lerp(&to, f64::from(k) / 29.0))).collect();
            for pose in &mut poses[8..16] {
                pose.translation.vector.x += 3.0;
            }
            let error = follow(&robot, &spline(&poses), None, &PathOptions::default()).unwrap_err();
            let ManipulatorError::Unreachable(out) = &error else { panic!("{error}") };
            assert_eq!(out.reachable(), [(0, 7), (16, 29)], "{name}: {error}");
        }
    }
}

/// With the second wrist joint at zero the axes of the first and the third are parallel.
#[test]
fn a_singular_start_is_named() {
    let robot = ur5e();
    let mut stretched = robot.preferred.clone();
    stretched[2] = 0.0;
    stretched[4] = 0.0;
    let first = robot.chain.forward(&stretched);
    let poses: Vec<Pose> = (0..5)
        .map(|i| {
            let mut pose = first;
            pose.translation.vector.z -= 0.001 * f64::from(i);
            pose
        })
        .collect();
    let error = follow(&robot, &spline(&poses), Some(&stretched), &PathOptions::default()).unwrap_err();
    assert!(matches!(error, ManipulatorError::Singular { pose: 0 | 1, .. }), "{error}");
}

/// The tool turns one and a half turns on the spot: from a wrist at +100° in the positive sense that runs beyond +2π, so the
/// wrist must begin a whole turn earlier.
#[test]
fn a_joint_that_would_run_into_its_limit_starts_a_turn_earlier() {
    let robot = ur5e();
    let mut start = robot.preferred.clone();
    start[5] = 100.0_f64.to_radians();
    let first = robot.chain.forward(&start);
    let poses: Vec<Pose> = (0..31)
        .map(|i| {
            let turn = pose_from_xyzw([0.002 * f64::from(i), 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
            let angle = f64::from(i) / 30.0 * 1.5 * TAU;
            let spin = se3_geom::nalgebra::UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            Pose::from_parts((turn.translation.vector + first.translation.vector).into(), first.rotation * spin)
        })
        .collect();
    let path = follow(&robot, &spline(&poses), Some(&start), &PathOptions::default()).unwrap();
    let travelled = &path.at(path.domain().1)[0] - &path.at(path.domain().0)[0];
    assert!((travelled[5].abs() - 1.5 * TAU).abs() < 0.5, "{travelled}");
    for i in 0..=1000 {
        let q = &path.at(path.domain().1 * f64::from(i) / 1000.0)[0];
        assert!((0..6).all(|j| q[j].abs() <= robot.limits.upper[j] + 1e-9));
    }
    // With only one turn to spend there is no way, and the joint is named.
    let mut narrow = robot.clone();
    narrow.limits.upper[5] = PI;
    narrow.limits.lower[5] = -PI;
    let error = follow(&narrow, &spline(&poses), Some(&start), &PathOptions::default()).unwrap_err();
    assert!(matches!(&error, ManipulatorError::JointLimit { joint, .. } if joint == "wrist_3_joint"), "{error}");
}

#[test]
fn malformed_requests_are_refused() {
    let robot = ur5e();
    let curve = spline(&writing(&robot, 5));
    let nan = DVector::from_element(6, f64::NAN);
    let options = PathOptions::default();
    assert!(matches!(follow(&robot, &curve, Some(&nan), &options), Err(ManipulatorError::NonFinite { .. })));
    let zeros = DVector::zeros(7);
    assert!(matches!(
        follow(&robot, &curve, Some(&zeros), &options),
        Err(ManipulatorError::WrongSize { given: 7, .. })
    ));
    let options = PathOptions { tolerance_m: f64::NAN, ..options };
    assert!(matches!(
        follow(&robot, &curve, None, &options),
        Err(ManipulatorError::InvalidOption { name: "tolerance_m", .. })
    ));
}

/// The tool stays where it is: so does the arm, with as many joints as it may have.
#[test]
fn a_curve_of_no_length_is_followed_by_standing_still() {
    for name in Robot::shipped_names() {
        let robot = Robot::shipped(name).unwrap();
        let pose = robot.chain.forward(&robot.preferred);
        let curve = PoseSpline::through(&[pose, pose], &[0.0, 1.0], Ends::Natural).unwrap();
        let path = follow(&robot, &curve, Some(&robot.preferred), &PathOptions::default()).unwrap();
        let (metres, radians) = greatest_deviation(&robot, &curve, &path);
        assert!(metres < 1e-8 && radians < 1e-8, "{name}: {metres} m, {radians} rad");
        let timed = time_path(&robot, &path, &TimingOptions::default()).unwrap();
        assert!(timed.audit.limits_ok);
    }
}

/// Where a redundant arm looks for configurations afresh it begins at the one it prefers, whatever the start.
#[test]
fn a_preferred_configuration_of_the_wrong_size_is_refused() {
    let mut robot = Robot::shipped("panda").unwrap();
    let start = robot.preferred.clone();
    let curve = spline(&writing(&robot, 20));
    robot.preferred = DVector::zeros(6);
    let refused = follow(&robot, &curve, Some(&start), &PathOptions::default()).unwrap_err();
    assert!(matches!(refused, ManipulatorError::WrongSize { expected: 7, given: 6, .. }), "{refused}");
}
