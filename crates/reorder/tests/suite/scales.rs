//! Points on scales that no sum of floating-point numbers holds together.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use reorder::{Options, OrderError, Repair, Verdict, minimum_spanning_tree, order};
use se3_geom::nalgebra::{Vector2, Vector3};
use se3_geom::{R2, R3};

fn on_axis(places: impl IntoIterator<Item = f64>) -> Vec<Vector2<f64>> {
    places.into_iter().map(|x| Vector2::new(x, 0.0)).collect()
}

/// One point far away must not make the others one.
#[test]
fn an_outlier_does_not_merge_the_rest() {
    let points = on_axis([3.0, 0.0, 2.0, 1.0, 5.0, 4.0, 1e17]);
    let found = order(&R2::default(), &points, &Options::default()).unwrap();
    assert!(found.duplicates.is_empty());
    assert_eq!(found.verdict, Verdict::Ambiguous);
    // Nor may a coordinate that is large and the same everywhere.
    let shelf: Vec<Vector2<f64>> = (0..20).map(|k| Vector2::new(1e17, f64::from(k * 7 % 20))).collect();
    let found = order(&R2::default(), &shelf, &Options::default()).unwrap();
    assert!(found.order.windows(2).all(|w| (shelf[w[0]].y - shelf[w[1]].y).abs() == 1.0), "{:?}", found.order);
}

#[test]
fn rounding_does_not_add_up() {
    // Neighbours are one unit in the last place apart, ends a hundred.
    let points = on_axis((0..100).map(|k| 1.0 + f64::from(k) * f64::EPSILON));
    let found = order(&R2::default(), &points, &Options::default()).unwrap();
    assert!(found.duplicates.len() > 10, "{:?}", found.duplicates);
    for group in &found.duplicates {
        // Twice the four that one point of the group may be away.
        assert!(group.iter().all(|&row| (points[row].x - points[group[0]].x).abs() <= 8.0 * f64::EPSILON));
    }
    assert!(found.doubts.iter().any(|doubt| doubt.why.contains("no more than rounding")), "{:?}", found.doubts);
    // Alone they are what the whole order hangs on, beside others they are one point.
    let pair = [0.0, 0.0, 1.0, 1.0 + f64::EPSILON];
    assert_eq!(order(&R2::default(), &on_axis(pair), &Options::default()).unwrap().verdict, Verdict::Ambiguous);
    let many = on_axis((0..30).map(f64::from).chain([1.0 + f64::EPSILON]));
    let found = order(&R2::default(), &many, &Options::default()).unwrap();
    assert_eq!((found.duplicates, found.doubts), (vec![vec![1, 30]], vec![]));
}

/// Fails by never coming back.
#[test]
fn a_search_ends_where_gains_are_rounding() {
    let near = (0..20).map(f64::from);
    for (first, step) in [(1e17, 1e16), (1e15, 1e15), (1e20, 3e18)] {
        let points = on_axis(near.clone().chain((0..15).map(|k| first + step * f64::from(k))));
        let found = order(&R2::default(), &points, &Options { repair: Repair::Always, ..Options::default() }).unwrap();
        let mut rows = found.order;
        rows.sort_unstable();
        assert!(rows.into_iter().eq(0..35));
        assert_eq!(found.verdict, Verdict::Ambiguous);
    }
}

#[test]
fn distances_that_underflow() {
    let error = |places: &[f64]| order(&R2::default(), &on_axis(places.iter().copied()), &Options::default());
    for least in [3e-170, 3e-162, 1e-140] {
        let refused = error(&[0.0, least]).unwrap_err();
        assert_eq!(refused, OrderError::DistanceUnderflow { at: [0, 1] });
        assert_eq!(
            refused.to_string(),
            "the distance between points 0 and 1 underflows: choose a smaller unit of length"
        );
        let refused = error(&[1.0, 0.0, 2.0, 3.0, least]).unwrap_err();
        assert_eq!(refused, OrderError::DistanceUnderflow { at: [1, 4] });
    }
    assert_eq!(error(&[0.0, 2e-130, 1e-130]).unwrap().order, [0, 2, 1]);
    // What is lost beside the other coordinates is nothing.
    let beside = [Vector2::new(1.0, 0.0), Vector2::new(1.0, 1e-200), Vector2::new(2.0, 0.0)];
    let found = order(&R2::default(), &beside, &Options::default()).unwrap();
    assert_eq!(found.duplicates, [[0, 1]]);
}

/// Fails by taking minutes: points that no distance tells apart were all compared with each other.
#[test]
fn many_points_whose_distances_underflow_are_refused_at_once() {
    let points: Vec<Vector3<f64>> =
        (0..100_000).map(|k| 1e-170 * Vector3::new(f64::from(k), f64::from(k % 7), 1.0)).collect();
    let refused = minimum_spanning_tree(&R3::default(), &points).unwrap_err();
    assert!(matches!(refused, OrderError::DistanceUnderflow { .. }), "{refused}");
}
