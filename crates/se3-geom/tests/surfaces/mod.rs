//! The surfaces of Examples 4.2 and 4.3, and one to go round.
#![allow(dead_code)] // each test file uses a part

use std::f64::consts::PI;

use nalgebra::{Matrix2, Vector2};
use se3_geom::{HeightJet, MongePatch, nalgebra};

/// z = xy: negative curvature, so no cut locus.
pub(crate) fn saddle() -> MongePatch<impl Fn(f64, f64) -> HeightJet> {
    let jet =
        |x, y| HeightJet { height: x * y, gradient: Vector2::new(y, x), hessian: Matrix2::new(0.0, 1.0, 1.0, 0.0) };
    MongePatch::new(jet, f64::INFINITY)
}

/// z = sin x·cos y: its Hessian has the eigenvalues −sin(x ± y), so principal curvatures are at most 1.
pub(crate) fn egg_box() -> MongePatch<impl Fn(f64, f64) -> HeightJet> {
    let jet = |x: f64, y: f64| {
        let ((sx, cx), (sy, cy)) = (x.sin_cos(), y.sin_cos());
        HeightJet {
            height: sx * cy,
            gradient: Vector2::new(cx * cy, -sx * sy),
            hessian: Matrix2::new(-sx * cy, -cx * sy, -cx * sy, -sx * cy),
        }
    };
    MongePatch::new(jet, PI)
}

/// A hill, z = 2·exp(−x² − y²), around which geodesics pass on either side. Its greatest curvature is 4, at the top.
pub(crate) fn hill() -> MongePatch<impl Fn(f64, f64) -> HeightJet> {
    let jet = |x: f64, y: f64| {
        let height = 2.0 * (-x * x - y * y).exp();
        let p = Vector2::new(x, y);
        HeightJet {
            height,
            gradient: p * (-2.0 * height),
            hessian: (p * p.transpose() * 4.0 - Matrix2::identity() * 2.0) * height,
        }
    };
    MongePatch::new(jet, PI / 4.0)
}
