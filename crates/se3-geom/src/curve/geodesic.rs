//! Straight lines: of a Riemannian manifold, and of the group of rigid motions.

use nalgebra::Vector3;

use super::{Curve, Derivatives};
use crate::group::{LieGroup, Se3Group};
use crate::manifold::{LogError, Manifold};
use crate::pose::Pose;
use crate::so3::So3;
use crate::twist::Twist;

/// The geodesic c(t) = exp(p, t·v), t ∈ \[0, 1\], at constant speed ‖v‖ and without acceleration.
///
/// ```
/// use se3_geom::{Curve, Geodesic, Se3, pose_from_xyzw};
/// let start = pose_from_xyzw([0.0; 3], [0.0, 0.0, 0.0, 1.0])?;
/// let end = pose_from_xyzw([1.0, 0.0, 0.0], [0.0, 0.0, 0.6, 0.8])?;
/// let line = Geodesic::between(Se3::default(), start, end)?;
/// assert!((line.point(0.5).translation.vector.x - 0.5).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Geodesic<M: Manifold> {
    manifold: M,
    start: M::Point,
    velocity: M::Tangent,
}

impl<M: Manifold> Geodesic<M> {
    /// The shortest geodesic from `start` to `end`.
    ///
    /// # Errors
    /// As [`Manifold::log`].
    pub fn between(manifold: M, start: M::Point, end: M::Point) -> Result<Self, LogError> {
        let velocity = manifold.log(&start, &end)?;
        Ok(Self { manifold, start, velocity })
    }

    /// The geodesic that leaves `start` with `velocity`.
    pub fn leaving(manifold: M, start: M::Point, velocity: M::Tangent) -> Self {
        Self { manifold, start, velocity }
    }
}

impl<M: Manifold> Curve for Geodesic<M> {
    type Point = M::Point;
    type Tangent = M::Tangent;

    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }
    fn derivatives(&self, t: f64) -> Derivatives<M::Point, M::Tangent> {
        let along = self.velocity * t.clamp(0.0, 1.0);
        let zero = self.velocity * 0.0;
        Derivatives {
            point: self.manifold.exp(&self.start, along),
            velocity: self.manifold.transport(&self.start, along, self.velocity),
            acceleration: zero,
            jerk: zero,
        }
    }
    fn point(&self, t: f64) -> M::Point {
        self.manifold.exp(&self.start, self.velocity * t.clamp(0.0, 1.0))
    }
}

/// The screw motion c(t) = A·exp(t·ξ), t ∈ \[0, 1\]: a turn about a fixed axis with a proportional slide along it, at constant
/// body twist ξ.
///
/// The straight line of the *group* SE(3). It is no geodesic of [`Se3`](crate::Se3) unless the axis passes through the tool's
/// origin (or nothing turns), ω×v = 0: elsewhere the origin runs on a helix, Rᵀp″ = ω×v.
///
/// ```
/// use se3_geom::{Curve, Screw, nalgebra::Vector3, pose_from_xyzw};
/// // A quarter turn about the vertical axis through (1, 0, 0), rising by 0.5: the origin keeps its distance from the axis.
/// let s = 0.5_f64.sqrt();
/// let start = pose_from_xyzw([0.0; 3], [0.0, 0.0, 0.0, 1.0])?;
/// let end = pose_from_xyzw([1.0, -1.0, 0.5], [0.0, 0.0, s, s])?;
/// let halfway = Screw::between(start, end)?.point(0.5).translation.vector;
/// assert!((halfway - Vector3::new(1.0 - s, -s, 0.25)).norm() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screw {
    start: Pose,
    twist: Twist,
}

impl Screw {
    /// The screw motion from `start` to `end` that turns by less than half a turn.
    ///
    /// # Errors
    /// [`LogError::CutLocus`] at half a turn, where two turn equally far; its distance is that angle, π rad.
    /// [`LogError::NotAPoint`] where a coordinate is not finite.
    pub fn between(start: Pose, end: Pose) -> Result<Self, LogError> {
        // The group's logarithm takes a side at half a turn; that of the rotations' metric tells.
        So3.log(&start.rotation, &end.rotation)?;
        let twist = Se3Group::log(&(start.inverse() * end)).map_err(|_| LogError::NotAPoint)?;
        Ok(Self { start, twist })
    }

    /// The screw motion that leaves `start` with the body twist `twist`.
    pub fn leaving(start: Pose, twist: Twist) -> Self {
        Self { start, twist }
    }
}

impl Curve for Screw {
    type Point = Pose;
    type Tangent = Twist;

    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }
    fn derivatives(&self, t: f64) -> Derivatives<Pose, Twist> {
        let Twist { linear, angular } = self.twist;
        let bend = angular.cross(&linear);
        Derivatives {
            point: self.point(t),
            velocity: self.twist,
            acceleration: Twist::new(bend, Vector3::zeros()),
            jerk: Twist::new(angular.cross(&bend), Vector3::zeros()),
        }
    }
    fn point(&self, t: f64) -> Pose {
        self.start * Se3Group::exp(self.twist * t.clamp(0.0, 1.0))
    }
}
