//! Figure 4.2: geodesics on the Monge patches of Examples 4.2 and 4.3, and the curves that the search begins with.

#[allow(dead_code)]
mod drawing;
#[path = "../tests/surfaces/mod.rs"]
mod surfaces;

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use drawing::{Panel, View, gallery_path, shade, write};
use nalgebra::{Vector2, Vector3};
use se3_geom::{HeightJet, Manifold, MongePatch, nalgebra};
use surfaces::{egg_box, saddle};

pub(crate) const PIECES: usize = 200;
/// Azimuth and elevation of the view.
const VIEW: [f64; 2] = [-1.1, 0.7];

pub(crate) struct Case {
    pub(crate) guess: Vec<Vector3<f64>>,
    pub(crate) guess_length: f64,
    pub(crate) geodesic: Vec<Vector3<f64>>,
    pub(crate) geodesic_length: f64,
}

pub(crate) struct Numbers {
    pub(crate) saddle: Case,
    pub(crate) egg_box: Case,
}

pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    Ok(Numbers {
        // Straight in the plane would be the geodesic already.
        saddle: case(&saddle(), [Vector2::new(1.0, 1.0), Vector2::new(-1.0, -1.0)], 0.3)?,
        egg_box: case(&egg_box(), [Vector2::new(-3.0, -3.0), Vector2::new(3.0, 3.0)], 0.0)?,
    })
}

/// `bow`: how far the first guess swings out in the plane, as a part of the distance there.
fn case<H: Fn(f64, f64) -> HeightJet + Sync>(
    patch: &MongePatch<H>,
    [p, q]: [Vector2<f64>; 2],
    bow: f64,
) -> Result<Case, Box<dyn Error>> {
    let parts = || (0..=PIECES).map(|i| i as f64 / PIECES as f64);
    let (chord, across) = (q - p, Vector2::new(p.y - q.y, q.x - p.x));
    let guess: Vec<_> = parts().map(|t| patch.embed(&(p + chord * t + across * (bow * (PI * t).sin())))).collect();
    let velocity = patch.log(&p, &q)?;
    let geodesic = parts().map(|t| patch.embed(&patch.exp(&p, velocity * t))).collect();
    let guess_length = guess.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    Ok(Case { guess, guess_length, geodesic, geodesic_length: patch.norm(&p, velocity) })
}

fn panel<H: Fn(f64, f64) -> HeightJet + Sync>(title: &str, patch: &MongePatch<H>, side: f64, case: &Case) -> Panel {
    let mut panel =
        Panel::new(format!("{title}: guess {:.4}, geodesic {:.4}", case.guess_length, case.geodesic_length));
    let view = View::from_angles(VIEW[0], VIEW[1]);
    panel.wireframe(&view, |x, y| patch.embed(&Vector2::new(x, y)), [[-side, side]; 2], 25);
    for (curve, share) in [(&case.guess, 0.8), (&case.geodesic, 0.0)] {
        panel.line(curve.iter().map(|point| view.project(point)), shade(share), "");
    }
    panel
}

pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let saddle_panel = panel("Figure 4.2 (a), z = xy", &saddle(), 1.2, &numbers.saddle);
    let egg_panel = panel("(b), z = sin x cos y", &egg_box(), 3.5, &numbers.egg_box);
    write(&[saddle_panel, egg_panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    let path = gallery_path("figure_4_2")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    for (name, case) in [("z = xy", &numbers.saddle), ("z = sin x cos y", &numbers.egg_box)] {
        println!("{name}: first guess {:.9}, geodesic {:.9}", case.guess_length, case.geodesic_length);
    }
    Ok(())
}
