//! Cubic splines in flat space against exact ones, and what they refuse.
#![allow(missing_docs, clippy::unwrap_used)]

use se3_geom::nalgebra::Vector1;
use se3_geom::{CubicEnds, CubicSpline, Curve, SplineError};

/// Splines against exact rational solutions (`data/make_cubic_splines.py`): value, slope and second derivative within a few
/// roundings of the greatest of their kind, which near steep knots is large.
#[test]
fn cubic_splines_equal_the_exact_ones() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cubic_splines.json")).unwrap();
    let cases: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    assert!(cases.len() > 40);
    for case in &cases {
        let numbers =
            |v: &serde_json::Value| -> Vec<f64> { v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
        let (knots, mut values) = (numbers(&case["knots"]), numbers(&case["values"]));
        let slope = |i: usize| Vector1::new(case["slopes"][i].as_f64().unwrap());
        let ends = match case["ends"].as_str().unwrap() {
            "natural" => CubicEnds::Natural,
            "clamped" => CubicEnds::Clamped { start: slope(0), end: slope(1) },
            "periodic" => CubicEnds::Periodic,
            _ => CubicEnds::NotAKnot,
        };
        if ends == CubicEnds::Periodic {
            values.pop();
        }
        let points: Vec<_> = values.iter().copied().map(Vector1::new).collect();
        let curve = CubicSpline::through(&points, &knots, ends).unwrap();
        let exact: Vec<_> = case["derivatives"].as_array().unwrap().iter().map(numbers).collect();
        let greatest = |k: usize| exact.iter().map(|d| d[k].abs()).fold(1e-300, f64::max);
        // A rounding of the data is divided by the smallest gap for every derivative, and a long piece next to a short one
        // multiplies the short one's error of slope by its length; a piece's value is the sum of its Taylor terms.
        let gap = knots.windows(2).map(|k| k[1] - k[0]).fold(f64::INFINITY, f64::min);
        let rounding = values.iter().map(|v| v.abs()).fold(0.0, f64::max) * f64::EPSILON;
        for (t, exact) in numbers(&case["at"]).iter().zip(&exact) {
            let piece = knots.partition_point(|k| k <= t) - 1;
            let h = knots[piece + 1] - knots[piece];
            let term = |j: usize, k: usize| exact[j].abs() * h.powi((j - k) as i32) / [1.0, 1.0, 2.0, 6.0][j - k];
            let d = curve.derivatives(*t);
            for (k, found) in [d.point, d.velocity, d.acceleration, d.jerk].into_iter().enumerate() {
                let terms: f64 = (k..4).map(|j| term(j, k)).sum();
                let bound =
                    20.0 * (f64::EPSILON * (greatest(k) + terms) + rounding * (h / gap).max(1.0) / gap.powi(k as i32));
                assert!((found.x - exact[k]).abs() < bound, "{} at {t}: {} {}", case["name"], found.x, exact[k]);
            }
        }
    }
}

#[test]
fn cubic_spline_refusals_name_the_place() {
    let points = [1.0, 2.0, 4.0].map(Vector1::new);
    let through = |points: &[Vector1<f64>], knots: &[f64], ends| CubicSpline::through(points, knots, ends).unwrap_err();
    let natural = CubicEnds::Natural;
    assert_eq!(through(&points[..1], &[0.0], natural), SplineError::TooFewPoses { needed: 2, given: 1 });
    assert_eq!(through(&points, &[0.0, 1.0], natural), SplineError::KnotCount { expected: 3, given: 2 });
    assert_eq!(
        through(&points, &[0.0, 1.0, 2.0], CubicEnds::Periodic),
        SplineError::KnotCount { expected: 4, given: 3 }
    );
    assert_eq!(through(&points, &[0.0, 2.0, 1.0], natural), SplineError::KnotsNotIncreasing { index: 2, value: 1.0 });
    let infinite = [points[0], Vector1::new(f64::INFINITY)];
    assert_eq!(through(&infinite, &[0.0, 1.0], natural), SplineError::NonFinitePose { index: 1 });
    let ends = CubicEnds::Clamped { start: Vector1::new(f64::NAN), end: points[0] };
    assert_eq!(through(&points, &[0.0, 1.0, 2.0], ends), SplineError::NonFiniteEndVelocity);
    let far = [-1e300, 1e300, -1e300].map(Vector1::new);
    assert_eq!(through(&far, &[0.0, 1e-200, 2e-200], natural), SplineError::Overflow);
}
