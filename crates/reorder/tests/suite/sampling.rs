//! Where sampling is too coarse to order anything: the thesis's counter-examples, and the figures of the certificate.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::f64::consts::{PI, TAU};

use reorder::{Options, Ordering, Repair, Topology, Verdict, order};
use se3_geom::nalgebra::{UnitQuaternion, Vector2, Vector3};
use se3_geom::{Manifold, R2, R3, So3, Sphere};

use crate::support::Random;
use crate::support::harmonics::*;

fn found<M: Manifold>(manifold: &M, points: &[M::Point]) -> Ordering {
    order(manifold, points, &Options::default()).unwrap()
}

/// The minimum spanning tree's order, not repaired.
fn of_tree<M: Manifold>(manifold: &M, points: &[M::Point]) -> Ordering {
    order(manifold, points, &Options { repair: Repair::Off, ..Options::default() }).unwrap()
}

/// A narrow V with its tip, of arms 10 long and 4 apart at their ends.
fn hairpin(step: f64) -> Vec<Vector2<f64>> {
    let arm = |side: f64| move |x: f64| Vector2::new(x, side * (10.0 - x) / 5.0);
    let count = (10.0 / step).floor() as u32;
    let xs = || (0..count).map(move |k| (f64::from(k) + 0.3) * step);
    xs().map(arm(1.0)).chain(xs().rev().map(|x| x - 0.4 * step).map(arm(-1.0))).collect()
}

/// Thesis Figure 2.1: few samples where the curvature is high. Next to the tip d(s_k, s_k+1) > d(s_k, s_j).
#[test]
fn too_few_samples_at_a_sharp_bend_are_ambiguous() {
    let repaired = found(&R2::default(), &hairpin(1.0));
    assert_eq!(repaired.verdict, Verdict::Ambiguous, "right or wrong, nothing proves it");
    let sparse = of_tree(&R2::default(), &hairpin(1.0));
    assert_eq!(sparse.verdict, Verdict::Ambiguous);
    assert_ne!(sparse.order, (0..sparse.n).collect::<Vec<_>>());
    let bend = |at: &[usize; 2]| at.iter().any(|&row| hairpin(1.0)[row].x > 6.0);
    assert!(sparse.doubts.iter().any(|d| bend(&d.at)), "{:?}", sparse.doubts);
}

/// Thesis Figure 2.2: little curvature, but opposite sides come near. A flat loop of two lines 0.5 apart.
fn flat_loop(n: u32) -> Vec<Vector2<f64>> {
    let step = (20.0 + 0.5 * PI) / f64::from(n);
    let at = |s: f64| match s {
        s if s < 10.0 => Vector2::new(s, 0.0),
        s if s < 10.0 + 0.25 * PI => {
            let a = (s - 10.0) / 0.25;
            Vector2::new(10.0 + 0.25 * a.sin(), 0.25 - 0.25 * a.cos())
        }
        s if s < 20.0 + 0.25 * PI => Vector2::new(20.0 + 0.25 * PI - s, 0.5),
        s => {
            let a = (s - 20.0 - 0.25 * PI) / 0.25;
            Vector2::new(-0.25 * a.sin(), 0.25 + 0.25 * a.cos())
        }
    };
    (0..n).map(|k| at((f64::from(k) + 0.2) * step)).collect()
}

#[test]
fn strands_that_come_near_need_gaps_below_twice_the_reach() {
    assert_eq!(found(&R2::default(), &flat_loop(30)).verdict, Verdict::Ambiguous);
    let sparse = of_tree(&R2::default(), &flat_loop(30));
    assert_eq!(sparse.verdict, Verdict::Ambiguous);
    assert_ne!(sparse.order, (0..30).collect::<Vec<_>>());
    // Gaps of 0.072 against a reach of 0.25.
    let dense = found(&R2::default(), &flat_loop(300));
    assert_eq!((dense.verdict, dense.topology), (Verdict::Certified, Topology::Closed), "{:?}", dense.certificate);
    assert_eq!(dense.order, (0..300).collect::<Vec<_>>());
    // The parabola through samples of line and arc leans by less than half a step's turn, 0.14 rad: 2 %.
    assert!((dense.certificate.usable_reach.unwrap() / 0.25 - 1.0).abs() < 0.02);
}

/// Thesis Figure 5.4: one circle of radius sin θ in space, and on spheres. On the sphere its reach is the angle θ, more than in space;
/// on a great circle nothing bends, and half the injectivity radius is what counts.
#[test]
fn a_circle_needs_fewer_samples_on_a_sphere_than_in_space() {
    let n = 36;
    for theta in [0.3_f64, 0.7, 1.1, 0.5 * PI] {
        let ring: Vec<_> = (0..n)
            .map(|k| (TAU * f64::from(k) / f64::from(n)).sin_cos())
            .map(|(s, c)| Vector3::new(theta.sin() * c, theta.sin() * s, theta.cos()))
            .collect();
        let (space, sphere) = (found(&R3::default(), &ring).certificate, found(&Sphere, &ring).certificate);
        // Samples a tenth of the radius apart show a circle's reach up to rounding of 1e-16/0.17².
        assert!((space.usable_reach.unwrap() / theta.sin() - 1.0).abs() < 1e-12);
        // tan R by log is the flat formula for vanishing gaps h, less by h²/12 relative for neighbours; more distant pairs of a
        // circle give less still, R' = (d/2)·tan θ/tan(d/2): the estimate is cautious.
        let reach = sphere.usable_reach.unwrap();
        assert!(reach <= theta * (1.0 + 1e-9) && reach > 0.5 * theta, "{theta}: {reach}");
        assert!(reach > space.usable_reach.unwrap() * 0.5);
        assert_eq!(found(&Sphere, &ring).verdict, Verdict::Certified);
    }
}

/// Thesis Figure 5.5: a closed geodesic, whose medial axis is farther away than the curve is long, so that three samples seem
/// enough; but a gap beyond the injectivity radius is bridged the wrong way round. Here it is a full turn.
#[test]
fn a_closed_geodesic_needs_gaps_within_the_injectivity_radius() {
    let turned = |angle: f64| UnitQuaternion::from_scaled_axis(Vector3::z() * angle);
    let few: Vec<_> = [0.0, 1.2, 2.4].map(turned).into();
    let sparse = found(&So3, &few);
    assert_eq!(sparse.certificate.reach, None, "nothing bends");
    // The true closing gap is 3.9, the way back through the samples 2.4.
    assert!((So3.distance(&few[2], &few[0]) - 2.4).abs() < 1e-12);
    assert_eq!(sparse.verdict, Verdict::Ambiguous);
    let dense: Vec<_> = (0..24).map(|k| turned(TAU * f64::from(k) / 24.0)).collect();
    let dense = found(&So3, &dense);
    assert_eq!((dense.verdict, dense.topology), (Verdict::Certified, Topology::Closed));
    // Half the injectivity radius, however straight the curve.
    assert!((dense.certificate.usable_reach.unwrap_or(0.5 * PI) - 0.5 * PI).abs() < 1e-6);
}

/// Every pair, as Federer's formula has it, with the tangent of the parabola through three points.
fn brute_reach(points: &[Vector3<f64>]) -> f64 {
    let n = points.len();
    let mut reach = f64::INFINITY;
    for i in 0..n {
        let (a, b) = (points[(i + n - 1) % n] - points[i], points[(i + 1) % n] - points[i]);
        let tangent = (b * (a.norm() / b.norm()) - a * (b.norm() / a.norm())).normalize();
        for j in (0..n).filter(|&j| j != i) {
            let v = points[j] - points[i];
            reach = reach.min(v.norm_squared() / (2.0 * (v - tangent * tangent.dot(&v)).norm()));
        }
    }
    reach
}

#[test]
fn the_reach_is_that_of_all_pairs() {
    let mut random = Random::seeded(61);
    for n in [200, 900, 1900, 2600, 5000] {
        let curve = Measured::closed(R3::default(), space_curve(&mut random));
        let samples = curve.sample(&mut random, n, Spacing::Jittered(0.3));
        let found = found(&R3::default(), &samples);
        if found.topology != Topology::Closed {
            continue;
        }
        let (reach, brute) = (found.certificate.reach.unwrap(), brute_reach(&samples));
        if n <= 2000 {
            assert!((reach / brute - 1.0).abs() < 1e-9, "{n}: {reach} {brute}");
        } else {
            // Thinned: at most 1/16 too much.
            assert!(reach >= brute * (1.0 - 1e-9) && reach <= brute * (1.0 + 1.0 / 16.0), "{n}: {reach} {brute}");
        }
    }
}

/// Two strands whose distance is 40 gaps, far beyond the neighbourhoods that are searched at full density.
#[test]
fn a_thinned_curve_shows_strands_that_pass_each_other() {
    let strand = |y: f64| (0..3000).map(move |k| Vector2::new(0.01 * f64::from(k), y));
    let bend =
        (1..63).map(|k| PI * f64::from(k) / 63.0).map(|a| Vector2::new(29.99 + 0.2 * a.sin(), 0.2 - 0.2 * a.cos()));
    let points: Vec<_> =
        strand(0.0).chain(bend).chain(strand(0.4).rev().map(|p| p + Vector2::new(0.003, 0.0))).collect();
    let reach = found(&R2::default(), &points).certificate.reach.unwrap();
    assert!(reach > 0.19 && reach < 0.2 * (1.0 + 1.0 / 16.0), "{reach}");
}
