//! Distances from one point of a gridded surface by front propagation, and shortest paths back to it.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use nalgebra::{Vector2, Vector3};

use crate::surface_grid::{SurfaceGrid, corners};

/// Why there is no distance or no path.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FrontError {
    /// The point is outside the rectangle or in a hole.
    #[error("({x}, {y}) is not on the surface: it is outside the grid or in a hole")]
    OffSurface {
        /// x of the point.
        x: f64,
        /// y of the point.
        y: f64,
    },
    /// The front never came there.
    #[error("no path on the surface leads from the source to ({x}, {y})")]
    Unreached {
        /// x of the point.
        x: f64,
        /// y of the point.
        y: f64,
    },
    /// The map did not lead back to the source.
    #[error("the descent from ({x}, {y}) did not arrive at the source within {steps} steps")]
    Astray {
        /// x of the point.
        x: f64,
        /// y of the point.
        y: f64,
        /// How many steps were taken.
        steps: usize,
    },
}

/// The distance u from a source on a surface z = h(x, y): arrival times of a front that starts there and moves over the surface
/// with unit speed, ∂C/∂t = N (thesis §4.2.1).
///
/// u solves ∇uᵀg⁻¹∇u = 1 with the metric g = I + ∇h∇hᵀ, anisotropic in the plane. A node X takes the least time over the eight
/// triangles that it forms in space with the edges of the cells around it. On an edge with the times u₁, u₂ the front is the
/// circle about the point that has these distances from the edge's ends, unfolded into the triangle's plane (Novotni & Klein
/// 2002): the time of X is its distance from that point if the line crosses the edge, else one over an end.
///
/// Nodes are taken in order of time as in fast marching (Kimmel & Sethian 1998), and **taken again when they improve**: with
/// obtuse triangles one pass is not enough. The result is a fixed point of the update, to rounding. The update is monotone and
/// consistent and its fixed points are bounded, so that they converge to the distance as the grid is refined (Barles &
/// Souganidis 1991). The error is of **first order** in the spacing for a smooth surface; on a plane there is none but rounding.
/// Next to a hole, round which the front bends, it falls more slowly (order 0.7 was measured), and a hole is as large as the cells that
/// have a corner in it; there the length of [`path_from`](Self::path_from) is the better figure.
///
/// ```
/// use se3_geom::{nalgebra::Vector2, DistanceMap, SurfaceGrid};
/// // A plane at 45°: distances are those of space.
/// let slope = SurfaceGrid::sample(Vector2::zeros(), Vector2::new(2.0, 1.0), [9, 5], |x, _| x)?;
/// let map = DistanceMap::from_source(&slope, Vector2::new(0.1, 0.2))?;
/// assert!((map.at(&Vector2::new(1.1, 0.2))? - 2f64.sqrt()).abs() < 1e-12);
/// let path = map.path_from(&Vector2::new(1.9, 0.9))?;
/// assert!((path.last().unwrap() - Vector2::new(0.1, 0.2)).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct DistanceMap<'a> {
    grid: &'a SurfaceGrid,
    source: Vector2<f64>,
    /// The source in grid coordinates.
    source_place: Vector2<f64>,
    source_point: Vector3<f64>,
    /// Infinite where the front has not come.
    times: Vec<f64>,
}

impl<'a> DistanceMap<'a> {
    /// The distances from `source`, which need not be a node: in the cells that touch it they are those of straight lines in
    /// space. O(n log n) for n nodes unless the surface is very rough.
    ///
    /// # Errors
    /// [`FrontError::OffSurface`] where the source is outside the grid or in a hole.
    pub fn from_source(grid: &'a SurfaceGrid, source: Vector2<f64>) -> Result<Self, FrontError> {
        let source_point = grid.embed(&source).ok_or(FrontError::OffSurface { x: source.x, y: source.y })?;
        let [columns, rows] = grid.nodes();
        let times = vec![f64::INFINITY; columns * rows];
        let mut map = Self { grid, source, source_place: grid.to_grid(&source), source_point, times };
        map.propagate();
        Ok(map)
    }

    fn propagate(&mut self) {
        let mut front = BinaryHeap::new();
        let touched: Vec<_> = self.grid.cells_at(&self.source_place).flat_map(corners).collect();
        for node in touched {
            let time = (self.grid.embed_node(node) - self.source_point).norm();
            self.improve(node, time, &mut front);
        }
        while let Some(Reverse(Arrival { time, node })) = front.pop() {
            if time > self.times[self.grid.node_index(node)] {
                continue; // it has come earlier by another way
            }
            for cell in self.grid.cells_at(&place_of(node)) {
                for [a, b] in edges(cell).into_iter().filter(|edge| edge.contains(&node)) {
                    for across in corners(cell).into_iter().filter(|&across| across != a && across != b) {
                        if !shares_cell(self.grid, &place_of(across), &self.source_place) {
                            let (time, _) = self.time_over(&self.grid.embed_node(across), [a, b]);
                            self.improve(across, time, &mut front);
                        }
                    }
                }
            }
        }
    }

    fn improve(&mut self, node: [usize; 2], time: f64, front: &mut BinaryHeap<Reverse<Arrival>>) {
        let known = &mut self.times[self.grid.node_index(node)];
        if time < *known * (1.0 - ROUNDING) {
            *known = time;
            front.push(Reverse(Arrival { time, node }));
        }
    }

    /// The distance of a point from the source, in the unit of the coordinates. Between nodes it is found as at them.
    ///
    /// # Errors
    /// [`FrontError::OffSurface`], and [`FrontError::Unreached`] where holes cut the point off.
    pub fn at(&self, point: &Vector2<f64>) -> Result<f64, FrontError> {
        let place = self.on_surface(point)?;
        let step = self.first_arrival(&place);
        step.map(|step| step.time).ok_or(FrontError::Unreached { x: point.x, y: point.y })
    }

    /// The distance of a node, infinite where the front has not come; `None` outside the grid.
    pub fn at_node(&self, [column, row]: [usize; 2]) -> Option<f64> {
        let [columns, rows] = self.grid.nodes();
        (column < columns && row < rows).then(|| self.times[self.grid.node_index([column, row])])
    }

    /// The shortest path from a point down to the source, by its corners in the plane; one on each grid line that it crosses.
    ///
    /// It descends along −g⁻¹∇u: in each cell straight to where the front came from.
    ///
    /// # Errors
    /// Those of [`at`](Self::at), and [`FrontError::Astray`] where the surface is so rough that the descent finds no end.
    pub fn path_from(&self, point: &Vector2<f64>) -> Result<Vec<Vector2<f64>>, FrontError> {
        let mut place = self.on_surface(point)?;
        let mut path = vec![*point];
        let most_steps = 4 * self.times.len();
        for _ in 0..most_steps {
            place = self.first_arrival(&place).ok_or(FrontError::Unreached { x: point.x, y: point.y })?.from;
            if place == self.source_place {
                path.push(self.source);
                return Ok(path);
            }
            path.push(self.grid.to_plane(&place));
        }
        Err(FrontError::Astray { x: point.x, y: point.y, steps: most_steps })
    }

    fn on_surface(&self, point: &Vector2<f64>) -> Result<Vector2<f64>, FrontError> {
        self.grid.embed(point).ok_or(FrontError::OffSurface { x: point.x, y: point.y })?;
        Ok(self.grid.to_grid(point))
    }

    /// The earliest way to a place over an edge of the cells that it touches, or straight from the source if that touches one of
    /// them too; `None` where the front has come to none of them.
    fn first_arrival(&self, place: &Vector2<f64>) -> Option<Step> {
        let point = self.grid.embed_grid(place);
        if shares_cell(self.grid, place, &self.source_place) {
            return Some(Step { time: (point - self.source_point).norm(), from: self.source_place });
        }
        let mut first: Option<Step> = None;
        for [a, b] in self.grid.cells_at(place).flat_map(edges) {
            let [place_a, place_b] = [a, b].map(place_of);
            // An edge that leads through the place: its ends are ends of other edges.
            if (place_a.x == place.x && place_b.x == place.x) || (place_a.y == place.y && place_b.y == place.y) {
                continue;
            }
            let (time, part) = self.time_over(&point, [a, b]);
            if time < first.as_ref().map_or(f64::INFINITY, |known| known.time) {
                // Along a grid line, so that the coordinate across stays whole.
                first = Some(Step { time, from: place_a + (place_b - place_a) * part });
            }
        }
        first
    }

    fn time_over(&self, point: &Vector3<f64>, edge: [[usize; 2]; 2]) -> (f64, f64) {
        time_over_edge(point, edge.map(|node| (self.grid.embed_node(node), self.times[self.grid.node_index(node)])))
    }
}

/// Improvements below this part are rounding.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// When the front comes to a place, and where from.
struct Step {
    time: f64,
    from: Vector2<f64>,
}

/// When the front comes to `point` over the edge between two points that it passes at given times, and which part of the edge
/// from the first end it crosses.
fn time_over_edge(point: &Vector3<f64>, [(a, time_a), (b, time_b)]: [(Vector3<f64>, f64); 2]) -> (f64, f64) {
    let edge = b - a;
    let length = edge.norm();
    let along = edge.dot(&(point - a)) / length;
    let beyond = (point - a - edge * (along / length)).norm();
    // The source in the plane of the triangle, on the other side of the edge.
    let source_along = 0.5 * (length + (time_a - time_b) * (time_a + time_b) / length);
    let source_before = (time_a * time_a - source_along * source_along).sqrt();
    let crossing = source_along + (along - source_along) * source_before / (source_before + beyond);
    if (0.0..=length).contains(&crossing) {
        return ((along - source_along).hypot(source_before + beyond), crossing / length);
    }
    let over_a = time_a + (point - a).norm();
    let over_b = time_b + (point - b).norm();
    if over_a <= over_b { (over_a, 0.0) } else { (over_b, 1.0) }
}

/// The sides of a cell.
fn edges(cell: [usize; 2]) -> [[[usize; 2]; 2]; 4] {
    let [a, b, c, d] = corners(cell);
    [[a, b], [b, c], [c, d], [d, a]]
}

fn place_of([column, row]: [usize; 2]) -> Vector2<f64> {
    Vector2::new(column as f64, row as f64)
}

fn shares_cell(grid: &SurfaceGrid, a: &Vector2<f64>, b: &Vector2<f64>) -> bool {
    (a - b).amax() <= 1.0 && grid.cells_at(a).any(|cell| grid.cells_at(b).any(|other| other == cell))
}

/// A node that the front has come to, ordered by time.
#[derive(PartialEq)]
struct Arrival {
    time: f64,
    node: [usize; 2],
}

impl Eq for Arrival {}

impl Ord for Arrival {
    fn cmp(&self, other: &Self) -> Ordering {
        self.time.total_cmp(&other.time).then(self.node.cmp(&other.node))
    }
}

impl PartialOrd for Arrival {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
