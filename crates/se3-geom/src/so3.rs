//! Rotations as a Riemannian manifold.

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};

use crate::embedding::Embedding;
use crate::group::{LieGroup, So3Group, logarithm};
use crate::manifold::{LogError, Manifold};
use crate::unit::{HALF_TURN_ROUNDING, is_unit, length};

/// SO(3) with its bi-invariant metric: the distance of two rotations is the angle between them, in rad.
///
/// | | |
/// | --- | --- |
/// | points | unit quaternions; q and −q are one rotation, `world_from_body` |
/// | tangents at R | body rates ω in rad, Ṙ = R\[ω\] |
/// | metric | ⟨ω, υ⟩ = ωᵀυ |
/// | exp | exp(R, ω) = R·Exp(ω), Exp(ω) = I + sin θ/θ·\[ω\] + (1 − cos θ)/θ²·\[ω\]², θ = ‖ω‖ (Rodrigues); the geodesic is slerp (eq. 4.15) |
/// | log | ω with \[ω\] = log(R₁ᵀR₂) and ‖ω‖ < π |
/// | distance | ‖log(R₁ᵀR₂)‖ = 2·atan2(‖v‖, \|w\|) ∈ \[0, π\] with w + v = q₁⁻¹q₂ (eq. D.5), on the cut locus too |
/// | transport | Exp(−ω/2)·v in body coordinates |
/// | injectivity radius | π; within 2 ε of half a turn `log` is [`LogError::CutLocus`] and names the angle |
///
/// Relative error of exp and log ≤ 4e-15 at every angle from 1e-300 to π − 1e-15. Closer to half a turn than 2 ε = 4.4e-16 rad,
/// rounding decides which way round is shorter, and `log` refuses. Where half a turn must have a logarithm all the same,
/// [`So3Group::log`] returns one of the two. Source: thesis §4.5, eqs. D.3 and D.5, without the pole that D.3 has at half a turn.
///
/// ```
/// use se3_geom::{LogError, Manifold, So3, nalgebra::{UnitQuaternion, Vector3}};
/// let (start, end) = (UnitQuaternion::identity(), UnitQuaternion::from_euler_angles(0.0, 0.0, 3.0));
/// assert!((So3.log(&start, &end)? - Vector3::z() * 3.0).norm() < 1e-15);
/// assert!(So3.geodesic(&start, &end, 0.5)?.angle_to(&UnitQuaternion::from_euler_angles(0.0, 0.0, 1.5)) < 1e-15);
/// let half_turn = UnitQuaternion::from_scaled_axis(Vector3::x() * std::f64::consts::PI);
/// let pi = std::f64::consts::PI;
/// assert_eq!(So3.log(&start, &half_turn), Err(LogError::CutLocus { distance: pi, angle_rad: Some(pi) }));
/// # Ok::<(), LogError>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct So3;

impl Manifold for So3 {
    type Point = UnitQuaternion<f64>;
    type Tangent = Vector3<f64>;

    fn exp(&self, p: &Self::Point, v: Self::Tangent) -> Self::Point {
        p * So3Group::exp(v)
    }
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, LogError> {
        if !(is_unit(p.norm_squared()) && is_unit(q.norm_squared())) {
            return Err(LogError::NotAPoint);
        }
        let (cosine, vector) = relative_quaternion(p, q);
        // The cosine of half an angle next to π is half of what the angle lacks.
        if cosine < 0.5 * HALF_TURN_ROUNDING {
            let angle = 2.0 * length(&vector).atan2(cosine);
            return Err(LogError::CutLocus { distance: angle, angle_rad: Some(angle) });
        }
        logarithm(cosine, vector).map(|log| log.rotation_vector).map_err(|_| LogError::NotAPoint)
    }
    fn inner(&self, _: &Self::Point, u: Self::Tangent, v: Self::Tangent) -> f64 {
        u.dot(&v)
    }
    /// In body coordinates Exp(−ω/2)·v with ω = `along`: the body frame turns by ω, a parallel field by half of it, because
    /// the metric is bi-invariant.
    fn transport(&self, _: &Self::Point, along: Self::Tangent, v: Self::Tangent) -> Self::Tangent {
        So3Group::exp(along * -0.5) * v
    }
    /// θ = 2·atan2(sin θ/2, cos θ/2): exactly symmetric, and as accurate at 0 and at π as in between.
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64 {
        let (cosine, vector) = relative_quaternion(p, q);
        2.0 * length(&vector).atan2(cosine)
    }
    fn injectivity_radius(&self) -> f64 {
        PI
    }
    fn is_finite(&self, p: &Self::Point) -> bool {
        p.coords.iter().all(|x| x.is_finite())
    }
    fn embedding(&self) -> Option<Embedding> {
        Some(Embedding::flat(0, 0.0).with_rotations(1.0))
    }
    fn embed(&self, p: &Self::Point, coordinates: &mut [f64]) {
        coordinates[..4].copy_from_slice(p.coords.as_slice());
    }
}

/// Cosine (≥ 0) and vector part of ±p⁻¹q.
///
/// The vector part is that of ½(p + q)⁻¹(q − p): the difference of near quaternions is exact, so that nothing is lost near 0,
/// and swapping p and q flips its sign to the last bit.
fn relative_quaternion(p: &UnitQuaternion<f64>, q: &UnitQuaternion<f64>) -> (f64, Vector3<f64>) {
    let cosine = p.coords.dot(&q.coords);
    // q and −q are the same rotation.
    let q = if cosine < 0.0 { -q.into_inner() } else { q.into_inner() };
    let vector = ((p.into_inner() + q).conjugate() * (q - p.into_inner())).imag() * 0.5;
    (cosine.abs(), vector)
}
