//! Random points and tangents of every space, at all sizes that matter.
#![allow(dead_code)] // each test file uses a part

use std::f64::consts::PI;

use nalgebra::{Isometry2, Similarity2, UnitQuaternion, Vector2, Vector3, Vector4};
use proptest::prelude::*;
use se3_geom::{LevelSet, LieGroup, PlanarTwist, Pose, SimilarityTwist, So3Group, Twist, nalgebra};

/// Angles on both sides of every switch of branch, down to 1e-12 and up to just below π.
pub(crate) fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        (-12.0..0.3_f64).prop_map(|e| 10f64.powf(e)),
        (0.49..0.51_f64),
        (0.99..1.01_f64),
        (1.99..2.01_f64),
        (1e-9..1e-3_f64).prop_map(|gap| PI - gap),
    ]
}

pub(crate) fn signed_angle() -> impl Strategy<Value = f64> {
    (angle(), any::<bool>()).prop_map(|(a, negative)| if negative { -a } else { a })
}

pub(crate) fn direction() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64)
        .prop_filter("no direction", |v| Vector3::from(*v).norm() > 0.1)
        .prop_map(|v| Vector3::from(v).normalize())
}

pub(crate) fn rotation_vector() -> impl Strategy<Value = Vector3<f64>> {
    (direction(), angle()).prop_map(|(d, a)| d * a)
}

/// Displacements from a micrometre to a kilometre.
pub(crate) fn displacement() -> impl Strategy<Value = Vector3<f64>> {
    (direction(), -6.0..3.0_f64).prop_map(|(d, e)| d * 10f64.powf(e))
}

pub(crate) fn planar_displacement() -> impl Strategy<Value = Vector2<f64>> {
    displacement().prop_map(|v| v.xy())
}

pub(crate) fn rotation() -> impl Strategy<Value = UnitQuaternion<f64>> {
    rotation_vector().prop_map(So3Group::exp)
}

pub(crate) fn pose() -> impl Strategy<Value = Pose> {
    (displacement(), rotation()).prop_map(|(p, r)| Pose::from_parts(p.into(), r))
}

pub(crate) fn twist() -> impl Strategy<Value = Twist> {
    (displacement(), rotation_vector()).prop_map(|(v, w)| Twist::new(v, w))
}

pub(crate) fn planar_pose() -> impl Strategy<Value = Isometry2<f64>> {
    (planar_displacement(), signed_angle()).prop_map(|(p, a)| Isometry2::new(p, a))
}

pub(crate) fn planar_twist() -> impl Strategy<Value = PlanarTwist> {
    (planar_displacement(), signed_angle()).prop_map(|(v, w)| PlanarTwist::new(v, w))
}

pub(crate) fn similarity() -> impl Strategy<Value = Similarity2<f64>> {
    (planar_pose(), -3.0..3.0_f64).prop_map(|(pose, log_scale)| Similarity2::from_isometry(pose, log_scale.exp()))
}

pub(crate) fn similarity_twist() -> impl Strategy<Value = SimilarityTwist> {
    (planar_twist(), prop_oneof![-3.0..3.0_f64, -1e-6..1e-6_f64])
        .prop_map(|(v, scaling)| SimilarityTwist::new(v.linear, v.angular, scaling))
}

/// A point with three tangents, for spaces whose tangents look the same everywhere.
pub(crate) fn free<P: Strategy, T: Strategy>(
    point: P,
    tangent: impl Fn() -> T,
) -> impl Strategy<Value = (P::Value, [T::Value; 3])> {
    (point, [tangent(), tangent(), tangent()])
}

/// Tangents of length up to 3 rad: half a turn is a conjugate point, which multiplies roundings by θ/sin θ (21 at 3 rad).
pub(crate) fn on_sphere() -> impl Strategy<Value = (Vector3<f64>, [Vector3<f64>; 3])> {
    let across = (direction(), prop::array::uniform3((direction(), -9.0..0.477_f64)));
    across.prop_map(|(p, raw)| {
        let tangent = |(d, exponent): (Vector3<f64>, f64)| {
            let across = d - p * p.dot(&d);
            let across = if across.norm() > 1e-3 { across } else { p.cross(&Vector3::new(0.3, -0.5, 0.8)) };
            across.normalize() * 10f64.powf(exponent)
        };
        (p, raw.map(tangent))
    })
}

/// Points in a square, tangents of length up to `reach` in the plane.
pub(crate) fn on_patch(half_width: f64, reach: f64) -> impl Strategy<Value = (Vector2<f64>, [Vector2<f64>; 3])> {
    let tangent = (-PI..PI, 0.05..1.0_f64).prop_map(move |(a, r)| Vector2::new(a.cos(), a.sin()) * r * reach);
    let point = prop::array::uniform2(-half_width..half_width).prop_map(Vector2::from);
    (point, prop::array::uniform3(tangent))
}

/// Unit segments by middle and angle; tangents shorter than half a turn, π/√2 = 2.22.
pub(crate) fn on_segments() -> impl Strategy<Value = (Vector4<f64>, [Vector4<f64>; 3])> {
    let middle = prop::array::uniform2(-2.0..2.0_f64);
    let tangent = prop::array::uniform4(-1.0..1.0_f64).prop_map(Vector4::from);
    (middle, -PI..PI, prop::array::uniform3(tangent)).prop_map(|([x, y], angle, raw)| {
        let (dx, dy) = (0.5 * angle.cos(), 0.5 * angle.sin());
        let segments = LevelSet::unit_segments();
        let p = segments.project(&Vector4::new(x - dx, y - dy, x + dx, y + dy)).unwrap();
        (p, raw.map(|v| segments.project_tangent(&p, &v)))
    })
}
