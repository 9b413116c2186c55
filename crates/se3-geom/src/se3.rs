//! Poses as a Riemannian manifold.

use crate::embedding::Embedding;
use crate::group::{LieGroup, So3Group};
use crate::manifold::{LogError, Manifold, are_weights, if_finite};
use crate::pose::Pose;
use crate::so3::So3;
use crate::twist::Twist;

/// SE(3) with the left-invariant product metric: poses, the distance of which weighs turning against moving.
///
/// | | |
/// | --- | --- |
/// | points | poses (R, p), `world_from_tool`; p in m |
/// | tangents | body twists: `linear` = Rᵀṗ in m, `angular` = ω in rad with Ṙ = R\[ω\] (eq. 4.14) |
/// | metric | ⟨(v, ω), (v′, ω′)⟩ = α·ωᵀω′ + β·vᵀv′, α in rad⁻², β in m⁻² |
/// | exp | (R·Exp(ω), p + R·v): slerp and a straight line of the tool's origin (eqs. 4.15, 4.16) |
/// | log | ω = log(R₁ᵀR₂), v = R₁ᵀ(p₂ − p₁) |
/// | distance | d² = α‖log(R₁ᵀR₂)‖² + β‖p₂ − p₁‖² (eq. 4.17, with the square that 7.4 lacks), on the cut locus too |
/// | transport | angular as on [`So3`]; linear Exp(−ω)·v, that is, fixed in the world |
/// | injectivity radius | π√α; at half a turn `log` is [`LogError::CutLocus`](crate::LogError::CutLocus) and names distance and angle |
///
/// Geodesics are the same for every α and β; distances, and so orders, are not: only L = √(α/β) matters, the metres that count as
/// much as one radian. The metric is the same seen from every world frame (left-invariant), but not for every tool frame: moving
/// the tool's origin changes it. For rigid motions about a screw axis see [`Se3Group`](crate::Se3Group), whose exponential is
/// another curve and whose norm is no distance.
///
/// ```
/// use se3_geom::{Manifold, Pose, Se3, nalgebra::{UnitQuaternion, Vector3}};
/// let metric = Se3::with_metres_per_radian(0.5).unwrap();
/// let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.8);
/// let pose = Pose::from_parts(Vector3::new(0.3, 0.0, 0.0).into(), turned);
/// assert!((metric.distance(&Pose::identity(), &pose) - 0.5).abs() < 1e-15); // (0.5 · 0.8)² + 0.3² = 0.5²
/// let world = Pose::from_parts(Vector3::new(4.0, 5.0, 6.0).into(), turned);
/// assert!((metric.distance(&world, &(world * pose)) - 0.5).abs() < 1e-14); // the same in another world frame
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Se3 {
    alpha: f64,
    beta: f64,
}

impl Se3 {
    /// The metric with weights α in rad⁻² and β in m⁻², both positive and finite; `None` otherwise.
    pub fn with_weights(alpha: f64, beta: f64) -> Option<Self> {
        are_weights(alpha, beta).then_some(Self { alpha, beta })
    }

    /// The metric in metres where one radian counts as much as `length_m` metres: α = L², β = 1. L must be positive and its square
    /// a positive finite number; `None` otherwise.
    pub fn with_metres_per_radian(length_m: f64) -> Option<Self> {
        Self::with_weights(length_m * length_m, 1.0).filter(|_| length_m > 0.0)
    }

    /// L = √(α/β): how many metres count as much as one radian.
    pub fn metres_per_radian(&self) -> f64 {
        (self.alpha / self.beta).sqrt()
    }
}

impl Default for Se3 {
    /// α = β = 1: one radian counts as one metre.
    fn default() -> Self {
        Self { alpha: 1.0, beta: 1.0 }
    }
}

impl Manifold for Se3 {
    type Point = Pose;
    type Tangent = Twist;

    fn exp(&self, p: &Pose, v: Twist) -> Pose {
        let translation = p.translation.vector + p.rotation * v.linear;
        Pose::from_parts(translation.into(), So3.exp(&p.rotation, v.angular))
    }
    fn log(&self, p: &Pose, q: &Pose) -> Result<Twist, LogError> {
        let angular = So3.log(&p.rotation, &q.rotation).map_err(|e| e.at_distance(self.distance(p, q)))?;
        let linear = p.rotation.inverse() * (q.translation.vector - p.translation.vector);
        if_finite(Twist { linear, angular }, &linear)
    }
    fn inner(&self, _: &Pose, u: Twist, v: Twist) -> f64 {
        self.alpha * u.angular.dot(&v.angular) + self.beta * u.linear.dot(&v.linear)
    }
    /// Each factor by itself: the world-frame velocity of the origin stays, seen from a frame that has turned by ω; rates as on
    /// [`So3`].
    fn transport(&self, p: &Pose, along: Twist, v: Twist) -> Twist {
        Twist {
            linear: So3Group::exp(-along.angular) * v.linear,
            angular: So3.transport(&p.rotation, along.angular, v.angular),
        }
    }
    fn distance(&self, p: &Pose, q: &Pose) -> f64 {
        let angle = So3.distance(&p.rotation, &q.rotation);
        let squared_length = (q.translation.vector - p.translation.vector).norm_squared();
        (self.alpha * angle * angle + self.beta * squared_length).sqrt()
    }
    /// π√α: half a turn at a standstill is the nearest cut point.
    fn injectivity_radius(&self) -> f64 {
        So3.injectivity_radius() * self.alpha.sqrt()
    }
    fn is_finite(&self, p: &Pose) -> bool {
        So3.is_finite(&p.rotation) && p.translation.vector.iter().all(|x| x.is_finite())
    }
    fn embedding(&self) -> Option<Embedding> {
        Some(Embedding::flat(3, self.beta).with_rotations(self.alpha))
    }
    fn embed(&self, p: &Self::Point, coordinates: &mut [f64]) {
        coordinates[..3].copy_from_slice(p.translation.vector.as_slice());
        So3.embed(&p.rotation, &mut coordinates[3..]);
    }
}
