//! Curves on manifolds.
//!
//! | curve | passes | smoothness | derivatives |
//! | --- | --- | --- | --- |
//! | [`Geodesic`] | two points of any [`Manifold`](crate::Manifold) | straight | exact |
//! | [`Screw`] | two poses | straight on the group SE(3) | exact |
//! | [`PartialGeodesic`] | all its poses | C² position, C⁰ rotation | exact |
//! | [`Bezier`] | first and last control point | C^∞; two joined pieces are C¹ | exact, by jets |
//! | [`CubicSpline`] | all its points in ℝᴺ | C² | exact |
//! | [`PoseSpline`](crate::PoseSpline) | all its poses | C² | exact |
//! | [`ByArcLength`] | as the curve it runs along | as that curve | by the chain rule |
//!
//! The spline is the one to want through many poses; the others are its ingredients, its rivals, and the answers to simpler
//! questions.

mod arc_length;
mod bezier;
mod cubic;
mod cubic_bends;
mod cubic_spline;
mod geodesic;
mod jet;
mod jet_rotation;
mod jet_space;
mod knots;
mod partial_geodesic;

pub use arc_length::{ArcLengthError, ByArcLength, arc_length, curvature};
pub use bezier::Bezier;
pub(crate) use cubic::Cubic;
pub(crate) use cubic_bends::{cubic_bends, longer_side};
pub use cubic_spline::{CubicEnds, CubicSpline};
pub use geodesic::{Geodesic, Screw};
pub use jet::Jet;
pub use jet_space::{JetSpace, PoseJet};
pub use knots::{Parameterisation, centripetal_knots};
pub use partial_geodesic::PartialGeodesic;

/// A point of a curve with the derivatives there, per unit of the curve's parameter.
///
/// Velocity and acceleration are tangent vectors at the point, the acceleration being the covariant one, that is, what a
/// geodesic at constant speed has none of. Coordinates are those of the manifold's tangents. In ℝᴺ the jerk is the third
/// derivative; of a rotation it is ω″, and of a pose (Rᵀp‴, ω″).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derivatives<P, T> {
    /// Where the curve is.
    pub point: P,
    /// First derivative.
    pub velocity: T,
    /// Second derivative.
    pub acceleration: T,
    /// Third derivative.
    pub jerk: T,
}

/// A curve on a manifold: a point for every parameter of an interval.
///
/// Beyond its domain an open curve stays at its end, with the derivatives it has there; a closed one goes round again.
pub trait Curve {
    /// A point of the space the curve lies in.
    type Point;
    /// A tangent vector of that space.
    type Tangent;

    /// First and last parameter.
    fn domain(&self) -> (f64, f64);

    /// Point and derivatives at parameter `t`.
    fn derivatives(&self, t: f64) -> Derivatives<Self::Point, Self::Tangent>;

    /// The point alone at parameter `t`.
    fn point(&self, t: f64) -> Self::Point {
        self.derivatives(t).point
    }

    /// The parameters between which the curve is smooth, from the first to the last of its domain, increasing.
    fn knots(&self) -> Vec<f64> {
        let (first, last) = self.domain();
        vec![first, last]
    }
}

impl<C: Curve> Curve for &C {
    type Point = C::Point;
    type Tangent = C::Tangent;

    fn domain(&self) -> (f64, f64) {
        (**self).domain()
    }
    fn derivatives(&self, t: f64) -> Derivatives<C::Point, C::Tangent> {
        (**self).derivatives(t)
    }
    fn point(&self, t: f64) -> C::Point {
        (**self).point(t)
    }
    fn knots(&self) -> Vec<f64> {
        (**self).knots()
    }
}

/// The piece of the knots that `t` falls in, and how far in. Beyond the knots the nearest end, or, cyclically, round again.
#[inline]
pub(crate) fn locate(knots: &[f64], closed: bool, t: f64) -> (usize, f64) {
    let t = within(knots, closed, t);
    let piece = knots.partition_point(|&k| k <= t).clamp(1, knots.len() - 1) - 1;
    (piece, t - knots[piece])
}

/// The parameter in the domain that `t` stands for: itself, to the last bit, where it lies in the domain.
#[inline]
pub(crate) fn within(knots: &[f64], closed: bool, t: f64) -> f64 {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    if closed && !(first..last).contains(&t) {
        return first + (t - first).rem_euclid(last - first);
    }
    t.clamp(first, last)
}
