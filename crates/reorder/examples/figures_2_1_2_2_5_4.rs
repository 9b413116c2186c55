//! Thesis Figures 2.1, 2.2 and 5.4: what no method can order, and what the space around a curve does to its sampling.
//!
//! Figure 2.1 is a corner and Figure 2.2 two calm stretches side by side, both sampled too sparsely: the nearest neighbour is on
//! the other side. The minimum spanning tree then comes out wrong, and says so; with enough samples it is right. Figure 5.4 is one circle, in
//! space and on spheres: the same samples are denser for the curve where the surface bends along with it.

#[allow(dead_code)]
#[path = "../../se3-geom/examples/drawing/mod.rs"]
mod drawing;
#[path = "shuffled/mod.rs"]
mod shuffled;

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use drawing::{Panel, gallery_path, write};
use plotters::style::{BLACK, GREEN, RED};
use reorder::{Options, Ordering, Repair, order};
use se3_geom::nalgebra::{Vector2, Vector3};
use se3_geom::{Manifold, R2, R3, Sphere};
use shuffled::{follows, shuffle};

/// A sample and what was made of it.
pub(crate) struct Sample {
    pub(crate) name: &'static str,
    pub(crate) points: Vec<Vector2<f64>>,
    pub(crate) ordering: Ordering,
    pub(crate) recovered: bool,
}

/// The experiment.
pub(crate) struct Numbers {
    /// Figure 2.1 sparse and dense, Figure 2.2 sparse and dense.
    pub(crate) samples: Vec<Sample>,
    /// ε = gap/(2·reach) of one circle of radius sin θ on the unit sphere from 24 samples: θ, in space, on the sphere.
    pub(crate) circles: Vec<(f64, Option<f64>, Option<f64>)>,
}

/// A hairpin: down one side, round a corner of radius 0.1, up the other; by arc length from −1 to 1.
fn corner(s: f64) -> Vector2<f64> {
    const RADIUS: f64 = 0.1;
    let half_turn = 0.5 * std::f64::consts::PI * RADIUS;
    let along = s.abs() - half_turn;
    let (sine, cosine) = (s / RADIUS).sin_cos();
    if along <= 0.0 { Vector2::new(RADIUS * sine, -RADIUS * cosine) } else { Vector2::new(RADIUS.copysign(s), along) }
}

/// A flat loop: two stretches 0.2 apart that hardly bend.
fn calm(u: f64) -> Vector2<f64> {
    let (sine, cosine) = (TAU * u).sin_cos();
    Vector2::new(cosine, 0.1 * sine)
}

fn sample(name: &'static str, along: Vec<Vector2<f64>>, closed: bool) -> Result<Sample, Box<dyn Error>> {
    let places = shuffle(along.len(), 21);
    let points: Vec<_> = places.iter().map(|&k| along[k]).collect();
    let ordering = order(&R2::default(), &points, &Options { repair: Repair::Off, ..Options::default() })?;
    let recovered = follows(&ordering, &places, closed);
    Ok(Sample { name, points, ordering, recovered })
}

fn epsilon_on<M: Manifold>(manifold: &M, points: &[M::Point]) -> Result<Option<f64>, Box<dyn Error>> {
    Ok(order(manifold, points, &Options::default())?.certificate.epsilon)
}

/// Samples, orders, and measures the circles.
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let hairpin = |n: usize| (0..n).map(|k| corner(-1.0 + 2.0 * k as f64 / (n - 1) as f64)).collect();
    let flat_loop = |n: usize| (0..n).map(|k| calm((k as f64 + 0.25) / n as f64)).collect();
    let samples = vec![
        sample("Figure 2.1: a corner, 8 samples", hairpin(8), false)?,
        sample("a corner, 80 samples", hairpin(80), false)?,
        sample("Figure 2.2: two calm stretches, 12 samples", flat_loop(12), true)?,
        sample("two calm stretches, 240 samples", flat_loop(240), true)?,
    ];
    let circle = |theta: f64| -> Result<_, Box<dyn Error>> {
        let point = |k: usize| {
            let (sine, cosine) = (TAU * k as f64 / 24.0).sin_cos();
            Vector3::new(theta.sin() * cosine, theta.sin() * sine, theta.cos())
        };
        let points: Vec<_> = shuffle(24, 54).into_iter().map(point).collect();
        Ok((theta, epsilon_on(&R3::default(), &points)?, epsilon_on(&Sphere, &points)?))
    };
    let thetas = [0.3, 0.8, 1.2, 0.25 * TAU];
    Ok(Numbers { samples, circles: thetas.into_iter().map(circle).collect::<Result<_, _>>()? })
}

/// The four samples in the plane with their orders: green where right, red where wrong.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let panel = |sample: &Sample| {
        let mut panel = Panel::new(sample.name);
        let colour = if sample.recovered { GREEN } else { RED };
        let verdict = format!("{:?}", sample.ordering.verdict).to_lowercase();
        panel.line(sample.ordering.order.iter().map(|&row| sample.points[row]), colour, &verdict);
        panel.dots(sample.points.iter().copied(), BLACK);
        panel
    };
    write(&numbers.samples.iter().map(panel).collect::<Vec<_>>(), path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    for sample in &numbers.samples {
        let Ordering { verdict, doubts, .. } = &sample.ordering;
        println!("{}: recovered {}, {verdict:?}, {} doubts", sample.name, sample.recovered, doubts.len());
    }
    for (theta, in_space, on_sphere) in &numbers.circles {
        println!("circle of radius sin {theta:.2}: epsilon {in_space:.3?} in space, {on_sphere:.3?} on the sphere");
    }
    let path = gallery_path("figures_2_1_2_2_5_4")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
