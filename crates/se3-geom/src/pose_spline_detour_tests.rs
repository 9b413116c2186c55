//! Which curves are refused for going somewhere else: the thresholds, the units, and where a closed curve begins.

use super::*;
use crate::{Manifold, Se3};

/// The scalar cubic on \[0, 1\] from 0 to 1 with slope v at both ends has the slope v + 6(1 − v)τ(1 − τ) and, for v > 3, goes back
/// on its way. The v with which it travels `length`, to a thousandth.
fn end_slope_for_length(length: f64) -> f64 {
    const POINTS: usize = 2000;
    let travelled = |v: f64| -> f64 {
        let slope = |tau: f64| v + 6.0 * (1.0 - v) * tau * (1.0 - tau);
        (0..POINTS).map(|k| slope((k as f64 + 0.5) / POINTS as f64).abs()).sum::<f64>() / POINTS as f64
    };
    let (mut low, mut high) = (3.0, 100.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if travelled(middle) < length { low = middle } else { high = middle }
    }
    low
}

fn clamped(end: Pose, twist: Twist) -> Result<PoseSpline, SplineError> {
    PoseSpline::through(&[Pose::identity(), end], &[0.0, 1.0], Ends::Clamped { start: twist, end: twist })
}

/// A step d may become a way of 3 d, measured by sixteen points, which here are right to 1 %: 2.94 d passes, 3.06 d does not.
#[test]
fn a_way_of_three_steps_is_the_longest() {
    for step_m in [0.05, 4.0] {
        let through = |ratio: f64| {
            let along = Vector3::new(0.6, 0.0, 0.8) * step_m;
            clamped(
                Pose::from_parts(along.into(), Default::default()),
                Twist::new(along * end_slope_for_length(ratio), Vector3::zeros()),
            )
        };
        through(2.94).unwrap();
        let refused = through(3.06).unwrap_err();
        let SplineError::Overshoot { from: 0, to: 1, travelled_m, distance_m, residual } = refused else {
            panic!("{refused}")
        };
        assert!((travelled_m - 3.06 * step_m).abs() < 0.03 * step_m && (distance_m - step_m).abs() < 1e-15 * step_m);
        assert_eq!(residual, 0.0, "one segment has no inner knot");
    }
}

/// The same of angles, of which no more than half a turn may be added.
#[test]
fn a_turn_of_three_steps_or_half_a_turn_more_is_the_greatest() {
    for (step_rad, most) in [(0.5, 3.0), (1.2, 3.0), (2.5, 1.0 + PI / 2.5)] {
        let through = |ratio: f64| {
            let turn = Vector3::new(0.6, 0.0, 0.8) * step_rad;
            let end = Pose::from_parts(Vector3::zeros().into(), So3Group::exp(turn));
            clamped(end, Twist::new(Vector3::zeros(), turn * end_slope_for_length(ratio)))
        };
        through(0.98 * most).unwrap_or_else(|e| panic!("{step_rad}: {e}"));
        let refused = through(1.02 * most).unwrap_err();
        assert!(
            matches!(refused, SplineError::Winding { turned_rad, .. } if (turned_rad / (1.02 * most * step_rad) - 1.0).abs() < 0.01),
            "{refused}"
        );
    }
}

/// The verdict knows no unit of length: an overshoot in nanometres is one; and far from the origin the last digits of positions
/// that stand still are none.
#[test]
fn rounding_of_positions_is_relative_to_them() {
    let knots = [0.0, 1.0, 1.01, 2.01, 2.02, 3.02, 3.03];
    let through = |scale: f64, offset: f64| {
        let at = |i: usize| Pose::translation(offset + scale * 0.05 * i as f64, scale * 0.02 * (i % 2) as f64, 0.0);
        PoseSpline::through(&(0..7).map(at).collect::<Vec<_>>(), &knots, Ends::Natural)
    };
    for scale in [1e-9, 1e-6, 1.0, 1e6] {
        assert!(matches!(through(scale, 0.0), Err(SplineError::Overshoot { .. })), "scale {scale}");
    }
    for offset in [1.0, 1e3, 1e8] {
        // Along x the steps are half a rounding, which comes to none or one.
        through(10.0 * f64::EPSILON * offset, offset).unwrap_or_else(|e| panic!("offset {offset}: {e}"));
    }
}

/// A closed curve has no first pose: beginning at any of them gives the same verdict and the same curve.
#[test]
fn a_closed_curve_may_begin_anywhere() {
    let mut state = 0_u64;
    let mut random = || {
        // SplitMix64 (Steele, Lea and Flood 2014).
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let (mut accepted, mut refused) = (0, 0);
    for case in 0..300 {
        let count = 3 + case % 5;
        let stretch: Vec<_> = (0..count).map(|_| 10_f64.powf(random())).collect();
        let mut vector = || Vector3::from_fn(|_, _| random());
        let poses: Vec<_> =
            (0..count).map(|_| Pose::from_parts(vector().into(), So3Group::exp(vector() * 3.0))).collect();
        let beginning_at = |first: usize| {
            let at = |i: usize| &poses[(first + i) % count];
            let mut knots = vec![0.0];
            for i in 0..count {
                let gap = Se3::default().distance(at(i), at(i + 1)).sqrt() * stretch[(first + i) % count];
                knots.push(knots[i] + gap);
            }
            let poses: Vec<_> = (0..count).map(|i| *at(i)).collect();
            PoseSpline::through(&poses, &knots, Ends::Periodic)
        };
        let original = beginning_at(0);
        *(if original.is_ok() { &mut accepted } else { &mut refused }) += 1;
        for first in 1..count {
            match (&original, beginning_at(first)) {
                (Ok(original), Ok(rotated)) => {
                    let force = (0..count).map(|i| original.in_segment(i, 0.0).acceleration.to_vector().norm());
                    let force = force.fold(0.0, f64::max);
                    for (segment, part) in (0..count).flat_map(|i| [(i, 0.0), (i, 0.3), (i, 0.8)]) {
                        let at = |curve: &PoseSpline, i: usize| {
                            curve.in_segment(i, part * (curve.knots[i + 1] - curve.knots[i]))
                        };
                        let (x, y) = (at(original, segment), at(&rotated, (segment + count - first) % count));
                        assert!(Se3::default().distance(&x.pose, &y.pose) < 1e-11, "case {case} from {first}");
                        // The promise of continuity, 1e-11 of the greatest, for two curves.
                        assert!(
                            (x.acceleration - y.acceleration).to_vector().norm() < 2e-11 * force,
                            "case {case} from {first}"
                        );
                    }
                }
                (Err(_), Err(_)) => {}
                (original, rotated) => {
                    panic!("case {case} from {first}: {:?} {:?}", original.as_ref().err(), rotated.err())
                }
            }
        }
    }
    assert!(accepted >= 50 && refused >= 30, "{accepted} {refused}");
}
