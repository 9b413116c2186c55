//! Thesis Figures 7.2 to 7.4: sixteen shuffled video frames of a moving rectangle, put in order.
//!
//! Nothing but the pixels is used. Each frame is segmented; the mean of its pixels is the rectangle's position, their spread
//! its sides; and the rotation comes from overlaps, as in the thesis: registered at their means, the frame's rectangle and one of
//! known direction overlap the less the more they are turned against each other. Two known directions, 45° apart, tell the sign.

#[allow(dead_code)]
#[path = "../../se3-geom/examples/drawing/mod.rs"]
mod drawing;
#[path = "shuffled/mod.rs"]
mod shuffled;

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::path::Path;

use drawing::{Panel, gallery_path, write};
use plotters::style::{BLACK, BLUE, RED};
use reorder::{Options, Ordering, order};
use se3_geom::Se2;
use se3_geom::nalgebra::{Isometry2, Point2, Vector2};
use shuffled::{follows, shuffle};

/// Width and height of a frame, in pixels.
const SIDE: usize = 240;
const FRAMES: usize = 16;
/// Sides of the rectangle, in pixels.
const SIDES: [f64; 2] = [44.0, 18.0];
/// Brightness above which a pixel belongs to the object; the background flickers below it.
const THRESHOLD: u8 = 128;

/// A grey-scale picture, row by row.
type Frame = Vec<u8>;

/// What is told from one frame: the mean, in pixels, and the direction of the long side, in (−π/2, π/2].
pub(crate) struct Estimate {
    pub(crate) position: Vector2<f64>,
    pub(crate) direction_rad: f64,
}

/// The experiment from frames to order.
pub(crate) struct Numbers {
    /// True poses of the shuffled frames.
    pub(crate) truth: Vec<Isometry2<f64>>,
    /// What was told from the pixels.
    pub(crate) estimates: Vec<Estimate>,
    /// The recovered order of the shuffled frames.
    pub(crate) ordering: Ordering,
    /// Whether that is the order in which they were filmed, or its reverse.
    pub(crate) recovered: bool,
}

/// Where the rectangle is at frame k: on an arc, turning by 150° in all.
fn filmed(k: usize) -> Isometry2<f64> {
    let t = k as f64 / (FRAMES - 1) as f64;
    let position = Vector2::new(35.0 + 170.0 * t, 60.0 + 110.0 * (PI * t).sin());
    Isometry2::new(position, -1.2 + 2.6 * t)
}

fn render(pose: &Isometry2<f64>, seed: usize) -> Frame {
    let pixel = |i: usize| {
        let place = pose.inverse_transform_point(&Point2::new((i % SIDE) as f64, (i / SIDE) as f64));
        let flicker = ((i * 7919 + seed * 104_729) % 61) as u8;
        let inside = 2.0 * place.x.abs() <= SIDES[0] && 2.0 * place.y.abs() <= SIDES[1];
        if inside { 255 - flicker } else { flicker }
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

fn estimate(frame: &Frame) -> Estimate {
    let bright = (0..frame.len()).filter(|&i| frame[i] > THRESHOLD);
    let pixels: Vec<_> = bright.map(|i| Vector2::new((i % SIDE) as f64, (i / SIDE) as f64)).collect();
    let area = pixels.len() as f64;
    let position = pixels.iter().sum::<Vector2<f64>>() / area;
    let registered: Vec<_> = pixels.iter().map(|p| p - position).collect();
    // Of a rectangle of sides a ≥ b: area a·b, mean square distance from the middle (a² + b²)/12.
    let mean_square = registered.iter().map(Vector2::norm_squared).sum::<f64>() / area;
    let (sum, difference) =
        ((12.0 * mean_square + 2.0 * area).sqrt(), (12.0 * mean_square - 2.0 * area).max(0.0).sqrt());
    let sides = [0.5 * (sum + difference), 0.5 * (sum - difference)];
    let overlap = |direction_rad: f64| {
        let (sine, cosine) = direction_rad.sin_cos();
        let inside = |p: &&Vector2<f64>| {
            let [x, y] = [cosine * p.x + sine * p.y, cosine * p.y - sine * p.x];
            2.0 * x.abs() <= sides[0] && 2.0 * y.abs() <= sides[1]
        };
        registered.iter().filter(inside).count() as f64
    };
    let [from_x, from_diagonal] = [0.0, FRAC_PI_4].map(|direction| turn_of_overlap(sides, overlap(direction)));
    // The smaller turn is the sharper one, as the overlap is flat towards a right angle; the other one tells its sign.
    let turn_between = |a: f64, b: f64| {
        let turn = (a - b).abs() % PI;
        turn.min(PI - turn)
    };
    let (known, turn, other, other_turn) = if from_x <= from_diagonal {
        (0.0, from_x, FRAC_PI_4, from_diagonal)
    } else {
        (FRAC_PI_4, from_diagonal, 0.0, from_x)
    };
    let contradiction = |direction: &f64| (turn_between(*direction, other) - other_turn).abs();
    let (left, right) = (known + turn, known - turn);
    let direction = if contradiction(&left) <= contradiction(&right) { left } else { right };
    let direction_rad = if direction > FRAC_PI_2 { direction - PI } else { direction };
    Estimate { position, direction_rad }
}

/// The angle in \[0, π/2\] by which two equal rectangles about one middle are turned against each other when they overlap by
/// `area`: the overlap falls with the angle, so that bisection finds it. Thesis §7.2 gives b²/sin θ for large angles.
fn turn_of_overlap(sides: [f64; 2], area: f64) -> f64 {
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if overlap_area(sides, middle) > area { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Area common to a rectangle and itself turned by θ about its middle: the turned one, clipped by the four sides.
pub(crate) fn overlap_area([a, b]: [f64; 2], angle_rad: f64) -> f64 {
    let (sine, cosine) = angle_rad.sin_cos();
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let turned = |(x, y): (f64, f64)| {
        let (x, y) = (0.5 * a * x, 0.5 * b * y);
        Vector2::new(cosine * x - sine * y, sine * x + cosine * y)
    };
    let mut polygon: Vec<Vector2<f64>> = corners.map(turned).to_vec();
    for (normal, bound) in
        [(Vector2::x(), 0.5 * a), (-Vector2::x(), 0.5 * a), (Vector2::y(), 0.5 * b), (-Vector2::y(), 0.5 * b)]
    {
        let beyond = |p: &Vector2<f64>| normal.dot(p) - bound;
        let mut kept = Vec::new();
        for i in 0..polygon.len() {
            let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            if beyond(&p) <= 0.0 {
                kept.push(p);
            }
            if beyond(&p) * beyond(&q) < 0.0 {
                kept.push(p + (q - p) * (beyond(&p) / (beyond(&p) - beyond(&q))));
            }
        }
        polygon = kept;
    }
    let twice: f64 = (0..polygon.len()).map(|i| polygon[i].perp(&polygon[(i + 1) % polygon.len()])).sum();
    0.5 * twice.abs()
}

/// Renders and shuffles the frames, reads them, and orders what was read through SE(2).
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let places = shuffle(FRAMES, 16);
    let truth: Vec<_> = places.iter().map(|&k| filmed(k)).collect();
    let frames: Vec<Frame> = truth.iter().zip(&places).map(|(pose, &k)| render(pose, k)).collect();
    let estimates: Vec<_> = frames.iter().map(estimate).collect();
    // A rectangle looks the same after half a turn: twice its direction is a full angle. A quarter of α makes up for it.
    let poses: Vec<_> = estimates.iter().map(|e| Isometry2::new(e.position, 2.0 * e.direction_rad)).collect();
    let pixels_per_radian = SIDES[0];
    let metric = Se2::with_weights(0.25 * pixels_per_radian * pixels_per_radian, 1.0).ok_or("no such metric")?;
    let ordering = order(&metric, &poses, &Options::default())?;
    let recovered = follows(&ordering, &places, false);
    Ok(Numbers { truth, estimates, ordering, recovered })
}

/// The frames as they came, the rectangles that were read from them, and their order.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let outline = |pose: &Isometry2<f64>| {
        let corner =
            |(x, y): (f64, f64)| pose.transform_point(&Point2::new(0.5 * SIDES[0] * x, 0.5 * SIDES[1] * y)).coords;
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)].map(corner)
    };
    let mut filmed = Panel::new("sixteen frames, laid over each other");
    for pose in &numbers.truth {
        filmed.line(outline(pose), BLACK, "");
    }
    let mut ordered = Panel::new(format!("read from the pixels, in order: {:?}", numbers.ordering.verdict));
    for estimate in &numbers.estimates {
        ordered.line(outline(&Isometry2::new(estimate.position, estimate.direction_rad)), BLUE, "");
    }
    ordered.line(numbers.ordering.order.iter().map(|&row| numbers.estimates[row].position), RED, "recovered order");
    write(&[filmed, ordered], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    for (estimate, pose) in numbers.estimates.iter().zip(&numbers.truth) {
        let (got, true_rad) = (estimate.direction_rad.to_degrees(), pose.rotation.angle().to_degrees());
        println!("direction {got:7.2} degrees, filmed at {true_rad:7.2}");
    }
    println!("order {:?}: recovered {}, {:?}", numbers.ordering.order, numbers.recovered, numbers.ordering.verdict);
    let path = gallery_path("figures_7_2_to_7_4")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
