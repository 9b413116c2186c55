//! Points moved toward the parabola that their neighbours suggest.

use se3_geom::Manifold;
use se3_geom::nalgebra::{Matrix3, Vector3};

use crate::tour::Problem;

/// Rounds of the power iteration; the direction only has to be good to a fraction of the noise.
const ROUNDS: usize = 30;
/// More would smooth bends, fewer would follow the noise.
const NEIGHBOURS: usize = 8;

/// Every point moved toward the parabola that fits its near points and itself, and how far each was moved.
///
/// In the tangent space at p, with vᵢ = log_p(qᵢ) of the eight nearest points, v₀ = 0 and weights wᵢ = exp(−‖vᵢ‖²/2h²), h the mean
/// of ‖vᵢ‖, the direction u of the curve is the one that makes Σ wᵢ⟨vᵢ − mean, u⟩² greatest. With tᵢ = ⟨vᵢ, u⟩ the parabola a + bt + ct²
/// makes Σ wᵢ‖vᵢ − a − btᵢ − ctᵢ²‖² least; p moves by the part of a across u, but no farther than the median of those misses: that is
/// what the noise is by the points themselves, and where the near points are of two strands, or p is in a sharp bend, a is none to
/// follow. Inner products are all that is used: u is a sum of the vᵢ − mean by the greatest eigenvector of their weighted Gram
/// matrix.
pub(crate) fn denoised<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    problem: &Problem<M>,
) -> (Vec<M::Point>, Vec<f64>) {
    let moved = |v: usize| {
        let step = step_to_parabola(manifold, &points[v], problem, v)?;
        Some((manifold.exp(&points[v], step), manifold.norm(&points[v], step)))
    };
    (0..points.len()).map(|v| moved(v).unwrap_or_else(|| (points[v].clone(), 0.0))).unzip()
}

/// `None` where the near points give no direction.
fn step_to_parabola<M: Manifold>(manifold: &M, p: &M::Point, problem: &Problem<M>, v: usize) -> Option<M::Tangent> {
    let logs: Vec<M::Tangent> = problem.near(v).iter().take(NEIGHBOURS).filter_map(|near| near.log()).collect();
    let first = *logs.first()?;
    let zero = first * 0.0;
    let around: Vec<M::Tangent> = std::iter::once(zero).chain(logs).collect();
    let lengths: Vec<f64> = around.iter().map(|&v| manifold.norm(p, v)).collect();
    let mean_length = lengths.iter().sum::<f64>() / (lengths.len() - 1) as f64;
    let weights: Vec<f64> = lengths.iter().map(|l| (-0.5 * (l / mean_length).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let sum = |scales: &[f64], vectors: &[M::Tangent]| {
        scales.iter().zip(vectors).fold(zero, |sum, (&scale, &vector)| sum + vector * scale)
    };
    let mean = sum(&weights, &around) * (1.0 / total);
    // √w (v − mean): their Gram matrix has the eigenvalues of the weighted covariance.
    let scaled: Vec<M::Tangent> = around.iter().zip(&weights).map(|(&v, w)| (v - mean) * w.sqrt()).collect();
    let farthest = (0..scaled.len())
        .max_by(|&a, &b| manifold.inner(p, scaled[a], scaled[a]).total_cmp(&manifold.inner(p, scaled[b], scaled[b])))?;
    let mut u = scaled[farthest];
    for _ in 0..ROUNDS {
        let next = scaled.iter().fold(zero, |sum, &s| sum + s * manifold.inner(p, s, u));
        let length = manifold.norm(p, next);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        u = next * (1.0 / length);
    }
    // In units of the mean length, so that the normal equations are well scaled.
    let powers = around.iter().map(|&v| manifold.inner(p, v, u) / mean_length).map(|t| Vector3::new(1.0, t, t * t));
    let powers: Vec<Vector3<f64>> = powers.collect();
    let normal: Matrix3<f64> = powers.iter().zip(&weights).map(|(row, &w)| row * row.transpose() * w).sum();
    let inverse = normal.try_inverse()?;
    let coefficient = |k: usize| {
        let shares: Vec<f64> = powers.iter().zip(&weights).map(|(row, w)| w * (inverse * row)[k]).collect();
        sum(&shares, &around)
    };
    let [a, b, c] = [0, 1, 2].map(coefficient);
    let mut misses: Vec<f64> =
        around.iter().zip(&powers).map(|(&v, t)| manifold.norm(p, v - a - b * t[1] - c * t[2])).collect();
    let middle = misses.len() / 2;
    let noise = *misses.select_nth_unstable_by(middle, f64::total_cmp).1;
    let across = a - u * manifold.inner(p, a, u);
    let length = manifold.norm(p, across);
    length.is_finite().then(|| if length > noise { across * (noise / length) } else { across })
}
