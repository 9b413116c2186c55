//! Slerp for rotations, a cubic spline for positions.

use nalgebra::Vector3;

use super::{CubicEnds, CubicSpline, Curve, Derivatives, locate};
use crate::group::{LieGroup, So3Group};
use crate::manifold::Manifold;
use crate::pose::Pose;
use crate::pose_spline::turns_between;
use crate::se3::Se3;
use crate::spline_error::{SplineError, check};
use crate::twist::Twist;

/// The thesis' partial geodesic scheme (§6.2): between its poses the rotation runs on a geodesic of SO(3) and the position on a
/// C² cubic spline, clamped (eq. 6.9) or cyclic (eq. 6.10).
///
/// Positions are C². Rotations are not: the body rate is constant between poses and jumps at them. Where that matters take
/// [`PoseSpline`](crate::PoseSpline).
///
/// ```
/// use se3_geom::{CubicEnds, Curve, PartialGeodesic, pose_from_xyzw};
/// let s = 0.5_f64.sqrt();
/// let poses = [
///     pose_from_xyzw([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])?,
///     pose_from_xyzw([0.1, 0.0, 0.0], [0.0, 0.0, s, s])?,
///     pose_from_xyzw([0.1, 0.1, 0.0], [0.0, 0.0, s, s])?,
/// ];
/// let curve = PartialGeodesic::through(&poses, &[0.0, 1.0, 2.0], CubicEnds::Natural)?;
/// // A quarter turn at an even rate, then none.
/// assert!((curve.point(0.5).rotation.angle() - 0.25 * std::f64::consts::PI).abs() < 1e-15);
/// assert!(curve.derivatives(1.5).velocity.angular.norm() < 1e-15);
/// assert!((curve.point(1.0).translation.vector - poses[1].translation.vector).norm() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PartialGeodesic {
    positions: CubicSpline<3>,
    knots: Vec<f64>,
    /// Rotation at the start of each piece and constant body rate on it.
    rotations: Vec<(nalgebra::UnitQuaternion<f64>, Vector3<f64>)>,
}

impl PartialGeodesic {
    /// The curve that passes `poses[i]` at parameter `knots[i]`. `ends` speaks of the positions, in the frame the poses are
    /// given in, per unit of the parameter; with [`CubicEnds::Periodic`] one further knot says where the curve is back at
    /// `poses[0]`.
    ///
    /// # Errors
    /// [`SplineError`] as [`CubicSpline::through`], and where successive rotations are half a turn apart.
    pub fn through(poses: &[Pose], knots: &[f64], ends: CubicEnds<3>) -> Result<Self, SplineError> {
        let closed = ends == CubicEnds::Periodic;
        check(poses, knots, closed, 2, |p| Se3::default().is_finite(p))?;
        let origins: Vec<_> = poses.iter().map(|p| p.translation.vector).collect();
        let positions = CubicSpline::through(&origins, knots, ends)?;
        let turns = turns_between(poses, knots.len() - 1)?;
        let rates = turns.iter().zip(knots.windows(2)).map(|(theta, k)| theta / (k[1] - k[0]));
        let rotations = poses.iter().map(|p| p.rotation).zip(rates).collect();
        Ok(Self { positions, knots: knots.to_vec(), rotations })
    }
}

impl Curve for PartialGeodesic {
    type Point = Pose;
    type Tangent = Twist;

    fn domain(&self) -> (f64, f64) {
        self.positions.domain()
    }
    fn derivatives(&self, t: f64) -> Derivatives<Pose, Twist> {
        let (piece, local) = locate(&self.knots, self.positions.is_closed(), t);
        let (start, rate) = &self.rotations[piece];
        let rotation = start * So3Group::exp(rate * local);
        let position = self.positions.derivatives(t);
        let body = rotation.inverse();
        Derivatives {
            point: Pose::from_parts(position.point.into(), rotation),
            velocity: Twist::new(body * position.velocity, *rate),
            acceleration: Twist::new(body * position.acceleration, Vector3::zeros()),
            jerk: Twist::new(body * position.jerk, Vector3::zeros()),
        }
    }
    fn knots(&self) -> Vec<f64> {
        self.knots.clone()
    }
}
