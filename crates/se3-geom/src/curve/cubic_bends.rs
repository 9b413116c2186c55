//! The second derivatives at the knots that make a piecewise cubic C².
//!
//! With hᵢ the length of segment i and dᵢ its displacement, continuity of the second derivative at knot i reads
//!
//! vᵢ₋₁/hᵢ₋₁ + 2(1/hᵢ₋₁ + 1/hᵢ)vᵢ + vᵢ₊₁/hᵢ = 3(dᵢ₋₁/hᵢ₋₁² + dᵢ/hᵢ²),
//!
//! which for equal lengths is thesis eq. 6.9 with the end slopes given, and eq. 6.10 on a closed curve. Of the slopes each knot's
//! second derivative is then taken on the longer side, where it is the difference of smaller numbers, and the pieces are made
//! from these: next to a long piece a short one made from slopes would have lost most digits of its second derivative.

use nalgebra::SVector;

use super::cubic_spline::CubicEnds;

/// One second derivative a knot; on a closed curve the first serves for the last too. `None` where they overflow.
pub(crate) fn cubic_bends<const N: usize>(
    displacements: &[SVector<f64, N>],
    lengths: &[f64],
    ends: CubicEnds<N>,
) -> Option<Vec<SVector<f64, N>>> {
    let slopes = cubic_slopes(displacements, lengths, ends);
    let knots = slopes.len();
    let bend = |knot: usize| {
        let (segment, at_start) = longer_side(knot, lengths, knots);
        let (d, h) = (displacements[segment], lengths[segment]);
        let (v0, v1) = (slopes[segment], slopes[(segment + 1) % knots]);
        let pull = d * (6.0 / (h * h));
        if at_start { pull - (v0 * 4.0 + v1 * 2.0) / h } else { (v0 * 2.0 + v1 * 4.0) / h - pull }
    };
    let bends: Vec<_> = (0..knots).map(bend).collect();
    bends.iter().all(|v| v.iter().all(|x| x.is_finite())).then_some(bends)
}

/// The longer of a knot's segments, and whether the knot is its start.
pub(crate) fn longer_side(knot: usize, lengths: &[f64], knots: usize) -> (usize, bool) {
    let closed = lengths.len() == knots;
    let before = if closed && knot == 0 { Some(knots - 1) } else { knot.checked_sub(1) };
    match (before, lengths.get(knot)) {
        (Some(before), Some(after)) if lengths[before] > *after => (before, false),
        (_, Some(_)) => (knot, true),
        (before, None) => (before.unwrap_or(0), false),
    }
}

fn cubic_slopes<const N: usize>(
    displacements: &[SVector<f64, N>],
    lengths: &[f64],
    ends: CubicEnds<N>,
) -> Vec<SVector<f64, N>> {
    let segments = lengths.len();
    let closed = matches!(ends, CubicEnds::Periodic);
    let rows = segments + usize::from(!closed);
    let mut system = Tridiagonal { rows: vec![[0.0; 3]; rows] };
    let mut right = vec![SVector::zeros(); rows];
    for (i, (displacement, h)) in displacements.iter().zip(lengths).enumerate() {
        let (next, pull) = ((i + 1) % rows, displacement * (3.0 / (h * h)));
        system.rows[i][1] += 2.0 / h;
        system.rows[next][1] += 2.0 / h;
        system.rows[i][2] = 1.0 / h;
        system.rows[next][0] = 1.0 / h;
        right[i] += pull;
        right[next] += pull;
    }
    let mean_slope = |i: usize| displacements[i] / lengths[i];
    match ends {
        // A vanishing second derivative is what the sums above say in the first and last row.
        CubicEnds::Natural | CubicEnds::Periodic => {}
        CubicEnds::Clamped { start, end } => system.fix_ends(&mut right, start, end),
        CubicEnds::NotAKnot if segments == 1 => system.fix_ends(&mut right, mean_slope(0), mean_slope(0)),
        CubicEnds::NotAKnot if segments == 2 => {
            // One parabola through the three points.
            let curvature = (mean_slope(1) - mean_slope(0)) / (lengths[0] + lengths[1]);
            let (start, end) = (mean_slope(0) - curvature * lengths[0], mean_slope(1) + curvature * lengths[1]);
            system.fix_ends(&mut right, start, end);
        }
        CubicEnds::NotAKnot => {
            // Equal third derivatives on both sides of the second knot, with the second derivative's own equation there used
            // up to keep the row tridiagonal: h₁v₀ + (h₀+h₁)v₁ = [h₁(3h₀+2h₁)m₀ + h₀²m₁]/(h₀+h₁), m the mean slopes.
            let row = |at_end: usize, inner: usize| {
                let (h, k) = (lengths[at_end], lengths[inner]);
                let sum = (mean_slope(at_end) * (k * (3.0 * h + 2.0 * k)) + mean_slope(inner) * (h * h)) / (h + k);
                // Divided by k: a row of the size of 1, which nothing overflows.
                (1.0 + h / k, sum / k)
            };
            let ((first, first_sum), (last, last_sum)) = (row(0, 1), row(segments - 1, segments - 2));
            system.rows[0] = [0.0, 1.0, first];
            system.rows[rows - 1] = [last, 1.0, 0.0];
            (right[0], right[rows - 1]) = (first_sum, last_sum);
        }
    }
    system.solve(&mut right, closed);
    right
}

/// Row i holds the factors of unknowns i−1, i, i+1, cyclically.
struct Tridiagonal {
    rows: Vec<[f64; 3]>,
}

impl Tridiagonal {
    fn fix_ends<const N: usize>(
        &mut self,
        right: &mut [SVector<f64, N>],
        start: SVector<f64, N>,
        end: SVector<f64, N>,
    ) {
        let last = self.rows.len() - 1;
        (self.rows[0], self.rows[last]) = ([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]);
        (right[0], right[last]) = (start, end);
    }

    /// Elimination without pivoting: stable, for the rows are diagonally dominant but for those of not-a-knot ends, whose
    /// pivots stay positive too.
    fn solve<const N: usize>(&self, x: &mut [SVector<f64, N>], closed: bool) {
        if !closed {
            return self.eliminate(x, &mut []);
        }
        // With the last unknown z held back the rest is a chain, x = y − z·r; the last row then gives z.
        let last = x.len() - 1;
        let mut response = vec![0.0; last];
        response[0] += self.rows[0][0];
        response[last - 1] += self.rows[last - 1][2];
        let (chain, rest) = x.split_at_mut(last);
        self.eliminate(chain, &mut response);
        let [lower, diagonal, corner] = self.rows[last];
        let pivot = diagonal - corner * response[0] - lower * response[last - 1];
        let z = (rest[0] - chain[0] * corner - chain[last - 1] * lower) / pivot;
        for (x, r) in chain.iter_mut().zip(&response) {
            *x -= z * *r;
        }
        rest[0] = z;
    }

    fn eliminate<const N: usize>(&self, x: &mut [SVector<f64, N>], response: &mut [f64]) {
        let rows = x.len();
        let mut ratios = vec![0.0; rows];
        for i in 0..rows {
            let [lower, diagonal, upper] = self.rows[i];
            let (lower, before) = if i > 0 { (lower, i - 1) } else { (0.0, 0) };
            let pivot = diagonal - lower * ratios[before];
            x[i] = (x[i] - x[before] * lower) / pivot;
            if !response.is_empty() {
                response[i] = (response[i] - lower * response[before]) / pivot;
            }
            ratios[i] = upper / pivot;
        }
        for i in (0..rows.saturating_sub(1)).rev() {
            let next = x[i + 1];
            x[i] -= next * ratios[i];
            if !response.is_empty() {
                response[i] -= ratios[i] * response[i + 1];
            }
        }
    }
}
