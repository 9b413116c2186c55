//! The exact minimum spanning tree under the manifold's own distance.
//!
//! Two algorithms build the same tree: [`prim`], dense, for any distance and for few points, and [`boruvka`] on a search tree
//! over the coordinates of the manifold's embedding, for many.

mod boruvka;
mod candidates;
mod chord;
mod coordinates;
mod distinct;
mod edge;
mod foreign;
mod kd_tree;
mod nearest;
mod prim;
#[cfg(test)]
mod tests;
mod traversal;
mod vectorised;

use petgraph::graph::{NodeIndex, UnGraph};
use petgraph::unionfind::UnionFind;
use se3_geom::Manifold;

use crate::equality::Equality;
use crate::error::OrderError;
use coordinates::Coordinates;
use edge::Edge;

/// A tree: node k stands for input row `tree[k]`, an edge for the distance of its ends.
pub type Tree = UnGraph<usize, f64>;

/// Up to so many points the dense algorithm is the faster one.
const FEW: usize = 64;
/// No longer distance has lost digits by underflow, at any weight that is used.
const SUSPICIOUSLY_SHORT: f64 = 1e-100;

/// The minimum spanning tree of the points under the manifold's own distance.
///
/// Node k is input row k; edges ascend by (length, smaller row, greater row). Of several minimum trees it is the one that is
/// least in that order, up to the rounding of lengths. Takes O(n) memory, and on a manifold with an
/// [`embedding`](Manifold::embedding) about O(n log n) time on the threads of the current `rayon` pool, with one answer for
/// any number of them; O(n²) time where a distance has no such form.
///
/// # Errors
/// [`OrderError::TooFewPoints`] for no point at all, [`OrderError::NonFinite`], [`OrderError::DistanceOverflow`],
/// [`OrderError::DistanceUnderflow`].
pub fn minimum_spanning_tree<M: Manifold>(manifold: &M, points: &[M::Point]) -> Result<Tree, OrderError> {
    if points.is_empty() {
        return Err(OrderError::TooFewPoints { count: 0, needed: 1 });
    }
    if let Some(index) = points.iter().position(|p| !manifold.is_finite(p)) {
        return Err(OrderError::NonFinite { index });
    }
    let coordinates = if points.len() > FEW { Coordinates::of(manifold, points) } else { None };
    let pairs = match coordinates {
        Some(coordinates) => coordinates.spanning_pairs(),
        None => prim::spanning_pairs(manifold, points),
    };
    if pairs.len() + 1 < points.len() {
        return Err(OrderError::DistanceOverflow { at: [0, first_row_apart(points.len(), &pairs)] });
    }
    let mut edges: Vec<_> = pairs.iter().map(|&[a, b]| Edge::between(manifold, points, a, b)).collect();
    edges.sort_unstable_by_key(Edge::key);
    // Lengths that are no number come last.
    if let Some(edge) = edges.iter().find(|edge| !edge.length.is_finite()) {
        return Err(OrderError::DistanceOverflow { at: [edge.i as usize, edge.j as usize] });
    }
    let mut equality = Equality::new(manifold);
    let shortest = edges.iter().take_while(|edge| edge.length < SUSPICIOUSLY_SHORT);
    let lost = shortest.map(|edge| [edge.i as usize, edge.j as usize]);
    if let Some(at) = lost.into_iter().find(|&[i, j]| equality.underflows(&points[i], &points[j])) {
        return Err(OrderError::DistanceUnderflow { at });
    }
    let mut tree = Tree::with_capacity(points.len(), edges.len());
    for row in 0..points.len() {
        tree.add_node(row);
    }
    for edge in edges {
        tree.add_edge(NodeIndex::new(edge.i as usize), NodeIndex::new(edge.j as usize), edge.length);
    }
    Ok(tree)
}

/// The first row that the edges do not join to row 0.
fn first_row_apart(count: usize, pairs: &[[u32; 2]]) -> usize {
    let mut joined = UnionFind::<usize>::new(count);
    for [a, b] in pairs {
        joined.union(*a as usize, *b as usize);
    }
    (0..count).find(|&row| !joined.equiv(0, row)).unwrap_or(0)
}
