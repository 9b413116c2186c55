//! The surfaces of Examples 4.2 and 4.3, some to go round, and the sphere as a level set.
#![allow(dead_code)] // each test file uses a part

use std::f64::consts::PI;

use nalgebra::{Matrix2, SMatrix, Vector1, Vector2, Vector3};
use se3_geom::{Constraint, HeightJet, LevelSet, MongePatch, nalgebra};

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

/// Six Gaussian bumps of either sign, as (x, y, height, width): no radius is claimed.
pub(crate) fn six_bumps() -> MongePatch<impl Fn(f64, f64) -> HeightJet> {
    const BUMPS: [[f64; 4]; 6] = [
        [-1.6, 0.3, 1.5, 0.6],
        [-0.4, -1.1, 1.2, 0.5],
        [0.1, 0.9, 1.8, 0.6],
        [1.2, -0.3, 1.6, 0.5],
        [1.9, 1.4, -1.1, 0.7],
        [-1.0, 1.8, 1.3, 0.5],
    ];
    let jet = |x: f64, y: f64| {
        let mut jet = HeightJet { height: 0.0, gradient: Vector2::zeros(), hessian: Matrix2::zeros() };
        for [at_x, at_y, top, width] in BUMPS {
            let p = Vector2::new(x - at_x, y - at_y) / width;
            let height = top * (-p.norm_squared()).exp();
            jet.height += height;
            jet.gradient += p * (-2.0 * height / width);
            jet.hessian += (p * p.transpose() * 4.0 - Matrix2::identity() * 2.0) * (height / (width * width));
        }
        jet
    };
    MongePatch::new(jet, 0.0)
}

/// x·x = 1.
pub(crate) struct UnitLength;

impl Constraint<3, 1> for UnitLength {
    fn value(&self, x: &Vector3<f64>) -> Vector1<f64> {
        Vector1::new(x.norm_squared() - 1.0)
    }
    fn jacobian(&self, x: &Vector3<f64>) -> SMatrix<f64, 1, 3> {
        x.transpose() * 2.0
    }
    fn second_derivative(&self, _: &Vector3<f64>, u: &Vector3<f64>, v: &Vector3<f64>) -> Vector1<f64> {
        Vector1::new(2.0 * u.dot(v))
    }
}

/// The unit sphere by its equation.
pub(crate) fn round_sphere() -> LevelSet<UnitLength, 3, 1> {
    LevelSet::new(UnitLength, PI)
}
