//! Cubic splines in flat space against exact ones, and what they refuse.
#![allow(missing_docs, clippy::unwrap_used)]

use se3_geom::nalgebra::Vector1;
use se3_geom::{CubicEnds, CubicSpline, Curve, SplineError};

/// Splines against exact rational solutions (`data/make_cubic_splines.py`), to a few roundings of what they are the sums of.
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
        let all_values = values.clone();
        if ends == CubicEnds::Periodic {
            values.pop();
        }
        let points: Vec<_> = values.iter().copied().map(Vector1::new).collect();
        let curve = CubicSpline::through(&points, &knots, ends).unwrap();
        let exact: Vec<_> = case["derivatives"].as_array().unwrap().iter().map(numbers).collect();
        let greatest = |k: usize| exact.iter().map(|d| d[k].abs()).fold(1e-300, f64::max);
        // What the second derivative at a knot is the sum of, 6d/h² − (4v₀ + 2v₁)/h, on the longer of its sides: its rounding is
        // relative to that, and what the pieces are made of has no other.
        let pieces = knots.len() - 1;
        let length = |piece: usize| knots[piece + 1] - knots[piece];
        let bend_terms = |knot: usize| {
            let closing = (ends == CubicEnds::Periodic && knot.is_multiple_of(pieces)).then_some([pieces - 1, 0]);
            let sides = closing.unwrap_or([knot.saturating_sub(1), knot.min(pieces - 1)]);
            let longer = if length(sides[0]) > length(sides[1]) { sides[0] } else { sides[1] };
            let (d, h) = (all_values[longer + 1] - all_values[longer], length(longer));
            6.0 * d.abs() / (h * h) + 6.0 * greatest(1) / h
        };
        // The equations are diagonally dominant but for the end rows of not-a-knot, v₀ + (1 + h₀/h₁)v₁ = …
        let growth = match ends {
            CubicEnds::NotAKnot if pieces > 1 => {
                1.0 + (length(0) / length(1)).max(length(pieces - 1) / length(pieces - 2))
            }
            _ => 1.0,
        };
        let few = 16.0 * f64::EPSILON * growth;
        for (t, exact) in numbers(&case["at"]).iter().zip(&exact) {
            let piece = knots.partition_point(|k| k <= t) - 1;
            let h = length(piece);
            let bend = few * bend_terms(piece).max(bend_terms(piece + 1));
            let bounds = [few * greatest(0) + bend * h * h, few * greatest(1) + bend * h, bend, 2.0 * bend / h];
            let d = curve.derivatives(*t);
            for (k, found) in [d.point, d.velocity, d.acceleration, d.jerk].into_iter().enumerate() {
                let error = (found.x - exact[k]).abs();
                assert!(error <= bounds[k], "{} at {t}, derivative {k}: {error:e} {:e}", case["name"], bounds[k]);
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
