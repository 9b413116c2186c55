//! The choice of the joints' way over the whole curve: what users of other planners know as jumps of inverse kinematics, elbow flips and
//! wrist flips, singularities, limits and poses out of reach.
#![allow(clippy::unwrap_used)]

mod support;

use std::f64::consts::PI;

use manipulator::nalgebra::DVector;
use manipulator::{ManipulatorError, PathOptions, PathReport, Robot, follow};
use se3_geom::{Manifold, Pose, Se3};
use support::curves::{spline, writing};
use support::sound::assert_sound;
use support::ur5e;

fn arms() -> impl Iterator<Item = Robot> {
    Robot::shipped_names().map(|name| Robot::shipped(name).unwrap())
}

/// Tool poses along a motion of the joints: every one can be reached, by these joints at least.
fn poses_along(robot: &Robot, count: usize, joints: impl Fn(f64) -> DVector<f64>) -> Vec<Pose> {
    (0..count).map(|i| robot.chain.forward(&joints(i as f64 / (count - 1) as f64))).collect()
}

/// The tolerance bounds the tool everywhere: a hundredth of the default holds on the dense grid as well.
#[test]
fn a_tight_tolerance_holds_between_samples_on_every_arm() {
    let options = PathOptions { tolerance_m: 1e-6, tolerance_rad: 1e-5, ..PathOptions::default() };
    for robot in arms() {
        let curve = spline(&support::curves::scaled_writing(&robot, 12, 0.5));
        let path = follow(&robot, &curve, Some(&robot.preferred), &options).unwrap();
        assert_sound(&robot, &curve, &path, &options);
    }
}

/// The second wrist joint of a motion passes through zero, where the axes of the first and the third are parallel.
fn through_the_wrist_singularity(robot: &Robot) -> Vec<Pose> {
    poses_along(robot, 30, |u| {
        let mut q = robot.preferred.clone();
        q[0] += 0.3 * u;
        q[4] = -0.7 + 1.4 * u;
        q
    })
}

/// With the shoulder held on its side the wrist would have to flip; that is refused with the place. Free, the arm takes the other
/// shoulder from the beginning.
#[test]
fn wrist_flip_is_refused_or_avoided_by_another_branch_from_the_start() {
    let robot = ur5e();
    let poses = through_the_wrist_singularity(&robot);
    let curve = spline(&poses);
    let options = PathOptions::default();
    if let Ok(path) = follow(&robot, &curve, None, &options) {
        assert_sound(&robot, &curve, &path, &options);
        let least = PathReport::of(&robot, &path).unwrap().singular_value.value;
        assert!(least > options.least_singular_value, "{least}");
    }
    let mut held = robot.clone();
    (held.limits.lower[0], held.limits.upper[0]) = (robot.preferred[0] - 0.6, robot.preferred[0] + 0.6);
    let error = follow(&held, &curve, None, &options).unwrap_err();
    assert_named_near(&error, 14..=16);
    assert!(!matches!(error, ManipulatorError::JointLimit { .. }), "{error}");
}

/// On the ViperX both wrist branches meet in the same singularity, and its shoulder has no other side to go to.
#[test]
fn wrist_flip_of_a_spherical_wrist_is_refused_with_the_place() {
    let robot = Robot::shipped("vx300s").unwrap();
    let poses = poses_along(&robot, 30, |u| {
        let mut q = robot.preferred.clone();
        q[0] += 0.3 * u;
        q[3] = 0.4;
        q[4] = -0.7 + 1.4 * u;
        q
    });
    let error = follow(&robot, &spline(&poses), None, &PathOptions::default()).unwrap_err();
    assert_named_near(&error, 13..=17);
}

/// The elbow passes through the stretched arm, where all branches meet and none leads on: refused between the place where the arm
/// comes too near to it and the stretched arm itself.
#[test]
fn elbow_flip_is_refused_with_the_place() {
    let robot = ur5e();
    let options = PathOptions::default();
    let motion = |u: f64| {
        let mut q = robot.preferred.clone();
        q[0] += 0.2 * u;
        q[1] -= 0.3 * u;
        q[2] = 0.8 - 1.6 * u;
        q
    };
    let singular = |pose: &usize| {
        let jacobian = robot.chain.body_jacobian(&motion(*pose as f64 / 29.0));
        jacobian.singular_values().min() < options.least_singular_value
    };
    let first = (0..30).find(singular).unwrap();
    assert!((5..15).contains(&first));
    let error = follow(&robot, &spline(&poses_along(&robot, 30, motion)), None, &options).unwrap_err();
    assert_named_near(&error, first - 1..=16);
}

fn assert_named_near(error: &ManipulatorError, poses: std::ops::RangeInclusive<usize>) {
    assert!(error.poses().first().is_some_and(|pose| poses.contains(pose)), "{error}");
    assert!(
        matches!(
            error,
            ManipulatorError::Singular { .. }
                | ManipulatorError::Jump { .. }
                | ManipulatorError::UnreachableBetween { .. }
                | ManipulatorError::CutOff { .. }
                | ManipulatorError::JointLimit { .. }
        ),
        "{error}"
    );
}

/// Two thirds of the way to the singularity the path is followed, and its report says how near it came; a bound above that
/// refuses it.
#[test]
fn near_singular_path_is_followed_and_its_margin_reported() {
    for robot in arms() {
        let joint = 4.min(robot.chain.dof() - 2);
        let poses = poses_along(&robot, 30, |u| {
            let mut q = robot.preferred.clone();
            q[0] += 0.3 * u;
            if robot.chain.dof() == 6 {
                q[joint] *= 1.0 - 0.85 * (PI * u).sin();
            }
            q
        });
        let curve = spline(&poses);
        let options = PathOptions::default();
        let path = follow(&robot, &curve, Some(&robot.preferred), &options).unwrap();
        assert_sound(&robot, &curve, &path, &options);
        let least = PathReport::of(&robot, &path).unwrap().singular_value;
        let dense = (0..=2000).map(|i| {
            let (first, last) = path.domain();
            let [q, ..] = path.at(first + (last - first) * f64::from(i) / 2000.0);
            robot.chain.body_jacobian(&q).singular_values().min()
        });
        let dense = dense.fold(f64::INFINITY, f64::min);
        // Samples and their midpoints against two thousand places: the figure changes by a few per cent between samples.
        assert!((least.value / dense - 1.0).abs() < 0.05, "{}: {} {dense}", robot.name, least.value);
        if robot.chain.dof() == 6 {
            assert!((10..20).contains(&least.pose), "{least:?}");
        }
        let strict = PathOptions { least_singular_value: 10.0, ..options };
        let error = follow(&robot, &curve, Some(&robot.preferred), &strict).unwrap_err();
        assert!(matches!(error, ManipulatorError::Singular { pose: 0, bound: 10.0, .. }), "{error}");
    }
}

/// The limits leave a motion of the joints no more than a hair: it is found, and stays inside.
#[test]
fn at_limit_path_is_followed_within_the_limits() {
    for mut robot in arms() {
        let dof = robot.chain.dof();
        let middle = robot.preferred.clone();
        let motion =
            |u: f64| DVector::from_fn(dof, |j, _| middle[j] + 0.15 * ((2.0 * u + j as f64).sin() - (j as f64).sin()));
        let poses = poses_along(&robot, 60, motion);
        let range = |j: usize| (0..=200).map(|i| motion(f64::from(i) / 200.0)[j]).collect::<Vec<_>>();
        // The curve between sixty poses differs from the motion's by some 1e-6; a self-motion that keeps to a posture needs room.
        let room = if dof == 6 { 1e-4 } else { 1e-2 };
        for j in 0..dof {
            robot.limits.lower[j] = range(j).into_iter().fold(f64::INFINITY, f64::min) - room;
            robot.limits.upper[j] = range(j).into_iter().fold(f64::NEG_INFINITY, f64::max) + room;
        }
        let curve = spline(&poses);
        let options = PathOptions::default();
        let path = follow(&robot, &curve, Some(&middle), &options).unwrap();
        assert_sound(&robot, &curve, &path, &options);
        let report = PathReport::of(&robot, &path).unwrap();
        assert!(report.limit_margin.value >= -1e-9 && report.limit_margin.value < 2.0 * room, "{report:?}");
        if dof == 6 {
            // One joint less far: the poses that need it are out of reach, the others are named as reachable.
            robot.limits.upper[1] -= 0.05;
            let error = follow(&robot, &curve, None, &options).unwrap_err();
            let ManipulatorError::Unreachable(out) = &error else { panic!("{error}") };
            assert!(!out.reachable().is_empty() && out.misses.len() < 60, "{error}");
            let far = out.misses.iter().all(|miss| motion(miss.pose as f64 / 59.0)[1] > robot.limits.upper[1]);
            assert!(far, "{error}");
        }
    }
}

/// A part of the poses is lifted beyond the length of the stretched arm: all of them are named, each with the distance.
#[test]
fn out_of_reach_path_names_every_pose_and_the_rest() {
    for robot in arms() {
        let mut poses = support::curves::scaled_writing(&robot, 30, 0.3);
        for pose in &mut poses[12..18] {
            pose.translation.vector.z += 3.0;
        }
        let error = follow(&robot, &spline(&poses), Some(&robot.preferred), &PathOptions::default()).unwrap_err();
        let ManipulatorError::Unreachable(out) = &error else { panic!("{error}") };
        assert_eq!(out.misses.iter().map(|miss| miss.pose).collect::<Vec<_>>(), (12..18).collect::<Vec<_>>());
        assert_eq!(out.reachable(), [(0, 11), (18, 29)]);
        // None of the arms is longer than 1.4 m, and none of their tools was lower than the base plate's height less 0.5 m.
        assert!(out.misses.iter().all(|miss| miss.position_error_m > 1.0 && miss.position_error_m < 3.1), "{error}");
        let text = error.to_string();
        assert!(
            text.starts_with("poses 12 to 17 are out of reach")
                && text.ends_with("0 to 11 and 18 to 29 can be reached")
        );
    }
}

/// Five joints cannot follow six coordinates: the refusal says so, whatever the curve.
#[test]
fn too_few_joints_are_refused_for_that() {
    let urdf = include_str!("../../../config/robots/ur5e.urdf");
    let fixed =
        urdf.replace(r#"<joint name="wrist_3_joint" type="revolute">"#, r#"<joint name="wrist_3_joint" type="fixed">"#);
    assert_ne!(fixed, urdf);
    let settings = include_str!("../../../config/robots/ur5e.yaml");
    let settings: String =
        settings.lines().filter(|line| !line.contains("wrist_3")).map(|line| format!("{line}\n")).collect();
    let robot = Robot::from_urdf(&fixed, &settings).unwrap();
    let poses = poses_along(&robot, 8, |u| robot.preferred.map(|q| q + 0.2 * u));
    let error = follow(&robot, &spline(&poses), Some(&robot.preferred), &PathOptions::default()).unwrap_err();
    assert_eq!(error, ManipulatorError::TooFewJoints { joints: 5 });
}

#[test]
fn a_hundred_thousand_poses_are_followed() {
    let robot = ur5e();
    let curve = spline(&writing(&robot, 100_000));
    let path = follow(&robot, &curve, None, &PathOptions::default()).unwrap();
    assert_eq!(path.pose_parameters().len(), 100_000);
    for &s in path.pose_parameters().iter().step_by(997) {
        assert!(Se3::default().distance(&robot.chain.forward(&path.at(s)[0]), &curve.pose(s)) < 2e-9);
    }
}
