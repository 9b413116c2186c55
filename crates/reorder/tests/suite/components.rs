//! Several curves in one input.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::f64::consts::TAU;

use reorder::{Options, OrderError, Topology, order_components};
use se3_geom::R2;
use se3_geom::nalgebra::Vector2;

use crate::support::harmonics::*;
use crate::support::{Random, neighbours, shuffled};

fn ring(x: f64, radius: f64, n: u32) -> Vec<Vector2<f64>> {
    (0..n)
        .map(|k| TAU * f64::from(k) / f64::from(n))
        .map(|t| Vector2::new(x + radius * t.cos(), radius * t.sin()))
        .collect()
}

fn arc(x: f64, n: u32, step: f64) -> Vec<Vector2<f64>> {
    (0..n).map(|k| Vector2::new(x + step * f64::from(k), 30.0 + 0.1 * (f64::from(k) * 0.3).sin())).collect()
}

#[test]
fn curves_of_different_density_come_apart_with_their_own_topology() {
    let mut random = Random::seeded(71);
    // Gaps of 0.31, 0.031 and 1; the rings 1.5 apart, the arc far away; two outliers.
    let mut points = [ring(0.0, 2.0, 40), ring(3.7, 0.2, 40), arc(0.0, 20, 1.0)].concat();
    points.extend([Vector2::new(200.0, 0.0), Vector2::new(-150.0, 3.0)]);
    let rows = random.permutation(points.len());
    let found = order_components(&R2::default(), &shuffled(&points, &rows), &Options::default()).unwrap();
    let mut curves: Vec<(Vec<usize>, Topology)> = found
        .curves
        .iter()
        .map(|c| (c.order().into_iter().map(|k| rows[k]).collect::<Vec<_>>(), c.ordering.topology))
        .collect();
    curves.sort_by_key(|(order, _)| order.iter().copied().min());
    let expected = [(0, 40, Topology::Closed), (40, 40, Topology::Closed), (80, 20, Topology::Open)];
    assert_eq!(curves.len(), 3);
    for ((order, topology), (first, n, expected)) in curves.iter().zip(expected) {
        let truth: Vec<usize> = (first..first + n).collect();
        let closed = expected == Topology::Closed;
        assert_eq!((neighbours(order, closed), *topology), (neighbours(&truth, closed), expected));
    }
    let mut outliers: Vec<usize> = found.outliers.iter().map(|&k| rows[k]).collect();
    outliers.sort_unstable();
    assert_eq!(outliers, [100, 101]);
    assert!(found.separation.unwrap() >= 3.0);
}

#[test]
fn curves_that_are_not_clearly_apart_stay_one() {
    // Gaps of 0.314; the rings 0.9 apart, and then 1.0.
    for (x, curves) in [(4.9, 1), (5.0, 2)] {
        let points = [ring(0.0, 2.0, 40), ring(x, 2.0, 40)].concat();
        let found = order_components(&R2::default(), &points, &Options::default()).unwrap();
        assert_eq!(found.curves.len(), curves);
        assert_eq!(found.separation.is_some(), curves == 2);
    }
}

/// Independent points have gaps of any length, and are one curve all the same.
#[test]
fn one_unevenly_sampled_curve_is_never_torn() {
    let mut random = Random::seeded(72);
    let mut torn = 0;
    for _ in 0..200 {
        let curve = Measured::closed(R2::default(), plane_curve(&mut random));
        let samples = curve.sample(&mut random, 100, Spacing::Iid);
        let found = order_components(&R2::default(), &samples, &Options::default()).unwrap();
        torn += usize::from(found.curves.len() + found.outliers.len() > 1);
    }
    // 200/100² are expected.
    assert!(torn <= 1, "{torn}");
}

#[test]
fn repeated_points_are_no_gaps() {
    // A dwell at every second point, and an outlier that came four times.
    let mut points = arc(0.0, 24, 1.0);
    points.extend(arc(0.0, 24, 1.0).into_iter().step_by(2));
    points.extend([Vector2::new(0.0, -400.0); 4]);
    let found = order_components(&R2::default(), &points, &Options::default()).unwrap();
    assert_eq!(found.curves.len(), 1);
    assert_eq!(found.curves[0].ordering.distinct(), (0..24).collect::<Vec<_>>());
    assert_eq!(found.outliers, [36, 37, 38, 39]);
    let nothing = order_components(&R2::default(), &points[36..], &Options::default());
    assert_eq!(nothing, Err(OrderError::AllEqual { count: 4 }));
}

#[test]
fn a_start_belongs_to_the_curve_that_holds_it() {
    let points = [arc(0.0, 20, 1.0), arc(100.0, 20, 1.0)].concat();
    let options = Options { start: Some(39), ..Options::default() };
    let found = order_components(&R2::default(), &points, &options).unwrap();
    let orders: Vec<_> = found.curves.iter().map(reorder::Component::order).collect();
    assert_eq!(orders, [(0..20).collect::<Vec<_>>(), (20..40).rev().collect()]);
}
