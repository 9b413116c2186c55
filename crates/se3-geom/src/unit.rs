//! What spheres and rotation groups share: points are vectors of norm one, and half a turn is where they have no logarithm.

use nalgebra::Vector3;

/// Angles closer to π than this, in rad, are half a turn up to rounding.
///
/// Where p·q nearly vanishes, four products of unit quaternions and their two partial sums are off by ε/2 of Σ|pᵢqᵢ| ≤ 1 each
/// and the last sum is exact: ε in the cosine of half the angle, 2 ε in the angle. In the plane and on the sphere the sine is
/// more exact than that, but each point is a unit vector rounded by ε/2, and was computed. One bound for all, so that a turn
/// about z has a logarithm in SO(3) where it has one in SO(2).
pub(crate) const HALF_TURN_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// How far the squared norm of a unit vector may be off: a million roundings of double, a few of single precision.
const SQUARED_NORM_TOLERANCE: f64 = 1e-6;

/// Whether a vector of this squared norm is a unit vector. NaN, infinity and zero are none, and no coordinate that is not a
/// number gives another squared norm.
pub(crate) fn is_unit(squared_norm: f64) -> bool {
    (squared_norm - 1.0).abs() <= SQUARED_NORM_TOLERANCE
}

/// ‖v‖, also where its square underflows.
pub(crate) fn length(v: &Vector3<f64>) -> f64 {
    let norm = v.norm();
    // Squares of terms below 1e-154 lose digits: above 1e-138 they do not count.
    if norm > 1e-138 { norm } else { v.x.hypot(v.y).hypot(v.z) }
}
