//! Where on the parameter line the points of a curve lie.

use crate::manifold::Manifold;

/// The rule by which knots are laid for the points of a curve. One knot a point; for a closed curve give the first point again
/// at the end.
///
/// ```
/// use se3_geom::{nalgebra::Vector1, Euclidean, Parameterisation};
/// let points = [0.0, 4.0, 5.0].map(Vector1::new);
/// let knots = |rule: Parameterisation| rule.knots(&Euclidean::<1>, &points);
/// assert_eq!(knots(Parameterisation::Uniform), [0.0, 1.0, 2.0]);
/// assert_eq!(knots(Parameterisation::ChordLength), [0.0, 4.0, 5.0]);
/// assert_eq!(knots(Parameterisation::Centripetal), [0.0, 2.0, 3.0]);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Parameterisation {
    /// tᵢ = i.
    Uniform,
    /// tᵢ₊₁ − tᵢ = d(pᵢ, pᵢ₊₁): near unit speed on even gaps; acceleration explodes next to near-duplicates.
    ChordLength,
    /// tᵢ₊₁ − tᵢ = √d(pᵢ, pᵢ₊₁): milder at uneven gaps.
    #[default]
    Centripetal,
    /// These: time stamps, say.
    Given(Vec<f64>),
}

impl Parameterisation {
    /// The knots for `points`. Equal neighbours get equal knots from the rules by distance, which the splines refuse: merge
    /// such points first.
    pub fn knots<M: Manifold>(&self, manifold: &M, points: &[M::Point]) -> Vec<f64> {
        match self {
            Self::Uniform => (0..points.len()).map(|i| i as f64).collect(),
            Self::ChordLength => running_sum(manifold, points, |d| d),
            Self::Centripetal => centripetal_knots(manifold, points),
            Self::Given(knots) => knots.clone(),
        }
    }
}

/// Knots by the centripetal rule tᵢ₊₁ − tᵢ = √d(pᵢ, pᵢ₊₁), from 0, one a point (Lee 1989).
///
/// Milder at uneven gaps than chord length, whose acceleration explodes next to near-duplicates. For a closed curve give the
/// first point again at the end.
pub fn centripetal_knots<M: Manifold>(manifold: &M, points: &[M::Point]) -> Vec<f64> {
    running_sum(manifold, points, f64::sqrt)
}

fn running_sum<M: Manifold>(manifold: &M, points: &[M::Point], step: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut knots = Vec::with_capacity(points.len());
    knots.extend(points.first().map(|_| 0.0));
    for pair in points.windows(2) {
        let last = knots[knots.len() - 1];
        knots.push(last + step(manifold.distance(&pair[0], &pair[1])));
    }
    knots
}
