//! Spaces in which one can run along a straight line between two points that move themselves.

use std::f64::consts::PI;

use nalgebra::{SVector, UnitQuaternion, Vector3};

use super::jet_rotation::{B, C, JetRotation, JetVector};
use super::{Derivatives, Jet};
use crate::euclidean::Euclidean;
use crate::group::{LieGroup, Se3Group, So3Group};
use crate::manifold::{LogError, Manifold};
use crate::pose::Pose;
use crate::se3::Se3;
use crate::so3::So3;
use crate::twist::Twist;

/// A space with straight lines, differentiable in their ends: what de Casteljau's construction needs.
///
/// [`Euclidean`], [`So3`] and [`Se3`] have their geodesics; [`Se3Group`] has screw motions.
///
/// ```
/// use se3_geom::{Jet, JetSpace, R2, nalgebra::Vector2};
/// // On the line from a moving point p(t) to q: p moves from (0, 0) to (1, 0), q rests at (0, 1); t of the way along.
/// let (space, t) = (R2::default(), Jet::variable(0.25));
/// let (rest, end) = (space.at_rest(&Vector2::zeros()), space.at_rest(&Vector2::x()));
/// let p = space.between(&rest, &end, t);
/// let along = space.derivatives(&space.between(&p, &space.at_rest(&Vector2::y()), t));
/// // (t(1 − t), t) with its derivatives.
/// assert_eq!(along.point, Vector2::new(0.1875, 0.25));
/// assert_eq!((along.velocity, along.acceleration), (Vector2::new(0.5, 1.0), Vector2::new(-2.0, 0.0)));
/// ```
pub trait JetSpace {
    /// A point, as plain data.
    type Point: Clone + std::fmt::Debug;
    /// A tangent vector.
    type Tangent: Copy + std::fmt::Debug + std::ops::Mul<f64, Output = Self::Tangent>;
    /// A point that moves with a parameter.
    type PointJet: Clone;

    /// The point reached after unit time on the straight line that leaves `p` with velocity `v`.
    ///
    /// # Errors
    /// [`LogError::CutLocus`] where that line is not the only shortest one between its ends, which then do not tell what v was.
    fn straight(&self, p: &Self::Point, v: Self::Tangent) -> Result<Self::Point, LogError>;
    /// Checks that one straight line joins `p` and `q`.
    ///
    /// # Errors
    /// [`LogError::CutLocus`] where there are several (on [`Se3Group`] its distance is the rotation angle, π rad),
    /// [`LogError::NotAPoint`] where a coordinate is not finite.
    fn joins(&self, p: &Self::Point, q: &Self::Point) -> Result<(), LogError>;
    /// A point at rest.
    fn at_rest(&self, p: &Self::Point) -> Self::PointJet;
    /// The point at fraction `t` of the straight line from `p` to `q`, everything moving.
    fn between(&self, p: &Self::PointJet, q: &Self::PointJet, t: Jet) -> Self::PointJet;
    /// The point with its derivatives.
    fn derivatives(&self, p: &Self::PointJet) -> Derivatives<Self::Point, Self::Tangent>;
}

/// A pose that moves with a parameter.
#[derive(Debug, Clone, Copy)]
pub struct PoseJet {
    rotation: JetRotation,
    position: JetVector,
}

impl PoseJet {
    fn constant(p: &Pose) -> Self {
        let (rotation, position) = (JetRotation::constant(&p.rotation), JetVector::constant(&p.translation.vector));
        Self { rotation, position }
    }

    fn derivatives(&self) -> Derivatives<Pose, Twist> {
        let (rotation, rate) = (self.rotation.value(), self.rotation.rate());
        let body = rotation.inverse();
        let nth = |k: usize| Twist::new(body * self.position.derivative(k), rate.derivative(k - 1));
        let point = Pose::from_parts(self.position.derivative(0).into(), rotation);
        Derivatives { point, velocity: nth(1), acceleration: nth(2), jerk: nth(3) }
    }
}

impl<const N: usize> JetSpace for Euclidean<N> {
    type Point = SVector<f64, N>;
    type Tangent = SVector<f64, N>;
    type PointJet = [Jet; N];

    fn straight(&self, p: &Self::Point, v: Self::Tangent) -> Result<Self::Point, LogError> {
        Ok(p + v)
    }
    fn joins(&self, p: &Self::Point, q: &Self::Point) -> Result<(), LogError> {
        have_logarithm(self, p, q)
    }
    fn at_rest(&self, p: &Self::Point) -> Self::PointJet {
        std::array::from_fn(|k| Jet::constant(p[k]))
    }
    fn between(&self, p: &Self::PointJet, q: &Self::PointJet, t: Jet) -> Self::PointJet {
        std::array::from_fn(|k| p[k] + (q[k] - p[k]) * t)
    }
    fn derivatives(&self, p: &Self::PointJet) -> Derivatives<Self::Point, Self::Tangent> {
        let [point, velocity, acceleration, jerk] =
            std::array::from_fn(|n| SVector::from_fn(|k, _| p[k].derivatives()[n]));
        Derivatives { point, velocity, acceleration, jerk }
    }
}

fn have_logarithm<M: Manifold>(manifold: &M, p: &M::Point, q: &M::Point) -> Result<(), LogError> {
    if !(manifold.is_finite(p) && manifold.is_finite(q)) {
        return Err(LogError::NotAPoint);
    }
    manifold.log(p, q).map(|_| ())
}

fn below_half_a_turn(turn: Vector3<f64>) -> Result<Vector3<f64>, LogError> {
    let angle = turn.norm();
    if angle >= PI { Err(LogError::CutLocus { distance: angle, angle_rad: Some(angle) }) } else { Ok(turn) }
}

fn slerp(p: &JetRotation, q: &JetRotation, t: Jet) -> JetRotation {
    p.then(&JetRotation::exp(&(p.inverse().then(q).log() * t)))
}

impl JetSpace for So3 {
    type Point = UnitQuaternion<f64>;
    type Tangent = Vector3<f64>;
    type PointJet = PoseJet;

    fn straight(&self, p: &Self::Point, v: Self::Tangent) -> Result<Self::Point, LogError> {
        Ok(p * So3Group::exp(below_half_a_turn(v)?))
    }
    fn joins(&self, p: &Self::Point, q: &Self::Point) -> Result<(), LogError> {
        have_logarithm(self, p, q)
    }
    fn at_rest(&self, p: &Self::Point) -> PoseJet {
        PoseJet::constant(&Pose::from_parts(Vector3::zeros().into(), *p))
    }
    fn between(&self, p: &PoseJet, q: &PoseJet, t: Jet) -> PoseJet {
        PoseJet { rotation: slerp(&p.rotation, &q.rotation, t), position: p.position }
    }
    fn derivatives(&self, p: &PoseJet) -> Derivatives<Self::Point, Self::Tangent> {
        let Derivatives { point, velocity, acceleration, jerk } = p.derivatives();
        Derivatives {
            point: point.rotation,
            velocity: velocity.angular,
            acceleration: acceleration.angular,
            jerk: jerk.angular,
        }
    }
}

impl JetSpace for Se3 {
    type Point = Pose;
    type Tangent = Twist;
    type PointJet = PoseJet;

    fn straight(&self, p: &Pose, v: Twist) -> Result<Pose, LogError> {
        below_half_a_turn(v.angular)?;
        Ok(self.exp(p, v))
    }
    fn joins(&self, p: &Pose, q: &Pose) -> Result<(), LogError> {
        have_logarithm(self, p, q)
    }
    fn at_rest(&self, p: &Pose) -> PoseJet {
        PoseJet::constant(p)
    }
    fn between(&self, p: &PoseJet, q: &PoseJet, t: Jet) -> PoseJet {
        let position = p.position + (q.position - p.position) * t;
        PoseJet { rotation: slerp(&p.rotation, &q.rotation, t), position }
    }
    fn derivatives(&self, p: &PoseJet) -> Derivatives<Pose, Twist> {
        p.derivatives()
    }
}

/// db/dx·2 for b = (1 − cos θ)/θ² as a series in x = θ²: (1/θ) db/dθ.
const B_SLOPE: [f64; 15] = {
    let mut series = [0.0; 15];
    let mut k = 0;
    while k < 15 {
        series[k] = 2.0 * (k + 1) as f64 * B[k + 1];
        k += 1;
    }
    series
};

impl JetSpace for Se3Group {
    type Point = Pose;
    type Tangent = Twist;
    type PointJet = PoseJet;

    fn straight(&self, p: &Pose, v: Twist) -> Result<Pose, LogError> {
        below_half_a_turn(v.angular)?;
        Ok(p * Self::exp(v))
    }
    fn joins(&self, p: &Pose, q: &Pose) -> Result<(), LogError> {
        // Rotations alone decide; the group has no distance to name.
        have_logarithm(&So3, &p.rotation, &q.rotation)?;
        Se3Group::log(&(p.inverse() * q)).map(|_| ()).map_err(|_| LogError::NotAPoint)
    }
    fn at_rest(&self, p: &Pose) -> PoseJet {
        PoseJet::constant(p)
    }
    /// p·exp(t·log(p⁻¹q)), with Jl(φ)y = y + b φ×y + c φ×(φ×y), its inverse with −½ and d in place of b and c, and d = −b_s/(2b).
    fn between(&self, p: &PoseJet, q: &PoseJet, t: Jet) -> PoseJet {
        let body = p.rotation.inverse();
        let theta = body.then(&q.rotation).log();
        let offset = body.turn(&(q.position - p.position));
        let x = theta.dot(&theta);
        let d = x.polynomial(&B_SLOPE) * (x.polynomial(&B) * -2.0).recip();
        let across = theta.cross(&offset);
        let linear = offset + across * Jet::constant(-0.5) + theta.cross(&across) * d;
        let (phi, y) = (theta * t, linear * t);
        let x = phi.dot(&phi);
        let across = phi.cross(&y);
        let moved = y + across * x.polynomial(&B) + phi.cross(&across) * x.polynomial(&C);
        PoseJet { rotation: p.rotation.then(&JetRotation::exp(&phi)), position: p.position + p.rotation.turn(&moved) }
    }
    fn derivatives(&self, p: &PoseJet) -> Derivatives<Pose, Twist> {
        p.derivatives()
    }
}
