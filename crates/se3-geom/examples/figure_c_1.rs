//! Thesis Figure C.1: a vector carried in parallel once round the latitude u = π/4 of the unit sphere comes back turned by the
//! area enclosed, (2 − √2)π.

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::f64::consts::{FRAC_PI_4, PI};
use std::path::Path;

use drawing::{Panel, View, gallery_path, write};
use plotters::style::{BLACK, RED, RGBColor};
use se3_geom::nalgebra::{Vector2, Vector3};
use se3_geom::{LogError, Manifold, Sphere};

/// The latitude, counted from the pole.
pub(crate) const U: f64 = FRAC_PI_4;
/// How many geodesics stand for the latitude, coarse to fine.
pub(crate) const PIECES: [u32; 4] = [32, 64, 128, 256];

/// What the figure shows.
pub(crate) struct Numbers {
    /// The turn of the vector after one round on each of [`PIECES`], counter-clockwise seen from outside, in rad.
    pub(crate) turns_rad: [f64; 4],
    /// What they tend to, by Richardson's extrapolation of the last two.
    pub(crate) limit_rad: f64,
    /// Along the latitude on the finest pieces: where, and the vector carried there. The last point is the first.
    pub(crate) field: Vec<[Vector3<f64>; 2]>,
}

/// x(u, v) (4.7).
pub(crate) fn point(u: f64, v: f64) -> Vector3<f64> {
    Vector3::new(u.sin() * v.cos(), u.sin() * v.sin(), u.cos())
}
/// x_u; the thesis prints −sin v for the last entry.
pub(crate) fn along_u(u: f64, v: f64) -> Vector3<f64> {
    Vector3::new(u.cos() * v.cos(), u.cos() * v.sin(), -u.sin())
}

/// The latitude as `pieces` geodesics, and x_u carried along them.
fn carry(pieces: u32) -> Result<Vec<[Vector3<f64>; 2]>, LogError> {
    let mut field = vec![[point(U, 0.0), along_u(U, 0.0)]];
    for k in 1..=pieces {
        let [here, vector] = field[field.len() - 1];
        let next = point(U, 2.0 * PI * f64::from(k % pieces) / f64::from(pieces));
        field.push([next, Sphere.transport(&here, Sphere.log(&here, &next)?, vector)]);
    }
    Ok(field)
}

/// The angle from the first vector to the last in the tangent plane where both are, in \[0, 2π).
fn turn(field: &[[Vector3<f64>; 2]]) -> f64 {
    let ([at, first], [_, last]) = (&field[0], &field[field.len() - 1]);
    first.cross(last).dot(at).atan2(first.dot(last)).rem_euclid(2.0 * PI)
}

/// Parallel transport (3.8) along ever shorter geodesics.
pub(crate) fn compute() -> Result<Numbers, LogError> {
    let mut turns_rad = [0.0; 4];
    let mut field = Vec::new();
    for (turned, pieces) in turns_rad.iter_mut().zip(PIECES) {
        field = carry(pieces)?;
        *turned = turn(&field);
    }
    // The polygons enclose less than the latitude by an area that falls with the square of the pieces' length.
    Ok(Numbers { turns_rad, limit_rad: (4.0 * turns_rad[3] - turns_rad[2]) / 3.0, field })
}

/// The sphere's net as far as it faces the viewer.
pub(crate) fn net(view: &View) -> Vec<Vec<Vector2<f64>>> {
    let part = |i: i32| f64::from(i) / 60.0 * PI;
    let latitudes = (1..12).map(|k| (0..=60).map(|i| point(part(5 * k), 2.0 * part(i))).collect::<Vec<_>>());
    let meridians = (0..12).map(|k| (0..=60).map(|i| point(part(i), 2.0 * part(5 * k))).collect());
    let lines = latitudes.chain(meridians).flat_map(|line| {
        let runs = line.split(|p| !view.faces(p)).filter(|run| run.len() > 1);
        runs.map(|run| run.iter().map(|p| view.project(p)).collect()).collect::<Vec<_>>()
    });
    lines.collect()
}

/// Where the viewer is.
pub(crate) fn view() -> View {
    View::from_angles(0.4, 0.7)
}

/// The net, the latitude, and the vector on its way.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let view = view();
    let mut panel = Panel::new("Figure C.1: parallel transport round a latitude");
    for line in net(&view) {
        panel.line(line, RGBColor(210, 210, 210), "");
    }
    panel.line(numbers.field.iter().map(|[p, _]| view.project(p)), BLACK, "latitude π/4");
    for [p, v] in numbers.field.iter().step_by(16) {
        panel.line([*p, p + v * 0.3].map(|x| view.project(&x)), RED, "");
    }
    panel.dots([view.project(&numbers.field[0][0])], BLACK);
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    let exact = (2.0 - std::f64::consts::SQRT_2) * PI;
    println!("(2 − √2)π        {exact:.12} rad");
    for (pieces, turned) in PIECES.iter().zip(numbers.turns_rad) {
        println!("{pieces:3} geodesics    {turned:.12} rad, off by {:.3e}", turned - exact);
    }
    println!("extrapolated     {:.12} rad, off by {:.3e}", numbers.limit_rad, numbers.limit_rad - exact);
    let path = gallery_path("figure_c_1")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
