//! Poses in the plane as a Riemannian manifold.

use nalgebra::{Isometry2, UnitComplex};

use crate::embedding::Embedding;
use crate::manifold::{LogError, Manifold, are_weights, if_finite};
use crate::planar_twist::PlanarTwist;
use crate::so2::So2;

/// SE(2) with the left-invariant product metric: poses in the plane.
///
/// | | |
/// | --- | --- |
/// | points | poses (R(θ), p), `world_from_body`; p in m |
/// | tangents | body twists: `linear` = Rᵀṗ in m, `angular` = θ̇ in rad |
/// | metric | ⟨(v, ω), (v′, ω′)⟩ = α·ωω′ + β·vᵀv′, α in rad⁻², β in m⁻² |
/// | exp | (R(θ + ω), p + R·v): an even turn while the origin moves on a straight line |
/// | log | ω = θ₂ − θ₁ the short way round, v = R₁ᵀ(p₂ − p₁) |
/// | distance | d² = α·ω² + β·‖p₂ − p₁‖² (thesis eq. 4.10, with ω the short way round) |
/// | transport | (R(−ω)·v, ω): fixed in the world |
/// | injectivity radius | π√α; at half a turn `log` is [`LogError::CutLocus`](crate::LogError::CutLocus) and names distance and angle |
///
/// The motion along a circular arc, about a fixed centre, is [`Se2Group`](crate::Se2Group)'s. Relative error of log ≤ 1e-14.
///
/// ```
/// use se3_geom::{Manifold, Se2, nalgebra::{Isometry2, Vector2}};
/// let metric = Se2::with_weights(4.0, 1.0).unwrap(); // one radian counts as two metres
/// let pose = Isometry2::new(Vector2::new(3.0, 0.0), 2.0);
/// assert!((metric.distance(&Isometry2::identity(), &pose) - 5.0).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Se2 {
    alpha: f64,
    beta: f64,
}

impl Se2 {
    /// The metric with weights α in rad⁻² and β in m⁻², both positive and finite; `None` otherwise.
    pub fn with_weights(alpha: f64, beta: f64) -> Option<Self> {
        are_weights(alpha, beta).then_some(Self { alpha, beta })
    }
}

impl Default for Se2 {
    /// α = β = 1: one radian counts as one metre.
    fn default() -> Self {
        Self { alpha: 1.0, beta: 1.0 }
    }
}

impl Manifold for Se2 {
    type Point = Isometry2<f64>;
    type Tangent = PlanarTwist;

    fn exp(&self, p: &Self::Point, v: PlanarTwist) -> Self::Point {
        let translation = p.translation.vector + p.rotation * v.linear;
        Isometry2::from_parts(translation.into(), So2.exp(&p.rotation, v.angular))
    }
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<PlanarTwist, LogError> {
        let angular = So2.log(&p.rotation, &q.rotation).map_err(|e| e.at_distance(self.distance(p, q)))?;
        let linear = p.rotation.inverse() * (q.translation.vector - p.translation.vector);
        if_finite(PlanarTwist { linear, angular }, &linear)
    }
    fn inner(&self, _: &Self::Point, u: PlanarTwist, v: PlanarTwist) -> f64 {
        self.alpha * u.angular * v.angular + self.beta * u.linear.dot(&v.linear)
    }
    /// The world-frame velocity of the origin stays; the body sees it turned back by the angle that it has turned.
    fn transport(&self, _: &Self::Point, along: PlanarTwist, v: PlanarTwist) -> PlanarTwist {
        PlanarTwist { linear: UnitComplex::new(-along.angular) * v.linear, ..v }
    }
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64 {
        let angle = So2.distance(&p.rotation, &q.rotation);
        let squared_length = (q.translation.vector - p.translation.vector).norm_squared();
        (self.alpha * angle * angle + self.beta * squared_length).sqrt()
    }
    /// π√α: half a turn at a standstill is the nearest cut point.
    fn injectivity_radius(&self) -> f64 {
        So2.injectivity_radius() * self.alpha.sqrt()
    }
    fn is_finite(&self, p: &Self::Point) -> bool {
        So2.is_finite(&p.rotation) && p.translation.vector.iter().all(|x| x.is_finite())
    }
    fn embedding(&self) -> Option<Embedding> {
        Some(Embedding::flat(2, self.beta).with_sphere(2, self.alpha))
    }
    fn embed(&self, p: &Self::Point, coordinates: &mut [f64]) {
        coordinates[..2].copy_from_slice(p.translation.vector.as_slice());
        So2.embed(&p.rotation, &mut coordinates[2..]);
    }
}
