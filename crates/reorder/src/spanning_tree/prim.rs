//! Prim's algorithm on distances computed as they are needed.

use se3_geom::Manifold;

use super::edge::Edge;

/// The edges of the minimum spanning tree as pairs of rows: O(n²) time, O(n) memory, any distance.
pub(super) fn spanning_pairs<M: Manifold>(manifold: &M, points: &[M::Point]) -> Vec<[u32; 2]> {
    let rows = 0..points.len() as u32;
    let mut pairs = Vec::with_capacity(points.len());
    // The shortest edge from each point outside to the tree, and which of them is the shortest of all.
    let mut outside: Vec<(u32, Edge)> = rows.skip(1).map(|v| (v, Edge::between(manifold, points, 0, v))).collect();
    let mut nearest = (0..outside.len()).reduce(|a, b| if outside[b].1.precedes(&outside[a].1) { b } else { a });
    while let Some(k) = nearest.take() {
        let (joined, edge) = outside.swap_remove(k);
        pairs.push([edge.i, edge.j]);
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
    pairs
}
