//! The order of edges.

use se3_geom::Manifold;

/// An edge between two rows, i < j. Compared as (length, i, j): a strict total order, under which the minimum spanning tree is
/// unique even where lengths tie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge {
    pub(super) length: f64,
    pub(super) i: u32,
    pub(super) j: u32,
}

impl Edge {
    /// Always measured from the smaller row, so that the tree does not depend on a metric being symmetric to the last bit.
    pub(super) fn between<M: Manifold>(manifold: &M, points: &[M::Point], a: u32, b: u32) -> Self {
        let (i, j) = (a.min(b), a.max(b));
        Self { length: manifold.distance(&points[i as usize], &points[j as usize]), i, j }
    }

    /// An edge of known length, or of any number that grows with it.
    #[inline(always)]
    pub(super) fn new(length: f64, a: u32, b: u32) -> Self {
        Self { length, i: a.min(b), j: a.max(b) }
    }

    /// A number that grows as (length, i, j) does: lengths are not negative, and those compare as their bits do. A length that overflows
    /// to NaN, of either sign, comes after all numbers.
    #[inline(always)]
    pub(super) fn key(&self) -> u128 {
        // Adding zero makes a negative zero positive.
        u128::from((self.length + 0.0).to_bits()) << 64 | u128::from(self.i) << 32 | u128::from(self.j)
    }

    #[inline(always)]
    pub(super) fn precedes(&self, other: &Self) -> bool {
        self.key() < other.key()
    }
}
