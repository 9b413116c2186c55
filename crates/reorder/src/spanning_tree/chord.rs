//! Squared distances of an embedding, and lower bounds of them, from squared chords.

use se3_geom::Embedding;

use super::kd_tree::{Cell, LANES, Leaf};
use super::vectorised::{add_square, greater, multiply_add};

/// The squared distance w_f‖Δx‖² + w_r θ², with θ from the chord of unit vectors: s = ‖Δu‖² = 4 sin²(θ/2).
///
/// θ² = 4 asin²(√s/2) = 2 Σ sⁿ/(n² C(2n, n)) = s + s²/12 + s³/90 + s⁴/560 + …, and all terms are positive: what the first terms
/// give is a lower bound of θ² that grows with s. Differences, squares, sums and products of positive numbers stay monotone when
/// rounded, if they are always taken in the same order. So a bound computed from a box is never above the distance computed
/// from a point in it, and nothing here needs an epsilon.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chords {
    flat_weight: f64,
    round_weight: f64,
    pub(super) antipodes_identified: bool,
}

/// 2/(n² C(2n, n)) for n = 2 … 9.
const SERIES: [f64; 8] = [
    1.0 / 12.0,
    1.0 / 90.0,
    1.0 / 560.0,
    1.0 / 3150.0,
    1.0 / 16632.0,
    1.0 / 84084.0,
    1.0 / 411_840.0,
    1.0 / 1_969_110.0,
];
/// Up to here the first term left out, s¹⁰/9237800, is below 2e-18 of the sum.
const SERIES_REACH: f64 = 1.0 / 16.0;

/// From one point to those of a leaf.
pub(super) struct ToLeaf {
    /// Lower bounds of the squared distances, and nearly equal to them where those are short.
    pub(super) bound: [f64; LANES],
    flat: [f64; LANES],
    round: [f64; LANES],
}

impl Chords {
    pub(super) fn new(embedding: &Embedding) -> Self {
        let round = embedding.round.as_ref();
        Self {
            flat_weight: embedding.flat_weight,
            round_weight: round.map_or(0.0, |round| round.weight),
            antipodes_identified: round.is_some_and(|round| round.antipodes_identified),
        }
    }

    /// The weights of a squared unit of a flat and of a round coordinate.
    pub(super) fn weights(&self) -> [f64; 2] {
        [self.flat_weight, self.round_weight]
    }

    #[inline(always)]
    fn combine<const FUSED: bool, const F: usize, const R: usize>(&self, flat: f64, squared_angle: f64) -> f64 {
        match (F, R) {
            (_, 0) => flat * self.flat_weight,
            (0, _) => squared_angle * self.round_weight,
            _ => multiply_add::<FUSED>(flat, self.flat_weight, squared_angle * self.round_weight),
        }
    }

    /// Three terms of the series.
    #[inline(always)]
    fn bound<const FUSED: bool, const F: usize, const R: usize>(&self, flat: f64, round: f64) -> f64 {
        let tail = multiply_add::<FUSED>(multiply_add::<FUSED>(round, SERIES[1], SERIES[0]), round, 1.0);
        self.combine::<FUSED, F, R>(flat, tail * round)
    }

    /// The bounds for all points of a leaf.
    #[inline(always)]
    pub(super) fn to_leaf<const FUSED: bool, const F: usize, const R: usize>(
        self,
        from: &Leaf<F, R>,
        lane: usize,
        leaf: &Leaf<F, R>,
    ) -> ToLeaf {
        let mut flats = [[0.0; LANES]; 2];
        let mut round = [0.0; LANES];
        for (axis, (from, leaf)) in from.flat.iter().zip(&leaf.flat).enumerate() {
            let from = from[lane];
            for k in 0..LANES {
                flats[axis % 2][k] = add_square::<FUSED>(flats[axis % 2][k], leaf[k] - from);
            }
        }
        let flat = sum(&flats);
        for (from, leaf) in from.round.iter().zip(&leaf.round) {
            let from = from[lane];
            for k in 0..LANES {
                round[k] = add_square::<FUSED>(round[k], leaf[k] - from);
            }
        }
        let mut bound = [0.0; LANES];
        for k in 0..LANES {
            bound[k] = self.bound::<FUSED, F, R>(flat[k], round[k]);
        }
        ToLeaf { bound, flat, round }
    }

    /// The squared distance itself, of the points at `lane` and `k`.
    #[inline(always)]
    pub(super) fn exact<const FUSED: bool, const F: usize, const R: usize>(
        &self,
        to_leaf: &ToLeaf,
        k: usize,
        from: &Leaf<F, R>,
        lane: usize,
        leaf: &Leaf<F, R>,
    ) -> f64 {
        if R == 0 {
            return to_leaf.bound[k];
        }
        let chord = to_leaf.round[k];
        let squared_angle = if chord < SERIES_REACH {
            let mut tail = 0.0;
            for term in SERIES.iter().rev() {
                tail = multiply_add::<FUSED>(tail, chord, *term);
            }
            multiply_add::<FUSED>(tail, chord, 1.0) * chord
        } else {
            let mut opposite = 0.0;
            for (from, leaf) in from.round.iter().zip(&leaf.round) {
                opposite = add_square::<FUSED>(opposite, leaf[k] + from[lane]);
            }
            squared_wide_angle(chord, opposite)
        };
        // Two ways to round the same number must not put it below its bound.
        self.combine::<FUSED, F, R>(to_leaf.flat[k], squared_angle).max(to_leaf.bound[k])
    }

    /// Lower bounds of the squared distances from each point of a leaf to the points of a box.
    #[inline(always)]
    pub(super) fn to_cell<const FUSED: bool, const F: usize, const R: usize>(
        self,
        from: &Leaf<F, R>,
        cell: &Cell<F, R>,
    ) -> [f64; LANES] {
        let gap = |x: f64, [low, high]: [f64; 2]| greater(greater(low - x, x - high), 0.0);
        let mut flats = [[0.0; LANES]; 2];
        let mut round = [0.0; LANES];
        for (axis, (from, &cell)) in from.flat.iter().zip(&cell.flat).enumerate() {
            for k in 0..LANES {
                flats[axis % 2][k] = add_square::<FUSED>(flats[axis % 2][k], gap(from[k], cell));
            }
        }
        let flat = sum(&flats);
        for (from, &cell) in from.round.iter().zip(&cell.round) {
            for k in 0..LANES {
                round[k] = add_square::<FUSED>(round[k], gap(from[k], cell));
            }
        }
        let mut bound = [0.0; LANES];
        for k in 0..LANES {
            bound[k] = self.bound::<FUSED, F, R>(flat[k], round[k]);
        }
        bound
    }
}

/// The sum of two half sums: half as long a chain of operations that wait for each other.
#[inline(always)]
fn sum(halves: &[[f64; LANES]; 2]) -> [f64; LANES] {
    let mut sum = [0.0; LANES];
    for k in 0..LANES {
        sum[k] = halves[0][k] + halves[1][k];
    }
    sum
}

/// θ² from ‖u − v‖² and ‖u + v‖², accurate at π too, where the chord alone loses half the digits.
#[inline(never)]
fn squared_wide_angle(chord: f64, opposite: f64) -> f64 {
    let angle = 2.0 * chord.sqrt().atan2(opposite.sqrt());
    angle * angle
}
