//! Points moved onto the line that their neighbours suggest.

use se3_geom::Manifold;

use crate::tour::Problem;

/// Rounds of the power iteration; the direction only has to be good to a fraction of the noise.
const ROUNDS: usize = 30;

/// Every point moved onto the weighted principal line of its near points and itself, and how far each was moved.
///
/// In the tangent space at p, with vᵢ = log_p(qᵢ) of the eight nearest points, v₀ = 0 and weights wᵢ = exp(−‖vᵢ‖²/2h²), h the mean
/// of ‖vᵢ‖, the line goes through the weighted mean along the direction u that makes Σ wᵢ⟨vᵢ − mean, u⟩² greatest; p moves to
/// the foot of the perpendicular from 0. Inner products are all that is used: u = Σ cᵢ(vᵢ − mean), where c is the greatest
/// eigenvector of the weighted Gram matrix. Noise of independent points shrinks to about √(3/8) of itself across the curve, and
/// stays along it.
pub(crate) fn denoised<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    problem: &Problem<M>,
) -> (Vec<M::Point>, Vec<f64>) {
    let moved = |v: usize| {
        let step = step_to_line(manifold, &points[v], problem, v)?;
        Some((manifold.exp(&points[v], step), manifold.norm(&points[v], step)))
    };
    (0..points.len()).map(|v| moved(v).unwrap_or_else(|| (points[v].clone(), 0.0))).unzip()
}

/// `None` where the near points give no direction.
fn step_to_line<M: Manifold>(manifold: &M, p: &M::Point, problem: &Problem<M>, v: usize) -> Option<M::Tangent> {
    let logs: Vec<M::Tangent> = problem.near(v).iter().filter_map(|near| near.log()).collect();
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
    Some(mean - u * manifold.inner(p, mean, u))
}
