//! NN-CRUST on any manifold.

use se3_geom::Manifold;

use crate::drawing::Drawing;

/// The edges that both of their ends draw, where a point draws one to its nearest neighbour and one to the nearest of the
/// points on the other side, more than 90° from the first by `log` at the point (T. K. Dey, P. Kumar, *A simple provable algorithm
/// for curve reconstruction*, 1999).
///
/// In ℝᵈ these are the edges of a closed curve if every point of it has a sample within 0.66 times its distance to the medial axis
/// (H. B. Bjerkevik, arXiv 2112.03656); then every point draws its two neighbours, and asking both ends changes nothing. At the ends of
/// an arc it keeps out the edge across.
///
/// Equal points must be merged before: each would be the other's nearest. O(n²) time, O(n) memory.
pub fn nn_crust<M: Manifold>(manifold: &M, points: &[M::Point]) -> Drawing {
    let drawn: Vec<[Option<usize>; 2]> = (0..points.len()).map(|row| neighbours(manifold, points, row)).collect();
    let draws = |row: usize, other: usize| drawn[row].contains(&Some(other));
    let edges = (0..points.len()).flat_map(|row| drawn[row].into_iter().flatten().map(move |other| [row, other]));
    Drawing::new(points.len(), edges.filter(|&[a, b]| draws(b, a)))
}

/// The nearest point, and the nearest one on the other side. Of equally near ones the smaller row.
fn neighbours<M: Manifold>(manifold: &M, points: &[M::Point], row: usize) -> [Option<usize>; 2] {
    let p = &points[row];
    let distances: Vec<f64> = points.iter().map(|q| manifold.distance(p, q)).collect();
    let others = (0..points.len()).filter(|&other| other != row);
    let Some(nearest) = others.clone().min_by(|&a, &b| distances[a].total_cmp(&distances[b])) else { return [None; 2] };
    let Ok(toward) = manifold.log(p, &points[nearest]) else { return [Some(nearest), None] };
    let mut across: Option<usize> = None;
    for other in others {
        let nearer = across.is_none_or(|best| distances[other] < distances[best]);
        // Nobody has a direction on the cut locus.
        if nearer && manifold.log(p, &points[other]).is_ok_and(|v| manifold.inner(p, toward, v) < 0.0) {
            across = Some(other);
        }
    }
    [Some(nearest), across]
}
