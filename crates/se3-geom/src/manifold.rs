//! The trait that every space implements.

use std::ops::{Add, Mul, Neg, Sub};

use crate::embedding::Embedding;

/// A tangent vector: plain data that adds and scales.
pub trait Tangent:
    Copy + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> + Mul<f64, Output = Self>
{
}
impl<T> Tangent for T where T: Copy + Add<Output = T> + Sub<Output = T> + Neg<Output = T> + Mul<f64, Output = T> {}

/// Why two points of a manifold have no logarithm.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LogError {
    /// The shortest geodesic between the points is not unique.
    #[error(
        "no unique shortest geodesic joins the two points: they lie on each other's cut locus (distance {distance})"
    )]
    CutLocus {
        /// Geodesic distance of the two points; an angle in rad on spheres and rotation groups.
        distance: f64,
    },
    /// No geodesic came out, on a space where they are found numerically.
    #[error("no geodesic was found between the points: the nearest of {starts} shots missed the goal by {miss}")]
    NotFound {
        /// Least distance from the goal, in the coordinates of the points; infinite where no shot had a finite end.
        miss: f64,
        /// Number of starts.
        starts: usize,
    },
    /// A point has no place on the manifold.
    #[error("a point has a coordinate that is not a finite number, or a rotation of norm zero")]
    NotAPoint,
}

impl LogError {
    /// The same error on a product space, of which only one factor is at its cut locus.
    pub(crate) fn at_distance(self, distance: f64) -> Self {
        match self {
            Self::CutLocus { .. } => Self::CutLocus { distance },
            other => other,
        }
    }
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
    /// [`LogError::CutLocus`] where that geodesic is not unique up to rounding, [`LogError::NotFound`] where it is sought
    /// numerically and not found, [`LogError::NotAPoint`] where the space can tell.
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, LogError>;

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
    /// As [`log`](Self::log).
    fn geodesic(&self, p: &Self::Point, q: &Self::Point, t: f64) -> Result<Self::Point, LogError> {
        Ok(self.exp(p, self.log(p, q)? * t))
    }
}
