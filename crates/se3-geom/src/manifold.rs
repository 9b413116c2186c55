//! The trait that every space implements.

use std::ops::{Add, Mul, Neg, Sub};

use nalgebra::SVector;

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
        "no unique shortest geodesic joins the two points: they lie on each other's cut locus (distance {distance}{angle})",
        angle = named_angle(.angle_rad)
    )]
    CutLocus {
        /// Geodesic distance of the two points, in the metric of their space.
        distance: f64,
        /// The angle that has two shortest ways: of the rotation in a product space, the distance itself on spheres and rotation
        /// groups. `None` where geodesics are found numerically, which knows no angles.
        angle_rad: Option<f64>,
    },
    /// No geodesic came out, on a space where they are found numerically. There may be one all the same.
    #[error("no geodesic was found between the points: the nearest of {starts} shots missed the goal by {miss}")]
    NotFound {
        /// Least distance from the goal, in the coordinates of the points; infinite where no shot had a finite end.
        miss: f64,
        /// Number of shots, from both points.
        starts: usize,
    },
    /// A point has no place on the manifold: a coordinate is not finite, a scale not positive, a unit vector, unit complex number
    /// or unit quaternion has a squared norm more than 1e-6 off. Or two points are farther apart than numbers reach.
    #[error(
        "a point is not on the manifold: a coordinate is not finite, a scale not positive, or a norm that must be 1 is not"
    )]
    NotAPoint,
}

impl LogError {
    /// The same error on a product space, of which only one factor is at its cut locus.
    pub(crate) fn at_distance(self, distance: f64) -> Self {
        match self {
            Self::CutLocus { angle_rad, .. } => Self::CutLocus { distance, angle_rad },
            other => other,
        }
    }
}

fn named_angle(angle_rad: &Option<f64>) -> String {
    angle_rad.map_or_else(String::new, |angle| format!(", angle {angle} rad"))
}

/// Whether α and β weigh a product metric: positive and finite.
pub(crate) fn are_weights(alpha: f64, beta: f64) -> bool {
    [alpha, beta].iter().all(|weight| *weight > 0.0 && weight.is_finite())
}

/// The logarithm with these flat coordinates, which are not finite where those of a point are not.
pub(crate) fn if_finite<T, const N: usize>(logarithm: T, flat: &SVector<f64, N>) -> Result<T, LogError> {
    if flat.iter().all(|x| x.is_finite()) { Ok(logarithm) } else { Err(LogError::NotAPoint) }
}

/// A Riemannian manifold with its metric.
///
/// The required methods are the minimum; everything else is deduced once, here.
pub trait Manifold: Sync {
    /// A point, as plain data.
    type Point: Clone + std::fmt::Debug + Send + Sync;
    /// A tangent vector, in the coordinates that the implementor documents.
    type Tangent: Tangent + std::fmt::Debug + Send + Sync;

    /// The point reached from `p` after unit time along the geodesic with initial velocity `v`.
    fn exp(&self, p: &Self::Point, v: Self::Tangent) -> Self::Point;

    /// The initial velocity of the shortest geodesic that leads from `p` to `q` in unit time.
    ///
    /// Where the space has closed forms, that is a fact. Where geodesics are sought numerically ([`MongePatch`](crate::MongePatch),
    /// [`LevelSet`](crate::LevelSet)) it is a fact if `norm(p, log)` is below [`injectivity_radius`](Self::injectivity_radius);
    /// beyond, it is a geodesic all the same, but only **the shortest of those found**, and a shorter one may exist.
    ///
    /// # Errors
    /// [`LogError::CutLocus`] where that geodesic is not unique up to rounding, [`LogError::NotFound`] where it is sought
    /// numerically and not found, [`LogError::NotAPoint`] for what is no point.
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, LogError>;

    /// Inner product of two tangent vectors at `p`.
    fn inner(&self, p: &Self::Point, u: Self::Tangent, v: Self::Tangent) -> f64;

    /// v carried from `p` to exp(p, along) by parallel transport along that geodesic: DV/dt = 0 (thesis eq. 3.8).
    ///
    /// Transport keeps inner products, is linear in v, and carries the velocity `along` itself to the velocity on arrival.
    fn transport(&self, p: &Self::Point, along: Self::Tangent, v: Self::Tangent) -> Self::Tangent;

    /// Geodesic distance, in closed form on the cut locus too. Where geodesics are sought numerically: the length of the shortest
    /// found, as with [`log`](Self::log), so never less than the distance, and NaN where none was found.
    ///
    /// It takes points of the manifold for granted: NaN where a coordinate is.
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64;

    /// The greatest radius within which `log` is unique around every point, or a lower bound of it.
    fn injectivity_radius(&self) -> f64;

    /// Whether every coordinate of the point is a finite number, the logarithm of a scale included.
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
