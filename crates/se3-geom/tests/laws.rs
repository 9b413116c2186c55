//! One law suite for every manifold, one line a manifold.
//!
//! Tolerances are multiples of the unit roundoff ε = 2.2e-16 times the size of the numbers involved; `scale` is that size. Where
//! geodesics are integrated, the flow's 1e-13 a step and the shots' 1e-11 take the place of the roundoff.
#![allow(clippy::unwrap_used)]

mod samples;
mod surfaces;

use std::cell::Cell;

use nalgebra::{Isometry2, SVector, Similarity2, UnitComplex, UnitQuaternion, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use samples::{
    direction, displacement, free, on_patch, on_segments, on_sphere, planar_pose, planar_twist, pose, rotation,
    rotation_vector, signed_angle, similarity, similarity_twist, twist,
};
use se3_geom::{
    LevelSet, LieGroup, LogError, Manifold, Pose, R3, Se2, Se3, Se3Group, Sim2, So2, So3, So3Group, Sphere, nalgebra,
};
use surfaces::{egg_box, saddle};

const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// How many cases a space can afford, and what a number of size 1 may be off by.
struct Effort {
    cases: u32,
    tolerance: f64,
}
const CLOSED_FORM: Effort = Effort { cases: 2000, tolerance: ROUNDINGS };
const INTEGRATED: Effort = Effort { cases: 40, tolerance: 1e-11 };

fn run_cases<S: Strategy>(cases: u32, strategy: S, test: impl Fn(S::Value)) {
    let config = Config { cases, rng_seed: RngSeed::Fixed(11), failure_persistence: None, ..Config::default() };
    TestRunner::new(config)
        .run(&strategy, |value| {
            test(value);
            Ok(())
        })
        .unwrap();
}

fn run<S: Strategy>(strategy: S, test: impl Fn(S::Value)) {
    run_cases(CLOSED_FORM.cases, strategy, test);
}

/// Laws of a Riemannian manifold. `size` bounds the numbers a point is made of, `gap` measures how far two points are apart
/// independently of the metric under test.
fn manifold_laws<M: Manifold, S: Strategy<Value = (M::Point, [M::Tangent; 3])>>(
    Effort { cases, tolerance }: Effort,
    m: &M,
    sample: impl Fn() -> S,
    size: impl Fn(&M::Point) -> f64,
    gap: impl Fn(&M::Point, &M::Point) -> f64,
) {
    run_cases(cases, sample(), |(p, [v, ..])| {
        let q = m.exp(&p, v);
        let scale = 1.0 + size(&p) + size(&q);
        // exp and log are inverse, and the distance is the length of the logarithm. Half a turn less 1e-9 loses no digits.
        let back = m.log(&p, &q).unwrap();
        assert!(m.norm(&p, back - v) < tolerance * scale, "log(exp) {p:?} {v:?} {back:?}");
        assert!((m.distance(&p, &q) - m.norm(&p, v)).abs() < tolerance * scale, "distance {p:?} {v:?}");
        assert!(gap(&m.exp(&p, back), &q) < tolerance * scale, "exp(log) {p:?} {v:?}");
        // The geodesic starts at p, ends at q, and its middle is half way: a wrong sign of v would fail here.
        assert!(gap(&m.geodesic(&p, &q, 0.0).unwrap(), &p) < tolerance * scale);
        assert!(gap(&m.geodesic(&p, &q, 1.0).unwrap(), &q) < tolerance * scale);
        let middle = m.geodesic(&p, &q, 0.5).unwrap();
        let half = 0.5 * m.norm(&p, v);
        assert!((m.distance(&p, &middle) - half).abs() < tolerance * scale);
        assert!((m.distance(&middle, &q) - half).abs() < tolerance * scale);
        // Bilinear and positive.
        let k = 0.37;
        assert!((m.inner(&p, v * k, v) - k * m.inner(&p, v, v)).abs() <= ROUNDINGS * m.inner(&p, v, v));
        assert!(m.inner(&p, v, -v) <= 0.0);
    });
    run_cases(cases, (sample(), sample(), sample()), |((a, _), (b, _), (c, _))| {
        let scale = 1.0 + size(&a) + size(&b) + size(&c);
        assert_eq!(
            m.distance(&a, &b),
            m.distance(&b, &a),
            "symmetric to the last bit, so that edge weights do not depend on direction"
        );
        assert_eq!(m.distance(&a, &a), 0.0);
        assert!(m.distance(&a, &c) <= m.distance(&a, &b) + m.distance(&b, &c) + tolerance * scale, "triangle");
        if let Some(embedding) = m.embedding() {
            let coordinates = [&a, &b].map(|p| {
                let mut coordinates = vec![f64::NAN; embedding.dimension()];
                m.embed(p, &mut coordinates);
                coordinates
            });
            let embedded = embedding.squared_distance(&coordinates[0], &coordinates[1]).sqrt();
            assert!((embedded - m.distance(&a, &b)).abs() < tolerance * scale, "embedding {a:?} {b:?}");
        }
    });
    transport_laws(Effort { cases, tolerance }, m, sample, size, gap);
}

fn transport_laws<M: Manifold, S: Strategy<Value = (M::Point, [M::Tangent; 3])>>(
    Effort { cases, tolerance }: Effort,
    m: &M,
    sample: impl Fn() -> S,
    size: impl Fn(&M::Point) -> f64,
    gap: impl Fn(&M::Point, &M::Point) -> f64,
) {
    run_cases(cases, sample(), |(p, [along, u, v])| {
        let q = m.exp(&p, along);
        let carry = |v| m.transport(&p, along, v);
        let sizes = m.norm(&p, u) + m.norm(&p, v);
        let scale = 1.0 + size(&p) + size(&q);
        let isometry_gap = (m.inner(&q, carry(u), carry(v)) - m.inner(&p, u, v)).abs();
        assert!(isometry_gap <= tolerance * scale * sizes * sizes, "isometry {p:?} {along:?}");
        let linear_gap = m.norm(&q, carry(u * 0.7 - v * 1.3) - (carry(u) * 0.7 - carry(v) * 1.3));
        assert!(linear_gap <= tolerance * scale * sizes, "linear {p:?} {along:?}");
        let returned = m.transport(&q, -carry(along), carry(v));
        assert!(m.norm(&p, returned - v) <= tolerance * scale * sizes, "inverse {p:?} {along:?}");
        // What is carried along itself is the velocity on arrival: from there the geodesic goes on.
        let onward = m.exp(&q, carry(along) * 0.25);
        assert!(gap(&onward, &m.exp(&p, along * 1.25)) < 2.0 * tolerance * scale, "arrival {p:?} {along:?}");
    });
    // No torsion. The pole ladder, built of exp and log alone, is parallel transport up to fourth order in the size of its rungs
    // (exactly on symmetric spaces): reflect exp(p, v) in the middle of the geodesic, and its mirror image lies at −v carried
    // over. A transport that twists about the direction of travel, such as leaving body coordinates as they are on SO(3),
    // obeys all laws above but is off by second order here.
    let rung = 0.3 * m.injectivity_radius().min(1.0);
    let (coarse, fine, allowed) = (Cell::new(0.0), Cell::new(0.0), Cell::new(0.0));
    run_cases(cases, sample(), |(p, [along, v, _])| {
        if m.norm(&p, along) == 0.0 || m.norm(&p, v) == 0.0 {
            return;
        }
        let (along, v) = (along * (rung / m.norm(&p, along)), v * (rung / m.norm(&p, v)));
        let ladder_gap = |h: f64| {
            let (along, v) = (along * h, v * h);
            let (middle, q) = (m.exp(&p, along * 0.5), m.exp(&p, along));
            let mirrored = m.exp(&middle, -m.log(&middle, &m.exp(&p, v)).unwrap());
            m.norm(&q, -m.log(&q, &mirrored).unwrap() - m.transport(&p, along, v))
        };
        coarse.set(coarse.get() + ladder_gap(1.0));
        fine.set(fine.get() + ladder_gap(0.5));
        allowed.set(allowed.get() + 4.0 * tolerance * (1.0 + size(&p)));
    });
    let (coarse, fine, allowed) = (coarse.get(), fine.get(), allowed.get());
    assert!(fine < coarse / 12.0 + allowed, "pole ladder {coarse:e}, half of it {fine:e}, roundings {allowed:e}");
}

fn matrix_gap(p: &Pose, q: &Pose) -> f64 {
    (p.to_homogeneous() - q.to_homogeneous()).norm()
}

fn vector_gap<const N: usize>(p: &SVector<f64, N>, q: &SVector<f64, N>) -> f64 {
    (p - q).norm()
}

#[test]
fn space_obeys_the_manifold_laws() {
    manifold_laws(CLOSED_FORM, &R3::default(), || free(displacement(), displacement), |p| p.norm(), vector_gap);
}

#[test]
fn the_sphere_obeys_the_manifold_laws() {
    manifold_laws(CLOSED_FORM, &Sphere, on_sphere, |_| 1.0, vector_gap);
}

#[test]
fn planar_rotations_obey_the_manifold_laws() {
    let gap = |p: &UnitComplex<f64>, q: &UnitComplex<f64>| (p.as_ref() - q.as_ref()).norm();
    manifold_laws(CLOSED_FORM, &So2, || free(signed_angle().prop_map(UnitComplex::new), signed_angle), |_| 1.0, gap);
}

#[test]
fn rotations_obey_the_manifold_laws() {
    let gap = |p: &UnitQuaternion<f64>, q: &UnitQuaternion<f64>| {
        (p.to_rotation_matrix().matrix() - q.to_rotation_matrix().matrix()).norm()
    };
    manifold_laws(CLOSED_FORM, &So3, || free(rotation(), rotation_vector), |_| 1.0, gap);
}

#[test]
fn planar_poses_obey_the_manifold_laws() {
    let metric = Se2::with_weights(4.0, 1.0).unwrap();
    let gap = |p: &Isometry2<f64>, q: &Isometry2<f64>| (p.to_homogeneous() - q.to_homogeneous()).norm();
    let sample = || free(planar_pose(), planar_twist);
    manifold_laws(CLOSED_FORM, &metric, sample, |p| 2.0 * (1.0 + p.translation.vector.norm()), gap);
}

#[test]
fn similarities_obey_the_manifold_laws() {
    let metric = Sim2::with_weights(10.0, 1.0).unwrap();
    let gap = |p: &Similarity2<f64>, q: &Similarity2<f64>| (p.to_homogeneous() - q.to_homogeneous()).norm();
    let size = |p: &Similarity2<f64>| 4.0 * (1.0 + p.scaling() + p.isometry.translation.vector.norm());
    manifold_laws(CLOSED_FORM, &metric, || free(similarity(), similarity_twist), size, gap);
}

#[test]
fn poses_obey_the_manifold_laws() {
    for length_m in [0.05, 1.0, 20.0] {
        let metric = Se3::with_metres_per_radian(length_m).unwrap();
        let size = |p: &Pose| length_m.max(1.0) * (1.0 + p.translation.vector.norm());
        manifold_laws(CLOSED_FORM, &metric, || free(pose(), twist), size, matrix_gap);
    }
}

#[test]
fn the_saddle_obeys_the_manifold_laws() {
    manifold_laws(INTEGRATED, &saddle(), || on_patch(1.5, 3.0), |p| p.norm(), vector_gap);
}

/// Slopes are at most 1, so lengths at most √2 times those in the plane: below the injectivity radius π.
#[test]
fn the_egg_box_obeys_the_manifold_laws() {
    manifold_laws(INTEGRATED, &egg_box(), || on_patch(2.0, 2.2), |p| p.norm(), vector_gap);
}

#[test]
fn unit_segments_obey_the_manifold_laws() {
    manifold_laws(INTEGRATED, &LevelSet::unit_segments(), on_segments, |p| p.norm(), vector_gap);
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

/// SO(3) with the transport that leaves body coordinates as they are: an isometry, but with torsion.
struct Twisted;
impl Manifold for Twisted {
    type Point = UnitQuaternion<f64>;
    type Tangent = Vector3<f64>;
    fn exp(&self, p: &Self::Point, v: Self::Tangent) -> Self::Point {
        So3.exp(p, v)
    }
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, LogError> {
        So3.log(p, q)
    }
    fn inner(&self, p: &Self::Point, u: Self::Tangent, v: Self::Tangent) -> f64 {
        So3.inner(p, u, v)
    }
    fn transport(&self, _: &Self::Point, _: Self::Tangent, v: Self::Tangent) -> Self::Tangent {
        v
    }
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64 {
        So3.distance(p, q)
    }
    fn injectivity_radius(&self) -> f64 {
        So3.injectivity_radius()
    }
    fn is_finite(&self, p: &Self::Point) -> bool {
        So3.is_finite(p)
    }
}

#[test]
#[should_panic(expected = "pole ladder")]
fn a_transport_with_torsion_breaks_the_laws() {
    let gap = |p: &UnitQuaternion<f64>, q: &UnitQuaternion<f64>| {
        (p.to_rotation_matrix().matrix() - q.to_rotation_matrix().matrix()).norm()
    };
    manifold_laws(CLOSED_FORM, &Twisted, || free(rotation(), rotation_vector), |_| 1.0, gap);
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

#[test]
fn numbers_that_are_no_rotation_have_no_logarithm() {
    let nan = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    assert_eq!(So3.log(&UnitQuaternion::identity(), &nan), Err(LogError::NotAPoint));
    let pose = Pose::from_parts(Vector3::zeros().into(), nan);
    assert_eq!(Se3::default().log(&Pose::identity(), &pose), Err(LogError::NotAPoint));
}
