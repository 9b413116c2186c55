//! Thesis Figures 4.8–4.10: unit line segments in the plane as a level set (Example 4.4), moved from one segment in the three
//! directions of a basis of the tangent space.

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::f64::consts::FRAC_1_SQRT_2;
use std::path::Path;

use drawing::{Panel, gallery_path, write};
use plotters::style::{BLACK, BLUE};
use se3_geom::nalgebra::{Vector2, Vector4};
use se3_geom::{Constraint, Curve, Geodesic, LevelSet, Manifold, UnitSegments};

/// The basis (4.9) of the tangent space at P. The caption of Figure 4.10 drops an entry of the third.
pub(crate) const DIRECTIONS: [[f64; 4]; 3] = [[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0], [1.0, -1.0, -1.0, 1.0]];
/// A segment every this part of a unit of time.
const STEPS: u32 = 20;

/// One of the three figures.
pub(crate) struct SegmentMotion {
    /// The initial velocity v.
    pub(crate) direction: Vector4<f64>,
    /// DF(P)·v: a tangent vector has none.
    pub(crate) normal_part: f64,
    /// ‖v‖, the length of the motion over unit time.
    pub(crate) length: f64,
    /// exp(P, t·v) at even steps of t from 0 to 1.
    pub(crate) segments: Vec<Vector4<f64>>,
    /// The greatest |F| of these segments.
    pub(crate) violation: f64,
}

/// What the figures show.
pub(crate) struct Numbers {
    /// In the order of the figures.
    pub(crate) motions: [SegmentMotion; 3],
}

/// Moves P = (0, 0, 1/√2, 1/√2) along the three geodesics.
pub(crate) fn compute() -> Numbers {
    let space = LevelSet::unit_segments();
    let p = Vector4::new(0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2);
    let motions = DIRECTIONS.map(|direction| {
        let direction = Vector4::from(direction);
        let geodesic = Geodesic::leaving(space, p, direction);
        let segments: Vec<_> = (0..=STEPS).map(|k| geodesic.point(f64::from(k) / f64::from(STEPS))).collect();
        let violation = segments.iter().map(|s| UnitSegments.value(s)[0].abs()).fold(0.0, f64::max);
        let normal_part = (UnitSegments.jacobian(&p) * direction)[0];
        SegmentMotion { direction, normal_part, length: space.norm(&p, direction), segments, violation }
    });
    Numbers { motions }
}

/// One panel a figure, the first segment black.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let panels = ["4.8", "4.9", "4.10"].iter().zip(&numbers.motions).map(|(figure, motion)| {
        let mut panel = Panel::new(format!("Figure {figure}: exp along {:?}", motion.direction.as_slice()));
        for (k, segment) in motion.segments.iter().enumerate() {
            let ends = [Vector2::new(segment[0], segment[1]), Vector2::new(segment[2], segment[3])];
            panel.line(ends, if k == 0 { BLACK } else { BLUE }, "");
            panel.dots(ends, BLACK);
        }
        panel
    });
    write(&panels.collect::<Vec<_>>(), path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute();
    for motion in &numbers.motions {
        let last = motion.segments[motion.segments.len() - 1];
        println!(
            "direction {:?}: normal part {:e}, length {:.6}, last segment {:.6?}, greatest |F| {:.1e}",
            motion.direction.as_slice(),
            motion.normal_part,
            motion.length,
            last.as_slice(),
            motion.violation
        );
    }
    let path = gallery_path("figures_4_8_to_4_10")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
