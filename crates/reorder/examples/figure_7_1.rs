//! Thesis Figure 7.1: two curves on the unit sphere, recovered from shuffled samples. The wavier one needs more of them.

#[allow(dead_code)]
#[path = "../../se3-geom/examples/drawing/mod.rs"]
mod drawing;
#[path = "shuffled/mod.rs"]
mod shuffled;

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use drawing::{Panel, View, gallery_path, write};
use plotters::style::{BLACK, RED, RGBColor};
use reorder::{Options, Ordering, order};
use se3_geom::Sphere;
use se3_geom::nalgebra::Vector3;
use shuffled::{follows, shuffle};

const GREY: RGBColor = RGBColor(200, 200, 200);

/// One curve: where its samples are, shuffled, and what was made of them.
pub(crate) struct Curve {
    /// In the order in which they were drawn.
    pub(crate) points: Vec<Vector3<f64>>,
    /// The recovered order.
    pub(crate) ordering: Ordering,
    /// Whether that is the order along the curve.
    pub(crate) recovered: bool,
}

/// A curve that waves about the equator: colatitude π/2 + ¼·sin(waves·longitude), sampled evenly in longitude.
fn wave(waves: f64, longitude: f64) -> Vector3<f64> {
    let (latitude, (sine, cosine)) = (0.25 * (waves * longitude).sin(), longitude.sin_cos());
    Vector3::new(latitude.cos() * cosine, latitude.cos() * sine, latitude.sin())
}

/// The curve of three waves from 60 samples, and that of ten waves from `samples`.
pub(crate) fn compute(waves: f64, samples: usize) -> Result<Curve, Box<dyn Error>> {
    let along: Vec<_> = (0..samples).map(|k| wave(waves, TAU * k as f64 / samples as f64)).collect();
    let places = shuffle(samples, 71);
    let points: Vec<_> = places.iter().map(|&k| along[k]).collect();
    let ordering = order(&Sphere, &points, &Options::default())?;
    let recovered = follows(&ordering, &places, true);
    Ok(Curve { points, ordering, recovered })
}

/// The hemisphere's rim, the samples, and the order as a line.
pub(crate) fn draw(curves: &[Curve], path: &Path) -> Result<(), Box<dyn Error>> {
    let view = View::from_angles(0.6, 0.7);
    let panel = |curve: &Curve| {
        let title = format!("{} samples, {:?}", curve.points.len(), curve.ordering.verdict);
        let mut panel = Panel::new(title);
        for k in 0..12 {
            let (sine, cosine) = (TAU * f64::from(k) / 24.0).sin_cos();
            let meridian = (0..=60).map(|i| TAU * f64::from(i) / 60.0);
            let point = |t: f64| Vector3::new(t.sin() * cosine, t.sin() * sine, t.cos());
            panel.line(meridian.map(|t| view.project(&point(t))), GREY, "");
        }
        let closed = curve.ordering.order.iter().chain(curve.ordering.order.first());
        panel.line(closed.map(|&row| view.project(&curve.points[row])), BLACK, "recovered order");
        panel.dots(curve.points.iter().map(|p| view.project(p)), RED);
        panel
    };
    write(&curves.iter().map(panel).collect::<Vec<_>>(), path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let curves = [compute(3.0, 60)?, compute(10.0, 160)?];
    for curve in &curves {
        let (n, verdict) = (curve.points.len(), curve.ordering.verdict);
        println!("{n:4} samples: recovered {}, verdict {verdict:?}", curve.recovered);
    }
    let path = gallery_path("figure_7_1")?;
    draw(&curves, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
