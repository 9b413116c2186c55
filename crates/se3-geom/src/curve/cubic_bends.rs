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
use crate::tridiagonal::Tridiagonal;

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
