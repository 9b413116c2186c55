//! Lie groups: composition and the group exponential, with no metric.

mod planar_exponential;
mod se2;
mod se3;
mod sim2;
mod so2;
mod so3;

use std::ops::Neg;

pub use se2::Se2Group;
pub use se3::Se3Group;
pub use sim2::Sim2Group;
pub use so2::So2Group;
pub use so3::So3Group;
pub(crate) use so3::logarithm;

/// Numbers that are no group element, so that no logarithm exists. Every element of the groups here has one.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("no logarithm: the rotation angle comes out as {angle_rad} rad and the scale as {scale}")]
pub struct NoLogarithm {
    /// The rotation angle that the element's coordinates give.
    pub angle_rad: f64,
    /// The scale of a similarity; 1 in a group without scaling.
    pub scale: f64,
}

/// A matrix Lie group with its exponential. All operations are associated functions: a group has no metric to carry.
///
/// With hat(v) the matrix of the algebra element v, exp(v) = Σ hat(v)ᵏ/k!. Curves t ↦ a·exp(t·v) are the group's straight
/// lines: rotations about a fixed axis, screws in SE(3), circular arcs in SE(2), logarithmic spirals in Sim(2). Want these
/// for velocities, Jacobians and kinematic chains; want the geodesics of a [`Manifold`](crate::Manifold) for distances,
/// orders and interpolation.
pub trait LieGroup: Copy {
    /// A group element.
    type Element: Clone;
    /// A Lie algebra element in coordinates.
    type Algebra: Copy + Neg<Output = Self::Algebra>;
    /// The matrix of a linear map on the algebra.
    type AlgebraMap;
    /// What the group acts on.
    type Point;

    /// The neutral element.
    fn identity() -> Self::Element;
    /// The product ab.
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element;
    /// a⁻¹.
    fn inverse(a: &Self::Element) -> Self::Element;
    /// The group exponential.
    fn exp(v: Self::Algebra) -> Self::Element;
    /// The principal logarithm: exp(log(a)) = a with rotation angle in [−π, π]; at half a turn one of the two.
    ///
    /// # Errors
    /// [`NoLogarithm`] where a coordinate is not finite or a scale is not positive.
    fn log(a: &Self::Element) -> Result<Self::Algebra, NoLogarithm>;
    /// Ad(a): a·exp(v)·a⁻¹ = exp(Ad(a)·v).
    fn adjoint(a: &Self::Element) -> Self::AlgebraMap;
    /// Jl(v): exp(v + δ) = exp(Jl(v)·δ)·exp(v) to first order in δ.
    fn left_jacobian(v: Self::Algebra) -> Self::AlgebraMap;
    /// Jl(v)⁻¹. Entries grow without bound towards a full turn, where Jl is singular (without scaling).
    fn left_jacobian_inverse(v: Self::Algebra) -> Self::AlgebraMap;
    /// The point a·x.
    fn act(a: &Self::Element, x: &Self::Point) -> Self::Point;

    /// Jr(v) = Jl(−v): exp(v + δ) = exp(v)·exp(Jr(v)·δ) to first order in δ.
    fn right_jacobian(v: Self::Algebra) -> Self::AlgebraMap {
        Self::left_jacobian(-v)
    }
    /// Jr(v)⁻¹ = Jl(−v)⁻¹.
    fn right_jacobian_inverse(v: Self::Algebra) -> Self::AlgebraMap {
        Self::left_jacobian_inverse(-v)
    }
}
