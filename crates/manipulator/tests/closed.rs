//! Closed curves: the joints come back to where they began, or the curve is refused.
#![allow(clippy::unwrap_used)]

mod support;

use std::f64::consts::TAU;

use manipulator::nalgebra::{DVector, Vector3};
use manipulator::{ManipulatorError, PathOptions, Robot, follow};
use se3_geom::{Ends, LieGroup, Pose, PoseSpline, Se3, So3Group, centripetal_knots};
use support::curves::closed_spline;
use support::sound::assert_sound;
use support::ur5e;

/// With its fifth joint all but fixed the Panda has one self-motion less: round this curve it comes back with another wrist, and no
/// self-motion within the limits leads from the one to the other.
#[test]
fn seven_joints_that_cannot_close_a_closed_curve_are_refused_as_not_cyclic() {
    let mut robot = Robot::shipped("panda").unwrap();
    let begin = DVector::from_column_slice(&[
        0.4182672314221718,
        0.8239441081533898,
        1.123972288458519,
        -2.2264053285867025,
        0.05403976327198956,
        0.7697887037420394,
        1.734204416048612,
    ]);
    for joint in 0..7 {
        let (middle, half) = if joint == 4 { (begin[joint], 0.05) } else { (0.0, 6.0) };
        (robot.limits.lower[joint], robot.limits.upper[joint]) = (middle - half, middle + half);
    }
    let centre = robot.chain.forward(&begin);
    let phases = [2.3748, 2.4368, 2.7431, 5.9847, 2.5205, 5.568];
    let poses: Vec<Pose> = (0..40)
        .map(|i| {
            let turn = TAU * f64::from(i) / 40.0;
            let way = phases.map(|phase| (turn + phase).sin() - phase.sin());
            let place = centre.translation.vector + Vector3::new(way[0], way[1], way[2]) * 0.1527;
            Pose::from_parts(
                place.into(),
                centre.rotation * So3Group::exp(Vector3::new(way[3], way[4], way[5]) * 0.5938),
            )
        })
        .collect();
    let round: Vec<Pose> = poses.iter().chain(poses.first()).copied().collect();
    let curve = PoseSpline::through(&poses, &centripetal_knots(&Se3::default(), &round), Ends::Periodic).unwrap();
    let options = PathOptions::default();
    let error = follow(&robot, &curve, Some(&begin), &options).unwrap_err();
    let ManipulatorError::NotCyclic { joint, from, to } = &error else { panic!("{error}") };
    let whole_turns = ((to - from) / TAU).round() * TAU;
    assert!((to - from - whole_turns).abs() > 1e-3 && error.to_string().contains(joint), "{error}");
    // Open, the same curve is followed.
    let open = PoseSpline::through(&poses, &centripetal_knots(&Se3::default(), &poses), Ends::Natural).unwrap();
    assert_sound(&robot, &open, &follow(&robot, &open, Some(&begin), &options).unwrap(), &options);
}

/// A lap of a curve on which the tool turns once about its own axis: the last joint ends a whole turn on, which is the same
/// configuration of the arm.
#[test]
fn closed_curve_with_a_turn_of_the_tool_ends_a_whole_turn_on() {
    let robot = ur5e();
    let home = robot.chain.forward(&robot.preferred);
    let poses: Vec<Pose> = (0..40)
        .map(|i| {
            let angle = TAU * f64::from(i) / 40.0;
            let mut pose = home;
            pose.translation.vector += se3_geom::nalgebra::Vector3::new(0.05 * angle.cos(), 0.05 * angle.sin(), 0.0);
            let spin = se3_geom::nalgebra::Vector3::z() * angle;
            pose.rotation *= se3_geom::nalgebra::UnitQuaternion::from_scaled_axis(spin);
            pose
        })
        .collect();
    let curve = closed_spline(&poses);
    let options = PathOptions::default();
    let path = follow(&robot, &curve, None, &options).unwrap();
    assert_sound(&robot, &curve, &path, &options);
    let lap = &path.at(path.domain().1)[0] - &path.at(path.domain().0)[0];
    assert!((lap[5].abs() - TAU).abs() < 1e-6 && lap.rows(0, 5).amax() < 1e-6, "{lap}");
}
