//! Figures 4.3 to 4.5: fronts from two points of a surface, their distance maps, and two shortest paths between the points. The
//! thesis does not state the surface; here it is a hill, z = 2·exp(−x² − y²), with the points on either side of it.

#[allow(dead_code)]
mod drawing;
#[path = "../tests/surfaces/mod.rs"]
mod surfaces;

use std::error::Error;
use std::path::Path;

use drawing::{Panel, View, gallery_path, shade, write};
use nalgebra::{Vector2, Vector3};
use se3_geom::{DistanceMap, SurfaceGrid, nalgebra};
use surfaces::hill;

pub(crate) const NODES: usize = 161;
const SIDE: f64 = 3.0;
pub(crate) const ENDS: [Vector2<f64>; 2] = [Vector2::new(-2.0, 0.0), Vector2::new(2.0, 0.0)];
/// Azimuth and elevation of the view.
const VIEW: [f64; 2] = [-1.2, 0.8];

pub(crate) struct Numbers {
    /// From P₁ to P₂, read off the map of P₁.
    pub(crate) distance: f64,
    /// Two paths from P₁ to P₂ in space, on the sides y < 0 and y > 0.
    pub(crate) paths: [Vec<Vector3<f64>>; 2],
    pub(crate) lengths: [f64; 2],
    /// Fronts from P₁ at equal intervals of time, in pieces of one cell.
    pub(crate) fronts: Vec<(f64, Vec<[Vector3<f64>; 2]>)>,
}

pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let patch = hill();
    let corner = Vector2::new(SIDE, SIDE);
    let grid = SurfaceGrid::sample(-corner, corner, [NODES, NODES], |x, y| patch.embed(&Vector2::new(x, y)).z)?;
    let [first, second] = ENDS.map(|end| DistanceMap::from_source(&grid, end));
    let (first, second) = (first?, second?);
    let [below, above] = [0..NODES / 2, NODES / 2 + 1..NODES].map(|rows| shortest_over(&grid, [&first, &second], rows));
    let paths = [below?, above?];
    let length = |path: &Vec<Vector3<f64>>| path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let fronts = (1..=10).map(|k| 0.5 * f64::from(k)).map(|time| (time, front(&grid, &first, time))).collect();
    Ok(Numbers { distance: first.at(&ENDS[1])?, lengths: [0, 1].map(|side| length(&paths[side])), paths, fronts })
}

/// The sum of both maps is least along the shortest paths. So: its least node on the line halfway, and down both maps from there.
fn shortest_over(
    grid: &SurfaceGrid,
    [first, second]: [&DistanceMap<'_>; 2],
    rows: std::ops::Range<usize>,
) -> Result<Vec<Vector3<f64>>, Box<dyn Error>> {
    let sum = |row: usize| [first, second].iter().filter_map(|map| map.at_node([NODES / 2, row])).sum::<f64>();
    let row = rows.min_by(|&a, &b| sum(a).total_cmp(&sum(b))).ok_or("no rows")?;
    let halfway = grid.node_place([NODES / 2, row]);
    let mut path = first.path_from(&halfway)?;
    path.reverse();
    path.extend(second.path_from(&halfway)?.into_iter().skip(1));
    Ok(path.iter().filter_map(|place| grid.embed(place)).collect())
}

/// Where the map has this value, by linear interpolation on two triangles a cell.
fn front(grid: &SurfaceGrid, map: &DistanceMap<'_>, time: f64) -> Vec<[Vector3<f64>; 2]> {
    let mut pieces = Vec::new();
    let [columns, rows] = grid.nodes();
    for (column, row) in (0..columns - 1).flat_map(|column| (0..rows - 1).map(move |row| (column, row))) {
        let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| [column + i, row + j]);
        for triangle in [[a, b, c], [a, c, d]] {
            let crossing = |[from, to]: [[usize; 2]; 2]| {
                let (before, after) = (map.at_node(from)? - time, map.at_node(to)? - time);
                let part = before / (before - after);
                let [from, to] = [from, to].map(|node| grid.node_place(node));
                ((before < 0.0) != (after < 0.0)).then(|| grid.embed(&(from + (to - from) * part)))?
            };
            let sides = [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|end| triangle[end]));
            let crossings: Vec<_> = sides.into_iter().filter_map(crossing).collect();
            if let [start, end] = crossings[..] {
                pieces.push([start, end]);
            }
        }
    }
    pieces
}

pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let patch = hill();
    let view = View::from_angles(VIEW[0], VIEW[1]);
    let above = |point: &Vector3<f64>| point.xy();
    let aslant = |point: &Vector3<f64>| view.project(point);
    let mut map =
        Panel::new(format!("Figure 4.5: fronts from P1 and shortest paths, distance {:.4}", numbers.distance));
    let mut surface = Panel::new(format!("the paths: {:.4} and {:.4}", numbers.lengths[0], numbers.lengths[1]));
    surface.wireframe(&view, |x, y| patch.embed(&Vector2::new(x, y)), [[-SIDE, SIDE]; 2], 31);
    for (time, pieces) in &numbers.fronts {
        for piece in pieces {
            map.thin(piece.iter().map(above), shade(0.3 + 0.1 * time));
        }
    }
    for path in &numbers.paths {
        map.line(path.iter().map(above), shade(0.0), "");
        surface.line(path.iter().map(aslant), shade(0.0), "");
    }
    for (end, name) in ENDS.iter().zip(["P1", "P2"]) {
        map.label(*end, name);
        surface.label(aslant(&patch.embed(end)), name);
    }
    write(&[map, surface], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    let path = gallery_path("figure_4_5")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    println!("distance {:.6}, paths {:.6} and {:.6}", numbers.distance, numbers.lengths[0], numbers.lengths[1]);
    Ok(())
}
