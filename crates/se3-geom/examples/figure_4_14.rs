//! Thesis Figure 4.14: a circular object carried along a curve of planar similarities. The curve is the straight line of the
//! group Sim(2), A₁·exp(tξ), so that the object's centre runs on a logarithmic spiral about the one point that stays.

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::f64::consts::{LN_2, PI};
use std::path::Path;

use drawing::{Panel, gallery_path, write};
use plotters::style::{BLACK, BLUE, MAGENTA};
use se3_geom::nalgebra::{Similarity2, Vector2};
use se3_geom::{LieGroup, Manifold, Sim2, Sim2Group, SimilarityTwist};

/// Per unit of time: λ̇ = ln 2 doubles the object, θ̇ turns it by three quarters of a turn.
pub(crate) const TWIST: ([f64; 2], f64, f64) = ([6.0, 0.0], 1.5 * PI, LN_2);
/// Instances drawn, less one; points on a circle.
pub(crate) const STEPS: u32 = 8;
const CIRCLE: u32 = 72;
/// Points of the centre's path.
const PATH: u32 = 200;

/// What the figure shows; the thesis states no numbers.
pub(crate) struct Numbers {
    /// The similarities at even steps of time from 0 to 1.
    pub(crate) instances: Vec<Similarity2<f64>>,
    /// The images of the unit circle under them.
    pub(crate) circles: Vec<Vec<Vector2<f64>>>,
    /// The path of the centre.
    pub(crate) path: Vec<Vector2<f64>>,
    /// Distances of successive instances, eq. 4.21 with the square that its last term lacks, α = 10 and β = 1 (§7.4).
    pub(crate) distances: Vec<f64>,
}

/// The instances, and the object under each.
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let metric = Sim2::with_weights(10.0, 1.0).ok_or("positive weights")?;
    let twist = SimilarityTwist::new(TWIST.0.into(), TWIST.1, TWIST.2);
    let at = |k: u32, of: u32| Sim2Group::exp(twist * (f64::from(k) / f64::from(of)));
    let instances: Vec<_> = (0..=STEPS).map(|k| at(k, STEPS)).collect();
    let on_circle = |k: u32| {
        let (sine, cosine) = (2.0 * PI * f64::from(k) / f64::from(CIRCLE)).sin_cos();
        Vector2::new(cosine, sine)
    };
    Ok(Numbers {
        circles: instances.iter().map(|a| (0..=CIRCLE).map(|k| Sim2Group::act(a, &on_circle(k))).collect()).collect(),
        path: (0..=PATH).map(|k| Sim2Group::act(&at(k, PATH), &Vector2::zeros())).collect(),
        distances: instances.windows(2).map(|a| metric.distance(&a[0], &a[1])).collect(),
        instances,
    })
}

/// The object at every step with a spoke that shows how it has turned.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let mut panel = Panel::new("Figure 4.14: a circle moved, turned and scaled");
    panel.line(numbers.path.iter().copied(), MAGENTA, "centre");
    for (circle, instance) in numbers.circles.iter().zip(&numbers.instances) {
        panel.line(circle.iter().copied(), BLUE, "");
        panel.line([instance.isometry.translation.vector, circle[0]], BLACK, "");
    }
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    for (k, instance) in numbers.instances.iter().enumerate() {
        let centre = instance.isometry.translation.vector;
        let (scale, angle) = (instance.scaling(), instance.isometry.rotation.angle());
        println!("instance {k}: scale {scale:.6}, angle {angle:+.6} rad, centre ({:+.6}, {:+.6})", centre.x, centre.y);
    }
    println!("distances of successive instances {:.6?}", numbers.distances);
    let path = gallery_path("figure_4_14")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
