//! The order of edges.

use std::cmp::Ordering;

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

    /// A length that overflows to NaN comes after all numbers.
    #[inline(always)]
    pub(super) fn order(&self, other: &Self) -> Ordering {
        self.length.total_cmp(&other.length).then_with(|| (self.i, self.j).cmp(&(other.i, other.j)))
    }

    #[inline(always)]
    pub(super) fn precedes(&self, other: &Self) -> bool {
        self.order(other).is_lt()
    }
}
