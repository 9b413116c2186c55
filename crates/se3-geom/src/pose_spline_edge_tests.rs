//! What happens at the edges: beyond the domain, next to half turns, with very uneven knots.

use super::*;
use crate::{Manifold, Se3, centripetal_knots};
use nalgebra::UnitQuaternion;

fn turned_by(rotation_vector: Vector3<f64>) -> Pose {
    Pose::from_parts(Vector3::zeros().into(), So3Group::exp(rotation_vector))
}

/// Rotations `degrees` apart about axes that wander.
fn wandering(n: usize, degrees: f64, seed: f64) -> Vec<Pose> {
    let mut now = UnitQuaternion::identity();
    let mut poses = vec![Pose::from_parts(Vector3::zeros().into(), now)];
    for i in 0..n {
        let phase = seed + 1.7 * i as f64;
        let axis = Vector3::new(phase.sin(), (2.0 * phase).cos(), (3.1 * phase).sin() + 0.2).normalize();
        now *= So3Group::exp(axis * degrees.to_radians());
        poses.push(Pose::from_parts(Vector3::new(0.1 * i as f64, 0.0, 0.0).into(), now));
    }
    poses
}

/// Knots with spacings between 1 and `ratio`, log-uniform by a hash of place and seed.
fn uneven(n: usize, ratio: f64, seed: f64) -> Vec<f64> {
    let mut knots = vec![0.0];
    for i in 0..n {
        let hash = (12.9898 * (i + 1) as f64 + 78.233 * seed).sin() * 43_758.545_3;
        knots.push(knots[i] + f64::powf(ratio, hash - hash.floor()));
    }
    knots
}

#[test]
fn an_open_curve_stays_at_its_ends_and_a_closed_one_goes_round() {
    let poses = wandering(6, 50.0, 0.3);
    let open = PoseSpline::through(&poses, &uneven(6, 1.5, 0.0), Ends::Natural).unwrap();
    let (first, last) = open.domain();
    assert_eq!(open.at(first - 3.0), open.at(first));
    assert_eq!(open.at(last + 3.0), open.at(last));
    let closed = PoseSpline::through(&poses, &uneven(7, 1.5, 0.0), Ends::Periodic).unwrap();
    let (first, last) = closed.domain();
    for t in [0.1, 2.0, 6.9] {
        for rounds in [-2.0, 1.0, 3.0] {
            let (here, again) = (closed.at(first + t), closed.at(first + t + rounds * (last - first)));
            // t is rounded to the size of three rounds, about 30: 4e-15 times speeds and accelerations of about 1.
            assert!(Se3::default().distance(&here.pose, &again.pose) < 1e-13);
            assert!((here.acceleration - again.acceleration).to_vector().norm() < 1e-12);
        }
    }
}

#[test]
fn knots_are_centripetal() {
    let at = |x: f64| Pose::translation(x, 0.0, 0.0);
    // Gaps 4 and 9: square roots 2 and 3.
    assert_eq!(centripetal_knots(&Se3::default(), &[at(0.0), at(4.0), at(13.0)]), [0.0, 2.0, 5.0]);
    assert!(centripetal_knots(&Se3::default(), &[]).is_empty());
}

#[test]
fn turns_within_rounding_of_half_a_turn_are_refused_and_others_are_not() {
    let through = |angle: f64| {
        PoseSpline::through(&[turned_by(Vector3::zeros()), turned_by(Vector3::x() * angle)], &[0.0, 1.0], Ends::Natural)
    };
    assert_eq!(through(PI - 0.5 * HALF_TURN_MARGIN_RAD).unwrap_err(), SplineError::HalfTurn { from: 0, to: 1 });
    assert!(through(PI - 2.0 * HALF_TURN_MARGIN_RAD).is_ok());
}

/// Clamped to a rate that takes it round several times between two knots, the curve is refused rather than drawn.
#[test]
fn a_curve_that_winds_is_refused() {
    let poses = [turned_by(Vector3::zeros()), turned_by(Vector3::x() * 0.5), turned_by(Vector3::x())];
    let spin = Twist::new(Vector3::zeros(), Vector3::x() * 40.0);
    let refused = PoseSpline::through(&poses, &[0.0, 1.0, 2.0], Ends::Clamped { start: spin, end: spin }).unwrap_err();
    let SplineError::Winding { from: 0, to: 1, turned_rad, difference_rad, .. } = refused else { panic!("{refused}") };
    assert!(turned_rad > difference_rad + WINDING_BOUND_RAD && (difference_rad - 0.5).abs() < 1e-15);
}

/// Solved means C²: what comes back has no acceleration jump. What is refused is refused because the curve winds, not because
/// the equations were left unsolved; at ratios of 100 and more Newton alone leaves some of these, the homotopy none.
#[test]
fn uneven_knots_are_solved_exactly_or_refused_for_winding() {
    let mut solved = 0;
    for (ratio, degrees) in
        [(10.0, 20.0), (10.0, 150.0), (100.0, 20.0), (100.0, 150.0), (1000.0, 20.0), (1000.0, 150.0)]
    {
        for case in 0..50 {
            let poses = wandering(10, degrees, 0.37 * f64::from(case));
            let knots = uneven(10, ratio, f64::from(case));
            let spline = match PoseSpline::through(&poses, &knots, Ends::Natural) {
                Ok(spline) => spline,
                Err(SplineError::Winding { residual, .. } | SplineError::Overshoot { residual, .. }) => {
                    assert!(residual < 1e-11, "ratio {ratio}, case {case}: {residual:e}");
                    continue;
                }
                Err(other) => panic!("ratio {ratio}, case {case}: {other}"),
            };
            solved += 1;
            for i in 0..9 {
                let left = spline.in_segment(i, knots[i + 1] - knots[i]).acceleration.angular;
                let right = spline.in_segment(i + 1, 0.0).acceleration.angular;
                // Relative to what an acceleration is the sum of: 4ω/h of the shorter neighbour.
                let shorter = (knots[i + 1] - knots[i]).min(knots[i + 2] - knots[i + 1]);
                let scale = 4.0 * spline.in_segment(i + 1, 0.0).twist.angular.norm() / shorter;
                assert!((left - right).norm() < 1e-11 * scale, "ratio {ratio}, case {case}, knot {}", i + 1);
            }
        }
    }
    // 61 were, when this was written; detours are told far from rounding.
    assert!(solved >= 55, "{solved}");
}

/// Where an orientation comes to an extremum, the terms of its own row vanish and the neighbours' cancel: rounding there is
/// relative to the neighbours.
#[test]
fn orientations_that_swing_and_come_back_are_solved() {
    for n in [5, 11, 40, 201] {
        for amplitude in [0.01, 0.26, 1.0] {
            for shape in [
                |x: f64| (std::f64::consts::TAU * x).sin(),
                |x: f64| (PI * x).sin(),
                |x: f64| 1.0 - 2.0 * (2.0 * x - 1.0).abs(),
            ] {
                let lean = |i: usize| Vector3::y() * (amplitude * shape(i as f64 / n as f64));
                let poses: Vec<_> = (0..=n)
                    .map(|i| {
                        Pose::from_parts(Vector3::x().scale(0.3 * i as f64 / n as f64).into(), So3Group::exp(lean(i)))
                    })
                    .collect();
                let knots = centripetal_knots(&Se3::with_metres_per_radian(0.1).unwrap(), &poses);
                PoseSpline::through(&poses, &knots, Ends::Natural).unwrap_or_else(|e| panic!("{n} {amplitude}: {e}"));
            }
        }
    }
}

/// Knots so extreme that their inverse squares overflow, and rates that are no numbers, give no curve.
#[test]
fn numbers_that_overflow_are_refused() {
    let poses = wandering(2, 20.0, 0.1);
    for knots in [[0.0, 1e-170, 1.0], [0.0, 1e-200, 1e-199], [0.0, 1e-160, 1.0], [-1.7e308, 0.0, 1.7e308]] {
        let refused = PoseSpline::through(&poses, &knots, Ends::Natural);
        assert!(refused.is_err(), "{knots:?}");
    }
    let nan = Twist::new(Vector3::new(f64::NAN, 0.0, 0.0), Vector3::zeros());
    let clamped = Ends::Clamped { start: nan, end: Twist::zero() };
    assert_eq!(PoseSpline::through(&poses, &[0.0, 1.0, 2.0], clamped).unwrap_err(), SplineError::NonFiniteEndVelocity);
}

/// Even steps under knots a hundred times uneven: the cubic swings far out between the poses.
#[test]
fn a_curve_that_overshoots_is_refused() {
    let poses: Vec<_> = (0..7).map(|i| Pose::translation(0.05 * f64::from(i), 0.02 * f64::from(i % 2), 0.0)).collect();
    let knots = [0.0, 1.0, 1.01, 2.01, 2.02, 3.02, 3.03];
    let refused = PoseSpline::through(&poses, &knots, Ends::Natural).unwrap_err();
    assert!(
        matches!(refused, SplineError::Overshoot { travelled_m, distance_m, .. } if travelled_m > 2.0 * distance_m),
        "{refused}"
    );
    assert!(PoseSpline::through(&poses, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], Ends::Natural).is_ok());
}
