//! CRUST in the plane.

use se3_geom::nalgebra::Vector2;
use spade::{DelaunayTriangulation, HasPosition, InsertionError, Point2, Triangulation};

use crate::drawing::Drawing;

/// A sample with its row, or a vertex of the samples' Voronoi diagram.
struct Site {
    position: Point2<f64>,
    row: Option<usize>,
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// Voronoi vertices farther out than this many times the extent of the samples are left out: they stand for points on a line, and
/// no circle through two samples that must stay empty reaches them.
const FARTHEST: f64 = 1e6;

/// The Delaunay edges between samples in the triangulation of the samples and the vertices of their Voronoi diagram (N. Amenta,
/// M. Bern, D. Eppstein, *The Crust and the β-Skeleton*, 1998): those that have a circle through both ends which is empty of samples
/// and of the medial axis, as far as Voronoi vertices show it.
///
/// On a smooth closed curve where every point has a sample within 0.252 times its distance to the medial axis, these are exactly
/// the edges between consecutive samples. O(n log n). Of equal points only the last has edges.
///
/// # Errors
/// [`InsertionError`]: a coordinate is NaN, infinite, or beyond what the exact predicates can handle (1e-43 to 1e60).
pub fn crust(points: &[Vector2<f64>]) -> Result<Drawing, InsertionError> {
    let mut samples = DelaunayTriangulation::<Site>::new();
    for (row, p) in points.iter().enumerate() {
        samples.insert(Site { position: Point2::new(p.x, p.y), row: Some(row) })?;
    }
    let (low, high) =
        points.iter().fold((Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY)), |(low, high), p| {
            (low.inf(p), high.sup(p))
        });
    let (centre, extent) = (0.5 * (low + high), (high - low).norm());
    let near = |v: &Point2<f64>| (Vector2::new(v.x, v.y) - centre).norm() < FARTHEST * extent;
    let voronoi: Vec<_> = samples.inner_faces().map(|face| face.circumcenter()).filter(near).collect();
    let mut all = samples;
    for position in voronoi {
        // A vertex that falls on a sample must not take its place.
        if all.locate_vertex(position).is_none() {
            all.insert(Site { position, row: None })?;
        }
    }
    let ends = all.undirected_edges().map(|edge| edge.vertices().map(|vertex| vertex.data().row));
    let edges = ends.filter_map(|[a, b]| Some([a?, b?]));
    Ok(Drawing::new(points.len(), edges))
}
