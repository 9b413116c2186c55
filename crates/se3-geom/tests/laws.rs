//! One law suite for every manifold and one for every group.
//!
//! Tolerances are multiples of the unit roundoff ε = 2.2e-16 times the size of the numbers involved; `scale` is that size.
#![allow(clippy::unwrap_used)]

use nalgebra::{Matrix6, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use se3_geom::{LieGroup, Manifold, Pose, R3, Se3, Se3Group, So3, So3Group, Twist, nalgebra};

const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

fn run<S: Strategy>(strategy: S, test: impl Fn(S::Value)) {
    let config = Config { cases: 2000, rng_seed: RngSeed::Fixed(11), failure_persistence: None, ..Config::default() };
    TestRunner::new(config)
        .run(&strategy, |value| {
            test(value);
            Ok(())
        })
        .unwrap();
}

/// Angles on both sides of every switch of branch, down to 1e-9 and up to just below π.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        (-9.0..0.3_f64).prop_map(|e| 10f64.powf(e)),
        (0.49..0.51_f64),
        (1.99..2.01_f64),
        (1e-9..1e-3_f64).prop_map(|gap| std::f64::consts::PI - gap),
    ]
}

fn direction() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64)
        .prop_filter("no direction", |v| Vector3::from(*v).norm() > 0.1)
        .prop_map(|v| Vector3::from(v).normalize())
}

fn rotation_vector() -> impl Strategy<Value = Vector3<f64>> {
    (direction(), angle()).prop_map(|(d, a)| d * a)
}

/// Displacements from a micrometre to a kilometre.
fn displacement() -> impl Strategy<Value = Vector3<f64>> {
    (direction(), -6.0..3.0_f64).prop_map(|(d, e)| d * 10f64.powf(e))
}

fn rotation() -> impl Strategy<Value = UnitQuaternion<f64>> {
    rotation_vector().prop_map(So3Group::exp)
}

fn pose() -> impl Strategy<Value = Pose> {
    (displacement(), rotation()).prop_map(|(p, r)| Pose::from_parts(p.into(), r))
}

fn twist() -> impl Strategy<Value = Twist> {
    (displacement(), rotation_vector()).prop_map(|(v, w)| Twist::new(v, w))
}

/// Laws of a Riemannian manifold. `size` bounds the numbers a point is made of, `gap` measures how far two points are apart
/// independently of the metric under test.
fn manifold_laws<M: Manifold, P: Strategy<Value = M::Point>, T: Strategy<Value = M::Tangent>>(
    m: &M,
    point: impl Fn() -> P,
    tangent: impl Fn() -> T,
    size: impl Fn(&M::Point) -> f64,
    gap: impl Fn(&M::Point, &M::Point) -> f64,
) {
    run((point(), tangent()), |(p, v)| {
        let q = m.exp(&p, v);
        let scale = 1.0 + size(&p) + size(&q);
        // exp and log are inverse, and the distance is the length of the logarithm. Half a turn less 1e-9 loses no digits.
        let back = m.log(&p, &q).unwrap();
        assert!(m.norm(&p, back - v) < ROUNDINGS * scale, "log(exp) {p:?} {v:?} {back:?}");
        assert!((m.distance(&p, &q) - m.norm(&p, v)).abs() < ROUNDINGS * scale, "distance {p:?} {v:?}");
        assert!(gap(&m.exp(&p, back), &q) < ROUNDINGS * scale, "exp(log) {p:?} {v:?}");
        // The geodesic starts at p, ends at q, and its middle is half way: a wrong sign of v would fail here.
        assert!(gap(&m.geodesic(&p, &q, 0.0).unwrap(), &p) < ROUNDINGS * scale);
        assert!(gap(&m.geodesic(&p, &q, 1.0).unwrap(), &q) < ROUNDINGS * scale);
        let middle = m.geodesic(&p, &q, 0.5).unwrap();
        let half = 0.5 * m.norm(&p, v);
        assert!((m.distance(&p, &middle) - half).abs() < ROUNDINGS * scale);
        assert!((m.distance(&middle, &q) - half).abs() < ROUNDINGS * scale);
        // Bilinear and positive.
        let k = 0.37;
        assert!((m.inner(&p, v * k, v) - k * m.inner(&p, v, v)).abs() <= ROUNDINGS * m.inner(&p, v, v));
        assert!(m.inner(&p, v, -v) <= 0.0);
    });
    run((point(), point(), point()), |(a, b, c)| {
        let scale = 1.0 + size(&a) + size(&b) + size(&c);
        assert_eq!(
            m.distance(&a, &b),
            m.distance(&b, &a),
            "symmetric to the last bit, so that edge weights do not depend on direction"
        );
        assert_eq!(m.distance(&a, &a), 0.0);
        assert!(m.distance(&a, &c) <= m.distance(&a, &b) + m.distance(&b, &c) + ROUNDINGS * scale, "triangle");
    });
}

#[test]
fn space_obeys_the_manifold_laws() {
    manifold_laws(&R3::default(), displacement, displacement, |p| p.norm(), |p, q| (p - q).norm());
}

#[test]
fn rotations_obey_the_manifold_laws() {
    let gap = |p: &UnitQuaternion<f64>, q: &UnitQuaternion<f64>| {
        (p.to_rotation_matrix().matrix() - q.to_rotation_matrix().matrix()).norm()
    };
    manifold_laws(&So3, rotation, rotation_vector, |_| 1.0, gap);
}

fn matrix_gap(p: &Pose, q: &Pose) -> f64 {
    (p.to_homogeneous() - q.to_homogeneous()).norm()
}

#[test]
fn poses_obey_the_manifold_laws() {
    for length_m in [0.05, 1.0, 20.0] {
        let metric = Se3::with_metres_per_radian(length_m).unwrap();
        let size = |p: &Pose| length_m.max(1.0) * (1.0 + p.translation.vector.norm());
        manifold_laws(&metric, pose, twist, size, matrix_gap);
    }
}

#[test]
fn the_pose_metric_is_left_invariant_and_weighs_as_stated() {
    let metric = Se3::with_weights(4.0, 9.0).unwrap();
    run((pose(), pose(), pose()), |(g, a, b)| {
        let scale =
            10.0 * (1.0 + g.translation.vector.norm() + a.translation.vector.norm() + b.translation.vector.norm());
        assert!((metric.distance(&(g * a), &(g * b)) - metric.distance(&a, &b)).abs() < ROUNDINGS * scale);
    });
    // d² = α·angle² + β·length² with 4·0.5² + 9·2² = 37
    let a = Pose::identity();
    let b = Pose::from_parts(Vector3::new(0.0, 2.0, 0.0).into(), So3Group::exp(Vector3::new(0.3, 0.0, 0.4)));
    assert!((metric.distance(&a, &b) - 37f64.sqrt()).abs() < 1e-14);
    assert!((metric.metres_per_radian() - 2.0 / 3.0).abs() < 1e-15);
    assert!((metric.injectivity_radius() - 2.0 * std::f64::consts::PI).abs() < 1e-15);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Se3::with_weights(bad, 1.0).is_none() && Se3::with_weights(1.0, bad).is_none());
    }
}

/// The reason why the screw norm is no distance: it breaks the triangle inequality, the product metric does not.
#[test]
fn the_screw_norm_is_no_distance() {
    let screw = |a: &Pose, b: &Pose| Se3Group::log(&(a.inverse() * b)).unwrap().to_vector().norm();

    let config = Config { cases: 3000, rng_seed: RngSeed::Fixed(3), failure_persistence: None, ..Config::default() };
    let near = || {
        (prop::array::uniform3(-1.0..1.0_f64), direction(), 0.1..3.0_f64)
            .prop_map(|(p, d, angle)| Pose::from_parts(Vector3::from(p).into(), So3Group::exp(d * angle)))
    };
    let broken_count = std::cell::Cell::new(0);
    TestRunner::new(config)
        .run(&(near(), near(), near()), |(a, b, c)| {
            broken_count.set(broken_count.get() + usize::from(screw(&a, &c) > screw(&a, &b) + screw(&b, &c) + 1e-9));
            Ok(())
        })
        .unwrap();

    assert!(broken_count.get() > 0, "expected the screw norm to break the triangle inequality somewhere");
}

#[test]
fn half_turns_have_no_logarithm() {
    let half_turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(0.0, 0.0, 1.0, 0.0));
    let refused = So3.log(&UnitQuaternion::identity(), &half_turn).unwrap_err();
    assert_eq!(refused.distance, std::f64::consts::PI);
    assert!((So3.distance(&UnitQuaternion::identity(), &half_turn) - std::f64::consts::PI).abs() < 1e-15);
    let pose = Pose::from_parts(Vector3::new(3.0, 0.0, 0.0).into(), half_turn);
    let metric = Se3::default();
    let refused = metric.log(&Pose::identity(), &pose).unwrap_err();
    assert!((refused.distance - (std::f64::consts::PI.powi(2) + 9.0).sqrt()).abs() < 1e-14);
}

/// ‖exp(v+δ)·(exp(Jl δ)·exp(v))⁻¹‖ must fall with δ²: halving δ divides it by four. J = I, Jr in place of Jl, or a wrong
/// coefficient leaves a first-order error and a ratio of two.
#[test]
fn jacobians_are_derivatives_of_exp() {
    let v = Twist::from_vector(&Vector6::new(0.4, -0.8, 0.3, 0.9, -0.5, 0.7));
    let direction = Vector6::new(0.3, 0.5, -0.2, 0.6, 0.1, -0.4);
    for angle_factor in [1e-3, 1.0, 1.6, 2.2] {
        let v = Twist::new(v.linear, v.angular * angle_factor);
        let error = |h: f64, left: bool| {
            let stepped = Se3Group::exp(Twist::from_vector(&(v.to_vector() + direction * h)));
            let step = |jacobian: Matrix6<f64>| Se3Group::exp(Twist::from_vector(&(jacobian * direction * h)));
            let predicted = if left {
                step(Se3Group::left_jacobian(v)) * Se3Group::exp(v)
            } else {
                Se3Group::exp(v) * step(Se3Group::right_jacobian(v))
            };
            matrix_gap(&stepped, &predicted)
        };
        for left in [true, false] {
            let order = (error(2e-3, left) / error(1e-3, left)).log2();
            assert!((1.9..2.1).contains(&order), "order {order} at factor {angle_factor}, left {left}");
        }
        let w = v.angular;
        let product = So3Group::right_jacobian(w) * So3Group::right_jacobian_inverse(w);
        assert!((product - nalgebra::Matrix3::identity()).norm() < 1e-14);
    }
}

#[test]
fn groups_obey_the_group_laws() {
    let near = || (prop::array::uniform3(-2.0..2.0_f64), rotation_vector()).prop_map(|(v, w)| Twist::new(v.into(), w));
    run((near(), near(), near()), |(u, v, w)| {
        let (a, b, c) = (Se3Group::exp(u), Se3Group::exp(v), Se3Group::exp(w));
        let compose = Se3Group::compose;
        // Numbers up to about 10: a few hundred roundings.
        let tolerance = 1e3 * f64::EPSILON;
        assert!(matrix_gap(&compose(&compose(&a, &b), &c), &compose(&a, &compose(&b, &c))) < tolerance);
        assert!(matrix_gap(&compose(&a, &Se3Group::inverse(&a)), &Se3Group::identity()) < tolerance);
        let back = Se3Group::log(&a).unwrap();
        // V⁻¹ is well conditioned up to half a turn: its entries stay below π/2.
        assert!((back - u).to_vector().norm() < tolerance, "{u:?} {back:?}");
        let moved = compose(&compose(&a, &Se3Group::exp(v * 0.3)), &Se3Group::inverse(&a));
        let adjoined = Se3Group::adjoint(&a) * (v * 0.3).to_vector();
        assert!(matrix_gap(&moved, &Se3Group::exp(Twist::from_vector(&adjoined))) < 1e-12);
    });
}

/// exp against the power series of the 4×4 matrix, which shares no formula with it.
#[test]
fn exp_equals_the_matrix_exponential() {
    let near = || (prop::array::uniform3(-2.0..2.0_f64), rotation_vector()).prop_map(|(v, w)| Twist::new(v.into(), w));
    run(near(), |v| {
        let mut hat = nalgebra::Matrix4::zeros();
        hat.fixed_view_mut::<3, 3>(0, 0).copy_from(&v.angular.cross_matrix());
        hat.fixed_view_mut::<3, 1>(0, 3).copy_from(&v.linear);
        // Scaling and squaring: ‖hat/64‖ < 0.1, where 12 terms leave 0.1¹²/12! ≈ 2e-21.
        let small = hat / 64.0;
        let (mut sum, mut term) = (nalgebra::Matrix4::identity(), nalgebra::Matrix4::identity());
        for k in 1..=12 {
            term = term * small / k as f64;
            sum += term;
        }
        for _ in 0..6 {
            sum *= sum;
        }
        assert!((sum - Se3Group::exp(v).to_homogeneous()).norm() < 1e3 * f64::EPSILON * (1.0 + v.linear.norm()));
    });
}
