//! The exact minimum spanning tree, by Prim's algorithm on distances computed as they are needed.

use petgraph::graph::{NodeIndex, UnGraph};
use se3_geom::Manifold;

use crate::error::OrderError;

/// A tree: node k stands for input row `tree[k]`, an edge for the distance of its ends.
pub type Tree = UnGraph<usize, f64>;

/// Prim's candidate edge. Compared as (length, i, j) with i < j: a strict total order, under which the minimum spanning tree
/// is unique even where lengths tie.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    length: f64,
    i: usize,
    j: usize,
}

impl Edge {
    /// Always measured from the smaller row, so that the tree does not depend on a metric being symmetric to the last bit.
    fn between<M: Manifold>(manifold: &M, points: &[M::Point], a: usize, b: usize) -> Self {
        let (i, j) = (a.min(b), a.max(b));
        Self { length: manifold.distance(&points[i], &points[j]), i, j }
    }
    fn precedes(&self, other: &Self) -> bool {
        // A distance that overflows to NaN precedes nothing and is preceded by nothing: sooner or later it is joined, and refused.
        self.length < other.length || (self.length == other.length && (self.i, self.j) < (other.i, other.j))
    }
}

/// The minimum spanning tree of the points under the manifold's own distance: O(n²) time, O(n) memory.
///
/// Node k is input row k. Of several minimum trees it is the one that is least when edges are compared by
/// (length, smaller row, greater row).
///
/// # Errors
/// [`OrderError::TooFewPoints`] for no point at all, [`OrderError::NonFinite`], [`OrderError::DistanceOverflow`].
pub fn minimum_spanning_tree<M: Manifold>(manifold: &M, points: &[M::Point]) -> Result<Tree, OrderError> {
    if points.is_empty() {
        return Err(OrderError::TooFewPoints { count: 0, needed: 1 });
    }
    if let Some(index) = points.iter().position(|p| !manifold.is_finite(p)) {
        return Err(OrderError::NonFinite { index });
    }
    let mut tree = Tree::with_capacity(points.len(), points.len() - 1);
    for row in 0..points.len() {
        tree.add_node(row);
    }
    // The shortest edge from each point outside to the tree, and which of them is the shortest of all.
    let mut outside: Vec<(usize, Edge)> =
        (1..points.len()).map(|v| (v, Edge::between(manifold, points, 0, v))).collect();
    let mut nearest = (0..outside.len()).reduce(|a, b| if outside[b].1.precedes(&outside[a].1) { b } else { a });
    while let Some(k) = nearest.take() {
        let (joined, edge) = outside.swap_remove(k);
        if !edge.length.is_finite() {
            return Err(OrderError::DistanceOverflow { at: [edge.i, edge.j] });
        }
        tree.add_edge(NodeIndex::new(edge.i), NodeIndex::new(edge.j), edge.length);
        let mut shortest = None;
        for (k, (v, best)) in outside.iter_mut().enumerate() {
            let candidate = Edge::between(manifold, points, joined, *v);
            if candidate.precedes(best) {
                *best = candidate;
            }
            if shortest.is_none_or(|shortest| best.precedes(&shortest)) {
                (shortest, nearest) = (Some(*best), Some(k));
            }
        }
    }
    Ok(tree)
}
