//! Figure 4.1: curvature flow straightens a curve between P(0, 0) and Q(1, 1). The thesis does not say which; this one is ours.

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use drawing::{Panel, gallery_path, shade, write};
use nalgebra::Vector2;
use se3_geom::{CurvatureFlow, nalgebra};

pub(crate) const EDGES: usize = 200;
const STEP: f64 = 1e-3;
const STEPS_DRAWN: [usize; 6] = [0, 10, 40, 100, 300, 2000];

pub(crate) struct Stage {
    pub(crate) time: f64,
    pub(crate) length: f64,
    pub(crate) points: Vec<Vector2<f64>>,
}

pub(crate) struct Numbers {
    /// Those drawn.
    pub(crate) stages: Vec<Stage>,
    /// After every step.
    pub(crate) lengths: Vec<f64>,
}

pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let on_curve = |i: usize| {
        let s = i as f64 / EDGES as f64;
        let aside = 0.35 * (2.0 * PI * s).sin() + 0.12 * (5.0 * PI * s).sin();
        Vector2::new(s - aside, s + aside)
    };
    let mut points: Vec<_> = (0..=EDGES).map(on_curve).collect();
    points[EDGES] = Vector2::new(1.0, 1.0);
    let mut flow = CurvatureFlow::new(points)?;
    let mut numbers = Numbers { stages: Vec::new(), lengths: Vec::new() };
    for step in 0..=STEPS_DRAWN[STEPS_DRAWN.len() - 1] {
        if step > 0 {
            flow.advance(STEP)?;
        }
        numbers.lengths.push(flow.length());
        if STEPS_DRAWN.contains(&step) {
            let stage = Stage { time: flow.time(), length: flow.length(), points: flow.points().to_vec() };
            numbers.stages.push(stage);
        }
    }
    Ok(numbers)
}

pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let mut panel = Panel::new("Figure 4.1: curvature flow, dark at t = 0");
    for (i, stage) in numbers.stages.iter().enumerate() {
        let share = i as f64 / (numbers.stages.len() - 1) as f64;
        panel.line(stage.points.iter().copied(), shade(share), "");
    }
    panel.label(Vector2::zeros(), "P(0, 0)");
    panel.label(Vector2::new(1.0, 1.0), "Q(1, 1)");
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    let path = gallery_path("figure_4_1")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    for stage in &numbers.stages {
        println!("t = {:.3}  length {:.9}", stage.time, stage.length);
    }
    println!("straight       {:.9}", 2f64.sqrt());
    Ok(())
}
