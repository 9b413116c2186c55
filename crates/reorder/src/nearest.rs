//! The nearest-neighbour chain.

use se3_geom::Manifold;

/// From `start` always on to the nearest point that was not visited yet; of equally near ones the smaller row. Empty if
/// there is no such start.
///
/// For comparison only: from an arbitrary point of a loop it is right, but from within an arc it runs to one end and jumps back.
/// O(n²) time, O(n) memory.
pub fn nearest_chain<M: Manifold>(manifold: &M, points: &[M::Point], start: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..points.len()).filter(|&row| row != start).collect();
    let mut chain: Vec<usize> = points.get(start).map(|_| start).into_iter().collect();
    while let Some(&last) = chain.last() {
        let distance = |row: usize| manifold.distance(&points[last], &points[row]);
        let nearest = (0..left.len()).map(|k| (k, distance(left[k]))).min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((k, _)) = nearest else { break };
        // Keeps the rest ascending, so that the first of equals has the smaller row.
        chain.push(left.remove(k));
    }
    chain
}
