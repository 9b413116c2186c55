//! Thesis Figure 4.11: a curve in SE(2) beside the geodesic between its ends. The curve is the straight line of the group, a
//! turn about a fixed centre; the geodesic turns as evenly, but its origin keeps to a straight line.

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::path::Path;

use drawing::{Panel, gallery_path, write};
use plotters::style::{BLACK, MAGENTA};
use se3_geom::nalgebra::{Isometry2, Vector2};
use se3_geom::{LieGroup, LogError, Manifold, Se2, Se2Group};

/// Pieces of the polygons.
pub(crate) const PIECES: u32 = 100;
/// A frame drawn every so many pieces.
const FRAME_EVERY: usize = 10;

/// What the figure shows, in the metric with one metre a radian.
pub(crate) struct Numbers {
    /// A₁ and A₂; the thesis states none.
    pub(crate) ends: [Isometry2<f64>; 2],
    /// Along the turn.
    pub(crate) curve: Vec<Isometry2<f64>>,
    /// Along the geodesic.
    pub(crate) geodesic: Vec<Isometry2<f64>>,
    /// Sums of the distances of successive poses.
    pub(crate) curve_length: f64,
    /// As for the curve.
    pub(crate) geodesic_length: f64,
    /// d(A₁, A₂), eq. 4.10.
    pub(crate) distance: f64,
}

/// Both curves between a pose at the origin and one 5 m away, turned by 2 rad.
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let metric = Se2::default();
    let ends = [Isometry2::identity(), Isometry2::new(Vector2::new(4.0, 3.0), 2.0)];
    let [start, end] = &ends;
    let twist = Se2Group::log(&Se2Group::compose(&Se2Group::inverse(start), end))?;
    let at = |k: u32| f64::from(k) / f64::from(PIECES);
    let curve: Vec<_> = (0..=PIECES).map(|k| Se2Group::compose(start, &Se2Group::exp(twist * at(k)))).collect();
    let geodesic = (0..=PIECES).map(|k| metric.geodesic(start, end, at(k))).collect::<Result<Vec<_>, LogError>>()?;
    let length = |poses: &[Isometry2<f64>]| poses.windows(2).map(|p| metric.distance(&p[0], &p[1])).sum();
    Ok(Numbers {
        curve_length: length(&curve),
        geodesic_length: length(&geodesic),
        distance: metric.distance(start, end),
        ends,
        curve,
        geodesic,
    })
}

/// Origins as lines, frames along them.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let mut panel = Panel::new("Figure 4.11: a curve and the geodesic in SE(2)");
    for (poses, colour, name, length) in [
        (&numbers.curve, MAGENTA, "curve", numbers.curve_length),
        (&numbers.geodesic, BLACK, "geodesic", numbers.geodesic_length),
    ] {
        panel.line(poses.iter().map(|pose| pose.translation.vector), colour, &format!("{name}: {length:.4}"));
        for pose in poses.iter().step_by(FRAME_EVERY) {
            panel.planar_frame(pose, 0.5);
        }
    }
    panel.dots(numbers.ends.map(|pose| pose.translation.vector), BLACK);
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    println!("distance of the ends    {:.12}", numbers.distance);
    println!("length of the geodesic  {:.12}", numbers.geodesic_length);
    println!("length of the curve     {:.12}", numbers.curve_length);
    let path = gallery_path("figure_4_11")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
