//! The trait that every space implements.

use std::ops::{Add, Mul, Neg, Sub};

use crate::embedding::Embedding;

/// A tangent vector: plain data that adds and scales.
pub trait Tangent:
    Copy + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> + Mul<f64, Output = Self>
{
}
impl<T> Tangent for T where T: Copy + Add<Output = T> + Sub<Output = T> + Neg<Output = T> + Mul<f64, Output = T> {}

/// Two points between which the shortest geodesic is not unique, so that no logarithm exists.
///
/// Spaces whose logarithm is solved numerically ([`MongePatch`](crate::MongePatch), [`LevelSet`](crate::LevelSet)) return it
/// too where the solver found no geodesic; their `try_log` methods tell the two apart.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("no unique shortest geodesic joins the two points: they lie on each other's cut locus (distance {distance})")]
pub struct CutLocus {
    /// Geodesic distance of the two points; NaN where no geodesic was found.
    pub distance: f64,
}

/// A Riemannian manifold with its metric.
///
/// The required methods are the minimum; everything else is deduced once, here.
pub trait Manifold {
    /// A point, as plain data.
    type Point: Clone + std::fmt::Debug;
    /// A tangent vector, in the coordinates that the implementor documents.
    type Tangent: Tangent + std::fmt::Debug;

    /// The point reached from `p` after unit time along the geodesic with initial velocity `v`.
    fn exp(&self, p: &Self::Point, v: Self::Tangent) -> Self::Point;

    /// The initial velocity of the shortest geodesic that leads from `p` to `q` in unit time.
    ///
    /// # Errors
    /// [`CutLocus`] where that geodesic is not unique up to rounding.
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, CutLocus>;

    /// Inner product of two tangent vectors at `p`.
    fn inner(&self, p: &Self::Point, u: Self::Tangent, v: Self::Tangent) -> f64;

    /// v carried from `p` to exp(p, along) by parallel transport along that geodesic: DV/dt = 0 (thesis eq. 3.8).
    ///
    /// Transport keeps inner products, is linear in v, and carries the velocity `along` itself to the velocity on arrival.
    fn transport(&self, p: &Self::Point, along: Self::Tangent, v: Self::Tangent) -> Self::Tangent;

    /// Geodesic distance. Total: defined on the cut locus too.
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64;

    /// The greatest radius within which `log` is unique around every point, or a lower bound of it.
    fn injectivity_radius(&self) -> f64;

    /// Whether every coordinate of the point is a finite number.
    fn is_finite(&self, p: &Self::Point) -> bool;

    /// The coordinates in which the distance is a chord and an angle; `None` where it has no such form.
    fn embedding(&self) -> Option<Embedding> {
        None
    }

    /// Writes those coordinates of `p`; nothing where [`Self::embedding`] is `None`.
    ///
    /// # Panics
    /// If there is not room for [`Embedding::dimension`] numbers.
    fn embed(&self, _p: &Self::Point, _coordinates: &mut [f64]) {}

    /// Length of a tangent vector at `p`: √⟨v, v⟩.
    fn norm(&self, p: &Self::Point, v: Self::Tangent) -> f64 {
        self.inner(p, v, v).max(0.0).sqrt()
    }

    /// The point at fraction `t` of the shortest geodesic from `p` (t = 0) to `q` (t = 1).
    ///
    /// # Errors
    /// [`CutLocus`] where that geodesic is not unique.
    fn geodesic(&self, p: &Self::Point, q: &Self::Point, t: f64) -> Result<Self::Point, CutLocus> {
        Ok(self.exp(p, self.log(p, q)? * t))
    }
}
