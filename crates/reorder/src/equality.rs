//! When two points are one.

use se3_geom::{Embedding, Manifold};

/// Coordinates that differ by no more than this share of the greater one are equal: each is rounded to ε/2 of itself where it is read,
/// and to about as much again where a vector is normalised.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Squares of differences below this lose digits, as √(least normal number)/ε: distances of such points are no distances.
pub(crate) const LEAST_DIFFERENCE: f64 = 6.7e-139;

/// Compares points by their coordinates, which no third point and no unit of length has a say in.
pub(crate) struct Equality<'a, M: Manifold> {
    manifold: &'a M,
    embedding: Option<Embedding>,
    coordinates: [Vec<f64>; 2],
}

impl<'a, M: Manifold> Equality<'a, M> {
    pub(crate) fn new(manifold: &'a M) -> Self {
        let embedding = manifold.embedding();
        let dimension = embedding.map_or(0, |embedding| embedding.dimension());
        Self { manifold, embedding, coordinates: [vec![0.0; dimension], vec![0.0; dimension]] }
    }

    /// Whether every coordinate is the same up to rounding. Where there are no coordinates, only distance 0 is none.
    pub(crate) fn is_rounding(&mut self, p: &M::Point, q: &M::Point) -> bool {
        self.all(p, q, |a, b| (a - b).abs() <= ROUNDING * a.abs().max(b.abs()))
    }

    /// Whether every coordinate is the same to the last digit.
    pub(crate) fn is_exact(&mut self, p: &M::Point, q: &M::Point) -> bool {
        self.all(p, q, |a, b| a == b)
    }

    /// Whether the points differ, but by so little that the square of it is lost.
    pub(crate) fn underflows(&mut self, p: &M::Point, q: &M::Point) -> bool {
        if self.embedding.is_none() {
            return false;
        }
        let near = self.all(p, q, |a, b| (a - b).abs() < LEAST_DIFFERENCE);
        let extent = self.coordinates.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        near && !self.all(p, q, |a, b| (a - b).abs() <= ROUNDING * extent)
    }

    fn all(&mut self, p: &M::Point, q: &M::Point, are_equal: impl Fn(f64, f64) -> bool) -> bool {
        let Some(Embedding { flat_dimension, round, .. }) = self.embedding else {
            return self.manifold.distance(p, q) == 0.0;
        };
        for (point, coordinates) in [p, q].into_iter().zip(&mut self.coordinates) {
            self.manifold.embed(point, coordinates);
            let unit = &mut coordinates[flat_dimension..];
            let norm = unit.iter().map(|x| x * x).sum::<f64>().sqrt();
            unit.iter_mut().for_each(|x| *x /= norm);
        }
        let [(flat_p, unit_p), (flat_q, unit_q)] = self.coordinates.each_ref().map(|c| c.split_at(flat_dimension));
        let equal = |u: &[f64], v: &[f64], sign: f64| u.iter().zip(v).all(|(&a, &b)| are_equal(a, sign * b));
        let antipodes = round.is_some_and(|round| round.antipodes_identified);
        equal(flat_p, flat_q, 1.0) && (equal(unit_p, unit_q, 1.0) || antipodes && equal(unit_p, unit_q, -1.0))
    }
}
