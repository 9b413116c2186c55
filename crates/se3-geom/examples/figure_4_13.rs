//! Thesis Figure 4.13 (Example 4.5): the geodesic of SE(3) between two given frames.

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::path::Path;

use drawing::{Panel, View, gallery_path, write};
use plotters::style::BLACK;
use se3_geom::nalgebra::Vector3;
use se3_geom::{Curve, Geodesic, LieGroup, Manifold, Pose, Se3, So3, So3Group, arc_length};

/// Frames drawn along the geodesic, less one.
pub(crate) const STEPS: u32 = 12;

/// What the figure shows, in the metric with one metre a radian; the thesis prints no distance.
pub(crate) struct Numbers {
    /// A₁ and A₂: (ω, v) = (π/4·(1, 0, 0), (−6, 0, 0)) and (π/2·(1, 1, 0), (0, 6, 2)).
    pub(crate) ends: [Pose; 2],
    /// At even steps along the geodesic.
    pub(crate) poses: Vec<Pose>,
    /// The angle of R₁ᵀR₂.
    pub(crate) angle_rad: f64,
    /// d(A₁, A₂), eq. 4.17.
    pub(crate) distance: f64,
    /// The speed integrated along the geodesic.
    pub(crate) length: f64,
}

/// Eqs. 4.15–4.17 for the frames of Example 4.5.
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let metric = Se3::default();
    let pose = |w: [f64; 3], p: [f64; 3]| Pose::from_parts(Vector3::from(p).into(), So3Group::exp(Vector3::from(w)));
    let start = pose([FRAC_PI_4, 0.0, 0.0], [-6.0, 0.0, 0.0]);
    let end = pose([FRAC_PI_2, FRAC_PI_2, 0.0], [0.0, 6.0, 2.0]);
    let geodesic = Geodesic::between(metric, start, end)?;
    Ok(Numbers {
        ends: [start, end],
        poses: (0..=STEPS).map(|k| geodesic.point(f64::from(k) / f64::from(STEPS))).collect(),
        angle_rad: So3.distance(&start.rotation, &end.rotation),
        distance: metric.distance(&start, &end),
        length: arc_length(&geodesic, &metric)?,
    })
}

/// The frames and the line of their origins.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let view = View::from_angles(-1.1, 0.5);
    let mut panel = Panel::new("Figure 4.13: a geodesic of SE(3)");
    let label = format!("distance {:.4}", numbers.distance);
    panel.line(numbers.poses.iter().map(|pose| view.project(&pose.translation.vector)), BLACK, &label);
    for pose in &numbers.poses {
        panel.frame(&view, pose, 0.8);
    }
    panel.dots(numbers.ends.map(|pose| view.project(&pose.translation.vector)), BLACK);
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    println!("angle between the frames  {:.12} rad", numbers.angle_rad);
    println!("distance (4.17)           {:.12}", numbers.distance);
    println!("length of the geodesic    {:.12}", numbers.length);
    let path = gallery_path("figure_4_13")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
