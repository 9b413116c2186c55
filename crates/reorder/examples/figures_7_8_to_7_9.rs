//! Thesis Figures 7.8 and 7.9: instances of a circular object that moves, turns and grows, put in order through the similarities
//! of the plane with α = 10 and β = 1 (eq. 7.4, with the square that its last term lacks). The curve is open.

#[allow(dead_code)]
#[path = "../../se3-geom/examples/drawing/mod.rs"]
mod drawing;
#[path = "shuffled/mod.rs"]
mod shuffled;

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use drawing::{Panel, gallery_path, write};
use plotters::style::{BLACK, BLUE, RED};
use reorder::{Options, Ordering, order};
use se3_geom::nalgebra::{Point2, Similarity2, Vector2};
use se3_geom::{Manifold, Sim2};
use shuffled::{follows, shuffle};

const INSTANCES: usize = 24;

/// The experiment.
pub(crate) struct Numbers {
    /// The instances, shuffled.
    pub(crate) instances: Vec<Similarity2<f64>>,
    /// Their recovered order.
    pub(crate) ordering: Ordering,
    /// Whether that is the order of the motion, or its reverse.
    pub(crate) recovered: bool,
    /// Greatest distance of successive instances under eq. 7.4.
    pub(crate) max_gap: f64,
}

/// The object at time t ∈ \[0, 1\]: along an S, one turn, three times as large in the middle.
fn instance(t: f64) -> Similarity2<f64> {
    let position = Vector2::new(10.0 * t, 2.0 * (TAU * t).sin());
    Similarity2::new(position, TAU * t, (1.1 * (0.5 * TAU * t).sin()).exp() * 0.4)
}

/// Shuffles and orders.
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let metric = Sim2::with_weights(10.0, 1.0).ok_or("no such metric")?;
    let places = shuffle(INSTANCES, 78);
    let time = |k: usize| k as f64 / (INSTANCES - 1) as f64;
    let instances: Vec<_> = places.iter().map(|&k| instance(time(k))).collect();
    let ordering = order(&metric, &instances, &Options::default())?;
    let recovered = follows(&ordering, &places, false);
    let gap = |k: usize| metric.distance(&instance(time(k)), &instance(time(k + 1)));
    let max_gap = (0..INSTANCES - 1).map(gap).fold(0.0, f64::max);
    Ok(Numbers { instances, ordering, recovered, max_gap })
}

/// The object as a circle with a spoke, before and after.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let circle = |object: &Similarity2<f64>| {
        let rim = (0..=40).map(|k| TAU * f64::from(k) / 40.0).map(|a| Point2::new(a.cos(), a.sin()));
        let spoke = std::iter::once(Point2::origin());
        let points: Vec<_> = spoke.chain(rim).map(|p| object.transform_point(&p).coords).collect();
        points
    };
    let mut shown = Panel::new("Figure 7.8: instances");
    let mut ordered = Panel::new(format!("Figure 7.9: their order, {:?}", numbers.ordering.verdict));
    for object in &numbers.instances {
        shown.line(circle(object), BLACK, "");
        ordered.line(circle(object), BLUE, "");
    }
    let middle = |&row: &usize| numbers.instances[row].isometry.translation.vector;
    ordered.line(numbers.ordering.order.iter().map(middle), RED, "recovered order");
    write(&[shown, ordered], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    println!("greatest gap {:.4}, injectivity radius {:.4}", numbers.max_gap, 10f64.sqrt() * std::f64::consts::PI);
    println!("order {:?}: recovered {}, {:?}", numbers.ordering.order, numbers.recovered, numbers.ordering.verdict);
    let path = gallery_path("figures_7_8_to_7_9")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
