//! Rotations as a Riemannian manifold.

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};

use crate::group::{LieGroup, So3Group};
use crate::manifold::{CutLocus, Manifold};

/// SO(3) with its bi-invariant metric: the distance of two rotations is the angle between them, in rad.
///
/// Tangents at R are body rates ω with Ṙ = R\[ω\]; geodesics are R·Exp(tω), that is, slerp.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct So3;

impl Manifold for So3 {
    type Point = UnitQuaternion<f64>;
    type Tangent = Vector3<f64>;

    fn exp(&self, p: &Self::Point, v: Self::Tangent) -> Self::Point {
        p * So3Group::exp(v)
    }
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, CutLocus> {
        So3Group::log(&(p.inverse() * q))
    }
    fn inner(&self, _: &Self::Point, u: Self::Tangent, v: Self::Tangent) -> f64 {
        u.dot(&v)
    }
    /// θ = 4·asin(c/2) with c the smaller chord of p and ±q: exactly symmetric, and accurate down to the smallest angles
    /// because the chord comes from differences.
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64 {
        let chord = (p.coords - q.coords).norm().min((p.coords + q.coords).norm());
        4.0 * (0.5 * chord).min(1.0).asin()
    }
    fn injectivity_radius(&self) -> f64 {
        PI
    }
    fn is_finite(&self, p: &Self::Point) -> bool {
        p.coords.iter().all(|x| x.is_finite())
    }
}
