//! The promises of [`PoseSpline`], tested by their definitions.

use std::sync::atomic::{AtomicUsize, Ordering};

use proptest::prelude::*;

use super::*;
use crate::{Se3, centripetal_knots, pose_from_xyzw};
use nalgebra::UnitQuaternion;

fn pose(p: [f64; 3], rotation_vector: [f64; 3]) -> Pose {
    Pose::from_parts(Vector3::from(p).into(), So3Group::exp(rotation_vector.into()))
}

/// Curves in which successive poses differ by up to 0.2 m an axis and up to 150° about any axis.
fn walks() -> impl Strategy<Value = Vec<Pose>> {
    let axis = prop::array::uniform3(-1.0..1.0_f64);
    let step = (prop::array::uniform3(-0.2..0.2_f64), axis, 0.01..150.0_f64);
    prop::collection::vec(step, 3..20).prop_map(|steps| {
        let mut now = pose([0.3, -0.2, 0.5], [0.4, 0.1, -0.3]);
        let mut all = vec![now];
        for (p, axis, degrees) in steps {
            let axis = Vector3::from(axis) + Vector3::new(1e-3, 0.0, 0.0);
            let turn = So3Group::exp(axis.normalize() * degrees.to_radians());
            now = Pose::from_parts((now.translation.vector + Vector3::from(p)).into(), now.rotation * turn);
            all.push(now);
        }
        all
    })
}

fn ends() -> impl Strategy<Value = Ends> {
    let twist = || prop::array::uniform6(-0.5..0.5_f64).prop_map(|v| Twist::from_vector(&v.into()));
    prop_oneof![
        Just(Ends::Natural),
        Just(Ends::Periodic),
        (twist(), twist()).prop_map(|(start, end)| Ends::Clamped { start, end })
    ]
}

fn knots_for(poses: &[Pose], ends: Ends) -> Vec<f64> {
    let mut loop_of = poses.to_vec();
    if ends == Ends::Periodic {
        loop_of.push(poses[0]);
    }
    centripetal_knots(&Se3::default(), &loop_of)
}

/// How many random curves were fitted and how many refused, over all tests of this process.
static FITTED: AtomicUsize = AtomicUsize::new(0);
static REFUSED: AtomicUsize = AtomicUsize::new(0);

fn fit(poses: &[Pose], ends: Ends) -> Option<PoseSpline> {
    match PoseSpline::through(poses, &knots_for(poses, ends), ends) {
        Ok(spline) => {
            FITTED.fetch_add(1, Ordering::Relaxed);
            Some(spline)
        }
        // A random closing segment may be half a turn, or wind: both are named refusals, not curves.
        Err(SplineError::HalfTurn { .. } | SplineError::Winding { .. } | SplineError::Overshoot { .. }) => {
            let refused = REFUSED.fetch_add(1, Ordering::Relaxed);
            let fitted = FITTED.load(Ordering::Relaxed);
            assert!(
                refused < 20 + fitted,
                "more refused than fitted: the laws are hardly tested ({refused}, {fitted})"
            );
            None
        }
        Err(other) => panic!("{other}"),
    }
}

fn distance(a: &Pose, b: &Pose) -> f64 {
    Se3::default().distance(a, b)
}

fn twist_norm(t: Twist) -> f64 {
    t.to_vector().norm()
}

fn greatest(spline: &PoseSpline, of: impl Fn(&Motion) -> f64) -> f64 {
    let (a, b) = spline.domain();
    (0..=400).map(|k| of(&spline.at(a + (b - a) * k as f64 / 400.0))).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, rng_seed: prop::test_runner::RngSeed::Fixed(7), ..ProptestConfig::default() })]

    /// C² by its definition: at every knot the limits of pose, twist and acceleration from the left and from the right agree to
    /// 1e-11 of the greatest value on the curve, and the pose is the given one to 1e-12.
    #[test]
    fn twist_and_acceleration_are_continuous_and_poses_are_passed(poses in walks(), ends in ends()) {
        let Some(spline) = fit(&poses, ends) else { return Ok(()) };
        let knots = spline.knots().to_vec();
        let segments = knots.len() - 1;
        let (speed, force) = (greatest(&spline, |m| twist_norm(m.twist)), greatest(&spline, |m| twist_norm(m.acceleration)));
        for i in 0..segments {
            let left = spline.in_segment(i, knots[i + 1] - knots[i]);
            prop_assert!(distance(&spline.in_segment(i, 0.0).pose, &poses[i]) < 1e-12);
            prop_assert!(distance(&left.pose, &poses[(i + 1) % poses.len()]) < 1e-12);
            let right = match ends {
                Ends::Periodic => spline.in_segment((i + 1) % segments, 0.0),
                _ if i + 1 == segments => continue,
                _ => spline.in_segment(i + 1, 0.0),
            };
            prop_assert!(twist_norm(left.twist - right.twist) < 1e-11 * speed);
            prop_assert!(twist_norm(left.acceleration - right.acceleration) < 1e-11 * force);
        }
        let (start, end) = (spline.in_segment(0, 0.0), spline.in_segment(segments - 1, knots[segments] - knots[segments - 1]));
        match ends {
            Ends::Natural => {
                prop_assert!(twist_norm(start.acceleration) < 1e-11 * force);
                prop_assert!(twist_norm(end.acceleration) < 1e-11 * force);
            }
            Ends::Clamped { start: s, end: e } => {
                prop_assert!(twist_norm(start.twist - s) < 1e-11 * speed);
                prop_assert!(twist_norm(end.twist - e) < 1e-11 * speed);
            }
            Ends::Periodic => {}
        }
    }

    /// Moving all poses by g moves the curve by g, and leaves body twists and accelerations as they are.
    #[test]
    fn left_invariant(poses in walks(), ends in ends(), p in prop::array::uniform3(-2.0..2.0_f64), r in prop::array::uniform3(-1.7..1.7_f64)) {
        let Some(spline) = fit(&poses, ends) else { return Ok(()) };
        let g = pose(p, r);
        let moved: Vec<_> = poses.iter().map(|x| g * x).collect();
        let moved = PoseSpline::through(&moved, spline.knots(), ends).unwrap();
        let force = greatest(&spline, |m| twist_norm(m.acceleration));
        let (a, b) = spline.domain();
        for k in 0..97 {
            let t = a + (b - a) * k as f64 / 97.0;
            let (x, y) = (spline.at(t), moved.at(t));
            prop_assert!(distance(&(g * x.pose), &y.pose) < 1e-11);
            prop_assert!(twist_norm(x.acceleration - y.acceleration) < 1e-11 * force);
        }
    }

    /// Reversing the poses reverses the curve: same poses and accelerations, opposite twists.
    #[test]
    fn reversal_symmetric(poses in walks(), ends in ends()) {
        let Some(spline) = fit(&poses, ends) else { return Ok(()) };
        let (a, b) = spline.domain();
        let mut back = poses.clone();
        if ends == Ends::Periodic {
            back[1..].reverse();
        } else {
            back.reverse();
        }
        let back_knots: Vec<_> = spline.knots().iter().rev().map(|k| a + b - k).collect();
        let back_ends = match ends {
            Ends::Clamped { start, end } => Ends::Clamped { start: -end, end: -start },
            other => other,
        };
        let reversed = PoseSpline::through(&back, &back_knots, back_ends).unwrap();
        let (speed, force) = (greatest(&spline, |m| twist_norm(m.twist)), greatest(&spline, |m| twist_norm(m.acceleration)));
        for k in 1..97 {
            let t = a + (b - a) * k as f64 / 97.0;
            let (x, y) = (spline.at(t), reversed.at(a + b - t));
            prop_assert!(distance(&x.pose, &y.pose) < 1e-11);
            prop_assert!(twist_norm(x.twist + y.twist) < 1e-11 * speed);
            prop_assert!(twist_norm(x.acceleration - y.acceleration) < 1e-11 * force);
        }
    }

    /// Twist, acceleration and jerk are the derivatives of the pose, twist and acceleration. Fourth-order differences over
    /// h = 1e-3 of the segment leave h⁴·f⁽⁵⁾ plus rounding 1e-16/h, relative to the segment's own scale: 1e-7 bounds both.
    #[test]
    fn derivatives_are_derivatives(poses in walks(), ends in ends()) {
        let Some(spline) = fit(&poses, ends) else { return Ok(()) };
        let knots = spline.knots().to_vec();
        for i in 0..knots.len() - 1 {
            let h = (knots[i + 1] - knots[i]) * 1e-3;
            let at = |k: f64| spline.in_segment(i, 0.3 * (knots[i + 1] - knots[i]) + k * h);
            let m = at(0.0);
            let stencil = |f: &dyn Fn(f64) -> Vector3<f64>| (f(-2.0) - f(2.0) + (f(1.0) - f(-1.0)) * 8.0) / (12.0 * h);
            let close = |difference: Vector3<f64>, exact: Vector3<f64>, scale: f64| (difference - exact).norm() < 1e-7 * scale;
            let world = |v: Vector3<f64>, k: f64| m.pose.rotation.inverse() * (at(k).pose.rotation * v);
            let chart = |k: f64| So3Group::log(&(m.pose.rotation.inverse() * at(k).pose.rotation)).unwrap();
            let whole = knots[i + 1] - knots[i];
            let scales = [twist_norm(m.twist) + 1.0 / whole, twist_norm(m.acceleration) + 1.0 / whole.powi(2), twist_norm(m.jerk) + 1.0 / whole.powi(3)];
            // The chart at m has d/dt log = ω there, exactly, to first order; its higher terms vanish at k = 0 in the difference.
            prop_assert!(close(stencil(&chart), m.twist.angular, scales[0]));
            prop_assert!(close(stencil(&|k| m.pose.rotation.inverse() * at(k).pose.translation.vector), m.twist.linear, scales[0]));
            prop_assert!(close(stencil(&|k| at(k).twist.angular), m.acceleration.angular, scales[1]));
            prop_assert!(close(stencil(&|k| world(at(k).twist.linear, k)), m.acceleration.linear, scales[1]));
            prop_assert!(close(stencil(&|k| at(k).acceleration.angular), m.jerk.angular, scales[2]));
            prop_assert!(close(stencil(&|k| world(at(k).acceleration.linear, k)), m.jerk.linear, scales[2]));
        }
    }
}

/// A smooth curve that is no spline.
fn smooth(t: f64) -> Pose {
    pose([t.sin(), 0.5 * (2.0 * t).cos(), 0.3 * t], [0.9 * t.sin(), 0.7 * (1.3 * t).cos(), 0.8 * t])
}

/// Error against the smooth curve between knots, away from the ends by one unit of t.
fn interior_error(n: usize) -> f64 {
    let knots: Vec<_> = (0..=n).map(|i| 4.0 * i as f64 / n as f64).collect();
    let poses: Vec<_> = knots.iter().map(|&t| smooth(t)).collect();
    let spline = PoseSpline::through(&poses, &knots, Ends::Natural).unwrap();
    (0..=1000).map(|k| 1.0 + 2.0 * k as f64 / 1000.0).map(|t| distance(&spline.pose(t), &smooth(t))).fold(0.0, f64::max)
}

/// Fourth order: halving the knot spacing divides the error by 2⁴; a lower order or a wrong N term gives 8 or less.
#[test]
fn converges_with_fourth_order() {
    let errors: Vec<_> = [20, 40, 80].map(interior_error).to_vec();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.7..4.4).contains(&order), "order {order}, errors {errors:?}");
    }
}

#[test]
fn steep_turns_are_solved() {
    // 175° between knots, alternating axes.
    let mut now = UnitQuaternion::identity();
    let mut poses = vec![Pose::from_parts(Vector3::zeros().into(), now)];
    for i in 0..12 {
        let axis = Vector3::new((i as f64).sin(), (2.0 * i as f64).cos(), 0.4).normalize();
        now *= So3Group::exp(axis * 175.0_f64.to_radians());
        poses.push(Pose::from_parts(Vector3::new(0.1 * i as f64, 0.0, 0.0).into(), now));
    }
    let even: Vec<_> = (0..poses.len()).map(|i| i as f64).collect();
    PoseSpline::through(&poses, &even, Ends::Natural).unwrap();
}

#[test]
fn refusals_name_the_place() {
    let identity = pose([0.0; 3], [0.0; 3]);
    let through = |poses: &[Pose], knots: &[f64]| PoseSpline::through(poses, knots, Ends::Natural).unwrap_err();
    assert_eq!(through(&[identity], &[0.0]), SplineError::TooFewPoses { needed: 2, given: 1 });
    assert_eq!(through(&[identity; 2], &[0.0]), SplineError::KnotCount { expected: 2, given: 1 });
    assert_eq!(through(&[identity; 3], &[0.0, 1.0, 1.0]), SplineError::KnotsNotIncreasing { index: 2, value: 1.0 });
    let turned = pose_from_xyzw([0.0; 3], [1.0, 0.0, 0.0, 0.0]).unwrap();
    assert_eq!(through(&[identity, turned], &[0.0, 1.0]), SplineError::HalfTurn { from: 0, to: 1 });
    let nan = pose([f64::NAN, 0.0, 0.0], [0.0; 3]);
    assert_eq!(through(&[identity, nan], &[0.0, 1.0]), SplineError::NonFinitePose { index: 1 });
    let closed = PoseSpline::through(&[identity; 2], &[0.0, 1.0, 2.0], Ends::Periodic).unwrap_err();
    assert_eq!(closed, SplineError::TooFewPoses { needed: 3, given: 2 });
}
