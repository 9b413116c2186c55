//! Planar similarities as a Riemannian manifold.

use nalgebra::{Isometry2, Similarity2, UnitComplex};

use crate::embedding::Embedding;
use crate::manifold::{LogError, Manifold, are_weights, if_finite};
use crate::planar_twist::SimilarityTwist;
use crate::so2::So2;

/// The similarities x ↦ e^λ·R(θ)·x + d of the plane, as the product of scales, rotations and translations.
///
/// | | |
/// | --- | --- |
/// | points | similarities: scale e^λ > 0, rotation R(θ), translation d in m (thesis eq. 4.18, with R ∈ SO(2), d ∈ ℝ²) |
/// | tangents | `scaling` = λ̇, `angular` = θ̇ in rad, `linear` = Rᵀḋ in m: turned into the body, not scaled |
/// | metric | α·(λ̇λ̇′ + θ̇θ̇′) + β·vᵀv′, β in m⁻² |
/// | exp, log | even scaling and turning while the origin moves on a straight line; θ the short way round |
/// | distance | d² = α((λ₂ − λ₁)² + (θ₂ − θ₁)²) + β‖d₂ − d₁‖² (eq. 4.21, with the square that its last term lacks) |
/// | transport | as on [`Se2`](crate::Se2); scales are a flat factor |
/// | injectivity radius | π√α; at half a turn `log` is [`LogError::CutLocus`](crate::LogError::CutLocus) and names distance and angle |
///
/// The metric is invariant under rigid motions from the left, not under scalings, which stretch the translations (the thesis
/// calls it left-invariant). The logarithmic spirals of the group are [`Sim2Group`](crate::Sim2Group)'s. Relative error of log
/// ≤ 1e-14.
///
/// ```
/// use se3_geom::{Manifold, Sim2, nalgebra::{Similarity2, Vector2}};
/// let metric = Sim2::with_weights(10.0, 1.0).unwrap();
/// let grown = Similarity2::new(Vector2::new(3.0, 4.0), 0.0, 1f64.exp());
/// assert!((metric.distance(&Similarity2::identity(), &grown) - 35f64.sqrt()).abs() < 1e-14);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sim2 {
    alpha: f64,
    beta: f64,
}

impl Sim2 {
    /// The metric with weights α, for squared radians and squared logarithms of scale alike, and β in m⁻², both positive and
    /// finite; `None` otherwise.
    pub fn with_weights(alpha: f64, beta: f64) -> Option<Self> {
        are_weights(alpha, beta).then_some(Self { alpha, beta })
    }
}

impl Default for Sim2 {
    /// α = β = 1.
    fn default() -> Self {
        Self { alpha: 1.0, beta: 1.0 }
    }
}

/// λ₂ − λ₁ to a rounding or two for all scales, and exactly antisymmetric. NaN where a scale is not positive.
fn log_ratio(from: f64, into: f64) -> f64 {
    if !(from > 0.0 && into > 0.0) {
        return f64::NAN;
    }
    let (smaller, larger) = (from.min(into), from.max(into));
    let (growth, ratio) = ((larger - smaller) / smaller, larger / smaller);
    let logarithm = if growth < 1.0 {
        growth.ln_1p()
    } else if ratio.is_finite() {
        ratio.ln()
    } else {
        // Above 709, of which the roundings of the two logarithms are a small part.
        larger.ln() - smaller.ln()
    };
    if into < from { -logarithm } else { logarithm }
}

impl Manifold for Sim2 {
    type Point = Similarity2<f64>;
    type Tangent = SimilarityTwist;

    fn exp(&self, p: &Self::Point, v: SimilarityTwist) -> Self::Point {
        let rotation = &p.isometry.rotation;
        let translation = p.isometry.translation.vector + rotation * v.linear;
        let isometry = Isometry2::from_parts(translation.into(), So2.exp(rotation, v.angular));
        // The clamp keeps the scale positive where e^λ leaves the range of numbers, |λ| > 708.
        Similarity2::from_isometry(isometry, (p.scaling() * v.scaling.exp()).clamp(f64::MIN_POSITIVE, f64::MAX))
    }
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<SimilarityTwist, LogError> {
        let angular =
            So2.log(&p.isometry.rotation, &q.isometry.rotation).map_err(|e| e.at_distance(self.distance(p, q)))?;
        let world = q.isometry.translation.vector - p.isometry.translation.vector;
        let linear = p.isometry.rotation.inverse() * world;
        let scaling = log_ratio(p.scaling(), q.scaling());
        if_finite(SimilarityTwist { linear, angular, scaling }, &linear.push(scaling))
    }
    fn inner(&self, _: &Self::Point, u: SimilarityTwist, v: SimilarityTwist) -> f64 {
        self.alpha * (u.scaling * v.scaling + u.angular * v.angular) + self.beta * u.linear.dot(&v.linear)
    }
    /// As on [`Se2`](crate::Se2); scales are a flat factor.
    fn transport(&self, _: &Self::Point, along: SimilarityTwist, v: SimilarityTwist) -> SimilarityTwist {
        SimilarityTwist { linear: UnitComplex::new(-along.angular) * v.linear, ..v }
    }
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64 {
        let angle = So2.distance(&p.isometry.rotation, &q.isometry.rotation);
        let scaling = log_ratio(p.scaling(), q.scaling());
        let squared_length = (q.isometry.translation.vector - p.isometry.translation.vector).norm_squared();
        (self.alpha * (scaling * scaling + angle * angle) + self.beta * squared_length).sqrt()
    }
    /// π√α: half a turn at a standstill is the nearest cut point.
    fn injectivity_radius(&self) -> f64 {
        So2.injectivity_radius() * self.alpha.sqrt()
    }
    fn is_finite(&self, p: &Self::Point) -> bool {
        let rotation = So2.is_finite(&p.isometry.rotation);
        rotation && p.scaling().ln().is_finite() && p.isometry.translation.vector.iter().all(|x| x.is_finite())
    }
    fn embedding(&self) -> Option<Embedding> {
        Some(Embedding::flat(3, self.beta).with_sphere(2, self.alpha))
    }
    fn embed(&self, p: &Self::Point, coordinates: &mut [f64]) {
        let isometry = &p.isometry;
        coordinates[..2].copy_from_slice(isometry.translation.vector.as_slice());
        // Flat coordinates share the weight β.
        coordinates[2] = p.scaling().ln() * (self.alpha / self.beta).sqrt();
        So2.embed(&isometry.rotation, &mut coordinates[3..]);
    }
}
