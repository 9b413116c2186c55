//! What each metric says beyond the laws.

use nalgebra::{Complex, Isometry2, Quaternion, Similarity2, UnitComplex, UnitQuaternion, Vector2, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use se3_geom::{
    LieGroup, LogError, Manifold, Pose, R3, Se2, Se3, Se3Group, Sim2, So2, So3, So3Group, Sphere, nalgebra,
};

use crate::samples::{direction, pose};
use crate::suite::{ROUNDINGS, run};

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

/// Eq. 4.21 weighs as stated: 10·(1² + 0.5²) + 3² + 4² = 37.5; rigid motions keep it, a scaling does not.
#[test]
fn the_similarity_metric_is_invariant_under_rigid_motions_only() {
    let metric = Sim2::with_weights(10.0, 1.0).unwrap();
    let a = Similarity2::identity();
    let b = Similarity2::new(nalgebra::Vector2::new(3.0, 4.0), -0.5, 1f64.exp());
    assert!((metric.distance(&a, &b) - 37.5f64.sqrt()).abs() < 1e-14);
    let rigid = Similarity2::new(nalgebra::Vector2::new(-2.0, 0.3), 1.2, 1.0);
    assert!((metric.distance(&(rigid * a), &(rigid * b)) - 37.5f64.sqrt()).abs() < 1e-14);
    let doubling = Similarity2::new(nalgebra::Vector2::zeros(), 0.0, 2.0);
    assert!((metric.distance(&(doubling * a), &(doubling * b)) - 112.5f64.sqrt()).abs() < 1e-13);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Sim2::with_weights(bad, 1.0).is_none() && Sim2::with_weights(1.0, bad).is_none());
        assert!(Se2::with_weights(bad, 1.0).is_none() && Se2::with_weights(1.0, bad).is_none());
    }
}

/// Each of these gives some number if nobody looks. Either way round, and against itself.
#[test]
fn what_is_no_point_has_no_logarithm() {
    fn refuses<M: Manifold>(m: &M, point: M::Point, no_points: impl IntoIterator<Item = M::Point>) {
        assert!(m.log(&point, &point).is_ok());
        for nowhere in no_points {
            for (from, into) in [(&point, &nowhere), (&nowhere, &point), (&nowhere, &nowhere)] {
                assert_eq!(m.log(from, into).err(), Some(LogError::NotAPoint), "{from:?} {into:?}");
            }
        }
    }
    let complex = |re, im| UnitComplex::new_unchecked(Complex::new(re, im));
    let no_planar_rotations =
        [(0.0, 0.0), (f64::NAN, 0.0), (1.0, f64::NAN), (2.0, 0.0), (f64::INFINITY, 0.0), (1.000_001, 0.0)];
    refuses(&So2, UnitComplex::new(1.0), no_planar_rotations.map(|(re, im)| complex(re, im)));
    let quaternion = |[w, x, y, z]: [f64; 4]| UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    let no_rotations =
        [[0.0; 4], [f64::NAN, 0.0, 0.0, 0.0], [1.0, 0.0, f64::NAN, 0.0], [0.0, 0.0, 0.0, -1.1], [1e200, 0.0, 0.0, 0.0]];
    refuses(&So3, UnitQuaternion::identity(), no_rotations.map(quaternion));
    let x = Vector3::x();
    refuses(&Sphere, x, [x * 0.0, x * 2.0, x * f64::NAN, Vector3::new(1.0, f64::NAN, 0.0), x * f64::INFINITY]);
    let no_positions = [0, 1, 2].into_iter().flat_map(|axis| {
        [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(|no_number| {
            let mut position = Vector3::new(0.3, -0.2, 0.5);
            position[axis] = no_number;
            position
        })
    });
    refuses(&R3::default(), x, no_positions.clone());
    let at = |p: Vector3<f64>| Pose::from_parts(p.into(), UnitQuaternion::identity());
    refuses(&Se3::default(), Pose::identity(), no_positions.clone().map(at));
    refuses(&Se3::default(), Pose::identity(), no_rotations.map(|q| Pose::from_parts(x.into(), quaternion(q))));
    let planar = |p: Vector3<f64>| Isometry2::new(p.xy(), 0.2);
    refuses(&Se2::default(), Isometry2::identity(), no_positions.clone().map(planar).take(6));
    let similar = |scale| Similarity2::new(Vector2::zeros(), 0.2, scale);
    refuses(&Sim2::default(), similar(0.5), [-2.0, f64::NAN, f64::INFINITY].map(similar));
    refuses(&Sim2::default(), similar(0.5), no_positions.map(|p| Similarity2::new(p.xy(), 0.2, 1.0)).take(6));
    assert!(!Sim2::default().is_finite(&similar(-2.0)) && Sim2::default().is_finite(&similar(1e-300)));
    // What comes of single precision is still a rotation.
    let single = So3Group::exp(x * 0.7).into_inner().coords.map(|c| f64::from(c as f32));
    assert!(So3.log(&UnitQuaternion::identity(), &UnitQuaternion::new_unchecked(Quaternion::from(single))).is_ok());
}

/// ln(b/a) for numbers as stored, to 25 digits (mpmath).
#[test]
fn logarithms_of_scales_keep_their_digits_at_every_size() {
    let metric = Sim2::default();
    let similar = |scale| Similarity2::new(Vector2::zeros(), 0.0, scale);
    for (from, into, expected) in [
        (1e300, 2.1e300, 0.7419373447293773),
        (1e-300, 2.5e-300, 0.916290731874155),
        (1e300, 1.0000001e300, 9.999999492197269e-08),
        (3e-308, 4e-308, 0.2876820724517809),
        (1e-300, 1e300, 1381.5510557964274),
        (5e-324, 1.0, 744.4400719213812),
        (7.0, 3.0, -0.8472978603872036),
        (0.1, 0.1000000000000001, 9.714451465470114e-16),
        (1e200, 1e199, -2.3025850929940455),
    ] {
        let [there, back] =
            [(from, into), (into, from)].map(|(a, b)| metric.log(&similar(a), &similar(b)).unwrap().scaling);
        assert!((there - expected).abs() <= 2.0 * f64::EPSILON * expected.abs(), "{from:e} {into:e}: {there:e}");
        assert_eq!(there, -back);
        assert_eq!(metric.distance(&similar(from), &similar(into)), there.abs());
    }
}
