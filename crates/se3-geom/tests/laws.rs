//! One law suite for every manifold, one line a manifold.
//!
//! Tolerances are multiples of the unit roundoff ε = 2.2e-16 times the size of the numbers involved; `scale` is that size. Where
//! geodesics are integrated, the flow's 1e-13 a step and the shots' 1e-11 take the place of the roundoff.
#![allow(clippy::unwrap_used)]

#[path = "laws/metrics.rs"]
mod metrics;
mod samples;
#[path = "laws/suite.rs"]
mod suite;
mod surfaces;

use nalgebra::{Isometry2, SVector, Similarity2, UnitComplex, UnitQuaternion, Vector3};
use proptest::prelude::*;
use samples::{
    displacement, free, on_patch, on_segments, on_sphere, planar_pose, planar_twist, pose, rotation, rotation_vector,
    signed_angle, similarity, similarity_twist, twist,
};
use se3_geom::{LevelSet, LogError, Manifold, Pose, R3, Se2, Se3, Sim2, So2, So3, Sphere, nalgebra};
use suite::{CLOSED_FORM, INTEGRATED, manifold_laws};
use surfaces::{egg_box, hill, round_sphere, saddle};

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

/// The top of the hill, where the curvature is 16: samples closer than π/4, the radius, of which slopes of 1.7 leave 0.39 in the
/// plane.
#[test]
fn the_hill_obeys_the_manifold_laws() {
    manifold_laws(INTEGRATED, &hill(), || on_patch(0.2, 0.39), |p| p.norm(), vector_gap);
}

#[test]
fn the_sphere_as_a_level_set_obeys_the_manifold_laws() {
    manifold_laws(INTEGRATED, &round_sphere(), on_sphere, |_| 1.0, vector_gap);
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
