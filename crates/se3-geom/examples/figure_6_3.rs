//! Thesis Figure 6.3: the closed C² cubic spline through eleven points of the plane (eqs. 6.10 and 6.11).

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::path::Path;

use drawing::{Panel, gallery_path, write};
use plotters::style::{BLACK, BLUE};
use se3_geom::nalgebra::Vector2;
use se3_geom::{CubicEnds, CubicSpline, Curve, R2, SplineError, arc_length};

/// The points (6.11).
pub(crate) const POINTS: [[f64; 2]; 11] = [
    [2.0, 0.0],
    [3.0, 0.0],
    [4.0, 1.0],
    [3.0, 2.0],
    [2.0, 1.5],
    [2.0, 2.0],
    [3.0, 2.5],
    [4.0, 4.0],
    [2.0, 4.0],
    [1.0, 2.0],
    [1.0, 1.0],
];
/// Points drawn of each piece.
const SAMPLES: u32 = 20;

/// Position, velocity and acceleration at a knot.
pub(crate) type Knot = [Vector2<f64>; 3];

/// What the figure shows.
pub(crate) struct Numbers {
    /// At every knot, as the piece before it ends; the first is the end of the closing piece.
    pub(crate) arriving: Vec<Knot>,
    /// At every knot, as the piece after it begins.
    pub(crate) leaving: Vec<Knot>,
    /// The length of the curve.
    pub(crate) length: f64,
    /// The curve.
    pub(crate) curve: Vec<Vector2<f64>>,
}

/// The spline on the knots 0, 1, … 11.
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let spline = closed_spline()?;
    let knots = spline.knots();
    let pieces = || knots.windows(2);
    // A piece is a cubic: its Taylor series at the middle is the piece.
    let taylor = |piece: &[f64], side: f64| {
        let (middle, h) = (spline.derivatives(0.5 * (piece[0] + piece[1])), 0.5 * side * (piece[1] - piece[0]));
        let acceleration = middle.acceleration + middle.jerk * h;
        let velocity = middle.velocity + (middle.acceleration + acceleration) * (0.5 * h);
        let point = middle.point + (middle.velocity + (middle.acceleration * 0.5 + middle.jerk * (h / 6.0)) * h) * h;
        [point, velocity, acceleration]
    };
    let mut arriving: Vec<_> = pieces().map(|piece| taylor(piece, 1.0)).collect();
    arriving.rotate_right(1);
    let samples = SAMPLES * POINTS.len() as u32;
    Ok(Numbers {
        arriving,
        leaving: pieces().map(|piece| taylor(piece, -1.0)).collect(),
        length: arc_length(&spline, &R2::default())?,
        curve: (0..=samples).map(|k| spline.point(f64::from(k) / f64::from(SAMPLES))).collect(),
    })
}

/// The curve itself.
pub(crate) fn closed_spline() -> Result<CubicSpline<2>, SplineError> {
    let knots: Vec<_> = (0..=POINTS.len()).map(|i| i as f64).collect();
    CubicSpline::through(&POINTS.map(Vector2::from), &knots, CubicEnds::Periodic)
}

/// The curve and its points.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let mut panel = Panel::new("Figure 6.3: a closed cubic spline");
    panel.line(numbers.curve.iter().copied(), BLUE, &format!("length {:.4}", numbers.length));
    panel.dots(POINTS.map(Vector2::from), BLACK);
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    println!("length {:.12}", numbers.length);
    for (i, (before, after)) in numbers.arriving.iter().zip(&numbers.leaving).enumerate() {
        let [miss, kink, jump] = std::array::from_fn(|k| (after[k] - before[k]).norm());
        let tangent = after[1];
        println!(
            "P{}: tangent ({:+.6}, {:+.6}); gap {miss:.1e}, jump of velocity {kink:.1e}, of acceleration {jump:.1e}",
            i + 1,
            tangent.x,
            tangent.y
        );
    }
    let path = gallery_path("figure_6_3")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
