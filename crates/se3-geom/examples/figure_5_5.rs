//! Figure 5.5: the unit circle C on a surface of revolution and its normal geodesic from (1, 0, 1.0629) to M = (0, 0, 0), which is
//! all of its medial axis and farther away than C is long.
//!
//! The thesis does not state the surface, and one that only rises from M to C would not do: its meridian is at most
//! 1 + 1.0629 long. Here z = q·(1.0629 + 13·(1 − q)) with q = x² + y²: a wall between M and C. The steeper it is, the more like a
//! cylinder is the way down from C, and the farther off is M.
//!
//! M is the medial axis on every such surface: the way out along the meridian is shorter than any other to C, as going round adds
//! to it, so only the centre has two nearest points of C.

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use drawing::{Panel, View, gallery_path, shade, write};
use nalgebra::{Matrix2, Vector2, Vector3};
use se3_geom::{DistanceMap, HeightJet, Manifold, MongePatch, SurfaceGrid, nalgebra};

pub(crate) const RIM: f64 = 1.0629;
const WALL: f64 = 13.0;
pub(crate) const PIECES: usize = 200;
/// Azimuth and elevation of the view.
const VIEW: [f64; 2] = [-0.9, 0.45];

pub(crate) struct Numbers {
    pub(crate) start: Vector3<f64>,
    pub(crate) circle: Vec<Vector3<f64>>,
    pub(crate) circle_length: f64,
    /// Along the normal geodesic, to M.
    pub(crate) normal_length: f64,
    pub(crate) normal: Vec<Vector3<f64>>,
    /// How far from M the normal geodesics of this length end, from points all around C.
    pub(crate) worst_miss: f64,
    /// The least distance of C from M by front propagation, which knows nothing of meridians.
    pub(crate) least_distance_by_front: f64,
}

fn vase() -> MongePatch<impl Fn(f64, f64) -> HeightJet> {
    let jet = |x: f64, y: f64| {
        let p = Vector2::new(x, y);
        let q = p.norm_squared();
        let first = RIM + WALL * (1.0 - 2.0 * q);
        HeightJet {
            height: q * (RIM + WALL * (1.0 - q)),
            gradient: p * (2.0 * first),
            hessian: Matrix2::identity() * (2.0 * first) - p * p.transpose() * (8.0 * WALL),
        }
    };
    // Nothing is claimed of the injectivity radius.
    MongePatch::new(jet, 0.0)
}

pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let vase = vase();
    let parts = || (0..=PIECES).map(|i| i as f64 / PIECES as f64);
    let around = |part: f64| Vector2::new((TAU * part).cos(), (TAU * part).sin());
    let inward = |p: &Vector2<f64>| -p / vase.norm(p, *p);
    let start = Vector2::new(1.0, 0.0);
    let normal_length = length_to_centre(&vase, &start, inward(&start))?;
    let miss = |part: f64| vase.exp(&around(part), inward(&around(part)) * normal_length).norm();
    let corner = Vector2::new(1.2, 1.2);
    let grid = SurfaceGrid::sample(-corner, corner, [241, 241], |x, y| vase.embed(&Vector2::new(x, y)).z)?;
    let from_centre = DistanceMap::from_source(&grid, Vector2::zeros())?;
    let distances = parts().map(|part| from_centre.at(&around(part))).collect::<Result<Vec<_>, _>>()?;
    Ok(Numbers {
        start: vase.embed(&start),
        circle: parts().map(|part| vase.embed(&around(part))).collect(),
        circle_length: TAU,
        normal_length,
        normal: parts().map(|part| vase.embed(&vase.exp(&start, inward(&start) * (normal_length * part)))).collect(),
        worst_miss: parts().map(miss).fold(0.0, f64::max),
        least_distance_by_front: distances.into_iter().fold(f64::INFINITY, f64::min),
    })
}

/// How long the geodesic with this unit velocity takes until x = 0, by bisection.
fn length_to_centre<H: Fn(f64, f64) -> HeightJet + Sync>(
    patch: &MongePatch<H>,
    start: &Vector2<f64>,
    velocity: Vector2<f64>,
) -> Result<f64, Box<dyn Error>> {
    let x_after = |length: f64| patch.exp(start, velocity * length).x;
    let (mut before, mut after) = (0.0, 1.0);
    while x_after(after) > 0.0 {
        (before, after) = (after, after + 1.0);
        if after > 100.0 {
            return Err("the normal geodesic does not reach the middle".into());
        }
    }
    while after - before > 1e-13 * after {
        let middle = 0.5 * (before + after);
        if x_after(middle) > 0.0 { before = middle } else { after = middle }
    }
    Ok(after)
}

pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let vase = vase();
    let view = View::from_angles(VIEW[0], VIEW[1]);
    let on_polar = |radius: f64, angle: f64| vase.embed(&Vector2::new(radius * angle.cos(), radius * angle.sin()));
    let mut panel = Panel::new(format!(
        "Figure 5.5: circle {:.4} long, normal geodesic to M {:.4} long",
        numbers.circle_length, numbers.normal_length
    ));
    panel.wireframe(&view, on_polar, [[0.0, 1.05], [0.0, TAU]], 31);
    for (curve, share) in [(&numbers.circle, 0.0), (&numbers.normal, 0.6)] {
        panel.line(curve.iter().map(|point| view.project(point)), shade(share), "");
    }
    panel.label(view.project(&numbers.start), "(1, 0, 1.0629)");
    panel.label(view.project(&Vector3::zeros()), "M");
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    let path = gallery_path("figure_5_5")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    println!("circle {:.9}, normal geodesic to M {:.9}", numbers.circle_length, numbers.normal_length);
    println!("normal geodesics from all around C miss M by {:.1e}", numbers.worst_miss);
    println!("least distance to M by front propagation {:.6}", numbers.least_distance_by_front);
    Ok(())
}
