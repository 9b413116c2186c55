//! Every refusal, with its sentence.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

mod support;

use reorder::{Options, OrderError, TopologyChoice, order, order_poses};
use se3_geom::nalgebra::Vector3;
use se3_geom::{Pose, R3};
use support::helix_pose;

fn refusal(points: &[Vector3<f64>], topology: TopologyChoice, start: Option<usize>) -> OrderError {
    order(&R3::default(), points, &Options { topology, start, ..Options::default() }).unwrap_err()
}

fn line(n: u32) -> Vec<Vector3<f64>> {
    (0..n).map(|k| Vector3::x() * f64::from(k)).collect()
}

fn assert_refused(error: &OrderError, expected: &OrderError, sentence: &str) {
    assert_eq!(error, expected);
    assert_eq!(error.to_string(), sentence);
}

#[test]
fn too_few_points() {
    for n in [0, 1] {
        let error = refusal(&line(n), TopologyChoice::Auto, None);
        let sentence = format!("there are {n} points to order, but at least 2 are needed");
        assert_refused(&error, &OrderError::TooFewPoints { count: n as usize, needed: 2 }, &sentence);
    }
    let error = refusal(&line(2), TopologyChoice::Closed, None);
    assert_eq!(error, OrderError::TooFewPoints { count: 2, needed: 3 });
}

#[test]
fn too_few_distinct_points() {
    let error = refusal(&[line(2), line(2)].concat(), TopologyChoice::Closed, None);
    let sentence = "the 4 points hold only 2 distinct ones, but at least 3 are needed";
    assert_refused(&error, &OrderError::TooFewDistinct { count: 4, distinct: 2, needed: 3 }, sentence);
}

#[test]
fn all_points_equal() {
    let error = refusal(&[Vector3::y(); 5], TopologyChoice::Auto, None);
    assert_refused(&error, &OrderError::AllEqual { count: 5 }, "all 5 points are equal, so there is nothing to order");
}

#[test]
fn coordinates_that_are_not_finite() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut points = line(6);
        points[4].z = bad;
        let error = refusal(&points, TopologyChoice::Auto, None);
        let sentence = "point 4 has a coordinate that is not a finite number";
        assert_refused(&error, &OrderError::NonFinite { index: 4 }, sentence);
    }
}

#[test]
fn distances_that_overflow() {
    let mut points = line(4);
    points[2].x = 1e200;
    let error = refusal(&points, TopologyChoice::Auto, None);
    assert_refused(
        &error,
        &OrderError::DistanceOverflow { at: [0, 2] },
        "the distance between points 0 and 2 overflows",
    );
}

#[test]
fn starts_that_are_none() {
    let error = refusal(&line(6), TopologyChoice::Auto, Some(6));
    let sentence = "the start 6 is out of range: there are 6 points, counted from 0";
    assert_refused(&error, &OrderError::StartOutOfRange { start: 6, count: 6 }, sentence);
    let error = refusal(&line(6), TopologyChoice::Auto, Some(2));
    let sentence = "the start 2 is not an end of the open curve, whose ends are points 0 and 5";
    let OrderError::StartNotAnEnd { start: 2, mut ends } = error else { panic!("{error}") };
    ends.sort_unstable();
    assert_refused(
        &OrderError::StartNotAnEnd { start: 2, ends },
        &OrderError::StartNotAnEnd { start: 2, ends: [0, 5] },
        sentence,
    );
}

#[test]
fn length_scales_that_are_none() {
    let poses: Vec<Pose> = (0..4).map(|k| helix_pose(0.1 * f64::from(k))).collect();
    for bad in [0.0, -1.0, f64::INFINITY, 1e200] {
        let error = order_poses(&poses, bad, &Options::default()).unwrap_err();
        assert_eq!(error, OrderError::InvalidLengthScale { value: bad });
        assert!(error.to_string().starts_with("metres_per_radian is "), "{error}");
    }
    assert!(matches!(order_poses(&poses, f64::NAN, &Options::default()), Err(OrderError::InvalidLengthScale { .. })));
}
