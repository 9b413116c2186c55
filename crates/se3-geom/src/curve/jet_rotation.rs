//! Vectors and rotations whose coordinates are jets.

use std::ops::{Add, Mul, Sub};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::Jet;
use crate::stumpff::stumpff;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JetVector(pub(crate) [Jet; 3]);

impl JetVector {
    pub(crate) fn constant(v: &Vector3<f64>) -> Self {
        Self([v.x, v.y, v.z].map(Jet::constant))
    }
    /// The k-th derivative.
    pub(crate) fn derivative(&self, k: usize) -> Vector3<f64> {
        Vector3::from(self.0.map(|x| x.derivatives()[k]))
    }
    pub(crate) fn dot(&self, other: &Self) -> Jet {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }
    pub(crate) fn cross(&self, other: &Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }
}
impl Add for JetVector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}
impl Sub for JetVector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}
impl Mul<Jet> for JetVector {
    type Output = Self;
    fn mul(self, factor: Jet) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}

/// As many terms as angles up to π need, which logarithms have: the last is below π³⁰/31! ≈ 1e-19, and none is so large that
/// digits cancel.
const COSINE: [f64; 16] = stumpff(0);
const SINE_RATIO: [f64; 16] = stumpff(1);
pub(crate) const B: [f64; 16] = stumpff(2);
pub(crate) const C: [f64; 16] = stumpff(3);

/// atan(√z)/√z = Σ (−z)ᵏ/(2k+1).
const ARCTANGENT_RATIO: [f64; 13] = {
    let mut series = [0.0; 13];
    let mut k = 0;
    while k < 13 {
        let term = 1.0 / (2 * k + 1) as f64;
        series[k] = if k % 2 == 0 { term } else { -term };
        k += 1;
    }
    series
};

/// A unit quaternion w + v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JetRotation {
    w: Jet,
    v: JetVector,
}

impl JetRotation {
    pub(crate) fn constant(q: &UnitQuaternion<f64>) -> Self {
        Self { w: Jet::constant(q.w), v: JetVector::constant(&q.imag()) }
    }
    pub(crate) fn exp(v: &JetVector) -> Self {
        let quarter = v.dot(v) * 0.25;
        Self { w: quarter.polynomial(&COSINE), v: *v * (quarter.polynomial(&SINE_RATIO) * 0.5) }
    }
    /// The rotation vector of at most half a turn. Three square roots of the rotation bring its half angle below π/16, where
    /// the series of the arctangent has converged after 13 terms (0.04¹³/27 < 1e-19); none of them loses digits.
    pub(crate) fn log(&self) -> JetVector {
        let mut root = if self.w.value() < 0.0 { Self { w: -self.w, v: self.v * Jet::constant(-1.0) } } else { *self };
        for _ in 0..3 {
            let w = ((root.w + Jet::constant(1.0)) * 0.5).sqrt();
            root = Self { w, v: root.v * (w * 2.0).recip() };
        }
        let per_cosine = root.w.recip();
        let squared_tangent = root.v.dot(&root.v) * per_cosine * per_cosine;
        root.v * (squared_tangent.polynomial(&ARCTANGENT_RATIO) * per_cosine * 16.0)
    }
    pub(crate) fn inverse(&self) -> Self {
        Self { w: self.w, v: self.v * Jet::constant(-1.0) }
    }
    pub(crate) fn then(&self, other: &Self) -> Self {
        let (a, b) = (self, other);
        Self { w: a.w * b.w - a.v.dot(&b.v), v: b.v * a.w + a.v * b.w + a.v.cross(&b.v) }
    }
    pub(crate) fn turn(&self, x: &JetVector) -> JetVector {
        let u = self.v.cross(x) * Jet::constant(2.0);
        *x + u * self.w + self.v.cross(&u)
    }
    pub(crate) fn value(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::new_normalize(Quaternion::from_parts(self.w.value(), self.v.derivative(0)))
    }
    /// The body rate ω = 2·q⁻¹q̇ with its first two derivatives.
    pub(crate) fn rate(&self) -> JetVector {
        let slope = Self { w: self.w.slope(), v: JetVector(self.v.0.map(|x| x.slope())) };
        self.inverse().then(&slope).v * Jet::constant(2.0)
    }
}
