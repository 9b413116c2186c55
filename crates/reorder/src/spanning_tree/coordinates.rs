//! Points as coordinates of the manifold's embedding, equal ones merged.

use se3_geom::{Embedding, Manifold};

use crate::equality::LEAST_DIFFERENCE;

use super::boruvka;
use super::chord::Chords;
use super::distinct::Distinct;
use super::kd_tree::{KdTree, Record};

/// A unit vector whose square is off by more than rounding is normalised. Others are kept to the last digit, so that the
/// differences of near ones stay exact.
const NORM_TOLERANCE: f64 = 16.0 * f64::EPSILON;

/// Points that a search tree can be built over.
pub(super) struct Coordinates {
    embedding: Embedding,
    /// `embedding.dimension()` numbers for each input row. Equal points have equal bits.
    values: Vec<f64>,
    span: Span,
}

/// The algorithm for one number of flat and of round coordinates.
type Span = fn(&Embedding, &[f64]) -> Vec<[u32; 2]>;

impl Coordinates {
    /// `None` where the manifold has no embedding, or one that is not searched here, or where a point has no direction.
    pub(super) fn of<M: Manifold>(manifold: &M, points: &[M::Point]) -> Option<Self> {
        let embedding = manifold.embedding()?;
        let span = span_for(&embedding).filter(|_| points.len() < 1 << 31)?;
        let mut values = vec![0.0; embedding.dimension() * points.len()];
        for (p, point) in points.iter().zip(values.chunks_exact_mut(embedding.dimension())) {
            manifold.embed(p, point);
            if let Some(round) = &embedding.round {
                let (_, unit) = point.split_at_mut(embedding.flat_dimension);
                normalise(unit)?;
                if round.antipodes_identified {
                    turn_to_one_side(unit);
                }
            }
            // What has no square counts as nothing, and equal points have equal bits: negative zeros become positive.
            point.iter_mut().for_each(|x| *x = if x.abs() < LEAST_DIFFERENCE { 0.0 } else { *x });
        }
        Some(Self { embedding, values, span })
    }

    /// The edges of the minimum spanning tree as pairs of input rows. Fewer than n − 1 where all distances left overflow.
    pub(super) fn spanning_pairs(self) -> Vec<[u32; 2]> {
        (self.span)(&self.embedding, &self.values)
    }
}

fn span_for(embedding: &Embedding) -> Option<Span> {
    Some(match (embedding.flat_dimension, embedding.round.map_or(0, |round| round.dimension)) {
        (1, 0) => span::<1, 0, 3>,
        (2, 0) => span::<2, 0, 3>,
        (3, 0) => span::<3, 0, 3>,
        (4, 0) => span::<4, 0, 3>,
        (5, 0) => span::<5, 0, 3>,
        (6, 0) => span::<6, 0, 3>,
        (7, 0) => span::<7, 0, 3>,
        (8, 0) => span::<8, 0, 3>,
        // With zeros in the coordinates that are not there.
        (9..=16, 0) => span::<16, 0, 3>,
        (17..=32, 0) => span::<32, 0, 3>,
        (0, 2) => span::<0, 2, 4>,
        (0, 3) => span::<0, 3, 4>,
        (0, 4) => span::<0, 4, 4>,
        (2, 2) => span::<2, 2, 4>,
        (3, 2) => span::<3, 2, 4>,
        (3, 4) => span::<3, 4, 4>,
        _ => return None,
    })
}

fn span<const F: usize, const R: usize, const K: usize>(embedding: &Embedding, values: &[f64]) -> Vec<[u32; 2]> {
    let chords = Chords::new(embedding);
    let record = |(point, row): (&[f64], u32)| {
        let (x, u) = point.split_at(embedding.flat_dimension);
        let mut record = Record { flat: [0.0; F], round: [0.0; R], row };
        record.flat[..x.len()].copy_from_slice(x);
        record.round.copy_from_slice(u);
        record
    };
    let points = || values.chunks_exact(embedding.dimension()).zip(0..);
    let tree = KdTree::<F, R>::new(points().map(record).collect(), chords.weights());
    if !tree.has_heap() {
        return boruvka::spanning_pairs::<F, R, K>(&tree, &chords);
    }
    // A few equal points are like any others, but time grows with the square of their number.
    let distinct = Distinct::of(points(), values.len() / embedding.dimension());
    let records = distinct.points.into_iter().map(record).collect();
    let mut pairs = boruvka::spanning_pairs::<F, R, K>(&KdTree::<F, R>::new(records, chords.weights()), &chords);
    pairs.extend(distinct.repeats);
    pairs
}

fn normalise(unit: &mut [f64]) -> Option<()> {
    let square: f64 = unit.iter().map(|x| x * x).sum();
    if (square - 1.0).abs() > NORM_TOLERANCE {
        let norm = square.sqrt();
        unit.iter_mut().for_each(|x| *x /= norm);
        return (square.is_normal()).then_some(());
    }
    Some(())
}

/// Of u and −u the one whose last coordinate that is not zero is positive.
fn turn_to_one_side(unit: &mut [f64]) {
    if unit.iter().rev().find(|x| **x != 0.0).is_some_and(|x| *x < 0.0) {
        unit.iter_mut().for_each(|x| *x = -*x);
    }
}
