//! What a rotation chart needs of its angle, all from two short power series.
//!
//! With x = θ² and the Stumpff functions cₖ(x) = Σⱼ (−x)ʲ/(2j+k)!, which obey cₖ = 1/k! − x·cₖ₊₂:
//! sin θ/θ = c₁, b = (1 − cos θ)/θ² = c₂, c = (θ − sin θ)/θ³ = c₃, and with f_s = (1/θ) df/dθ
//! b_s = 2c₄ − c₃, c_s = 3c₅ − c₄, b_ss = c₄ − 5c₅ + 8c₆, c_ss = c₅ − 7c₆ + 15c₇. So c₆ and c₇ give everything by going down,
//! without a division by x and without a sine.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::angle_series::AngleSeries;
use crate::group::{LieGroup, So3Group};

/// Below 2 rad ten terms leave 4¹³/26! ≈ 2e-19 in cos θ. A chart centred at a segment's midpoint seldom goes further; if it
/// does, the general functions serve.
const SERIES_BELOW: f64 = 4.0;
const TERMS: usize = 10;

/// (−1)ʲ/(2j + first)!, j = 0, 1, …
const fn stumpff_coefficients(first: usize) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    let mut j = 0;
    while j < TERMS {
        let (mut factorial, mut i) = (1.0, 2);
        while i <= 2 * j + first {
            factorial *= i as f64;
            i += 1;
        }
        coefficients[j] = if j % 2 == 0 { 1.0 / factorial } else { -1.0 / factorial };
        j += 1;
    }
    coefficients
}

const SIXTH: [f64; TERMS] = stumpff_coefficients(6);
const SEVENTH: [f64; TERMS] = stumpff_coefficients(7);

/// Odd and even terms apart: two chains half as long, which the processor runs side by side.
#[inline]
fn polynomial(coefficients: &[f64; TERMS], x: f64) -> f64 {
    let square = x * x;
    let (mut even, mut odd) = (0.0, 0.0);
    let mut k = TERMS;
    while k > 0 {
        k -= 2;
        even = coefficients[k] + square * even;
        odd = coefficients[k + 1] + square * odd;
    }
    even + x * odd
}

/// The rotation Exp(φ) and the coefficients of Jr(φ) with its first two derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChartFunctions {
    pub(crate) rotation: UnitQuaternion<f64>,
    pub(crate) b: f64,
    pub(crate) c: f64,
    pub(crate) b_s: f64,
    pub(crate) c_s: f64,
    pub(crate) b_ss: f64,
    pub(crate) c_ss: f64,
}

impl ChartFunctions {
    #[inline]
    pub(crate) fn at(phi: &Vector3<f64>) -> Self {
        let x = phi.norm_squared();
        if x < SERIES_BELOW { Self::by_series(phi, x) } else { Self::by_quotients(phi, x) }
    }

    #[inline]
    fn by_series(phi: &Vector3<f64>, x: f64) -> Self {
        let (c6, c7) = (polynomial(&SIXTH, x), polynomial(&SEVENTH, x));
        let (c4, c5) = (1.0 / 24.0 - x * c6, 1.0 / 120.0 - x * c7);
        let (c2, c3) = (0.5 - x * c4, 1.0 / 6.0 - x * c5);
        let (cos, sinc) = (1.0 - x * c2, 1.0 - x * c3);
        // cos(θ/2) ≥ 0.54 here, so that the half angle costs no digits.
        let half_cos = (0.5 * (1.0 + cos)).sqrt();
        let imaginary = phi * (0.5 * sinc / half_cos);
        Self {
            rotation: UnitQuaternion::new_unchecked(Quaternion::from_parts(half_cos, imaginary)),
            b: c2,
            c: c3,
            b_s: 2.0 * c4 - c3,
            c_s: 3.0 * c5 - c4,
            b_ss: c4 - 5.0 * c5 + 8.0 * c6,
            c_ss: c5 - 7.0 * c6 + 15.0 * c7,
        }
    }

    #[cold]
    fn by_quotients(phi: &Vector3<f64>, x: f64) -> Self {
        let AngleSeries { b, c, b_s, c_s, b_ss, c_ss } = AngleSeries::at_squared_angle(x);
        Self { rotation: So3Group::exp(*phi), b, c, b_s, c_s, b_ss, c_ss }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both ways at the same angles, on either side of the switch: they share no formula, so a wrong sign or factor shows.
    #[test]
    fn series_and_quotients_agree() {
        for angle in [0.0, 1e-200, 1e-8, 0.1, 0.7, 1.3, 1.9, 1.999_999, 2.000_001, 2.1] {
            let phi = Vector3::new(0.6, -0.48, 0.64) * angle;
            let x = phi.norm_squared();
            let (s, q) = (ChartFunctions::by_series(&phi, x), ChartFunctions::by_quotients(&phi, x));
            // A few roundings of the largest term, which is 1/k! of the function's own series or below 0.1.
            assert!((s.rotation.coords - q.rotation.coords).norm() < 4.0 * f64::EPSILON);
            for (u, v) in [(s.b, q.b), (s.c, q.c), (s.b_s, q.b_s), (s.c_s, q.c_s), (s.b_ss, q.b_ss), (s.c_ss, q.c_ss)] {
                assert!((u - v).abs() < 1e-16 + 2e-15 * v.abs().max(0.02), "at {angle}: {u} {v}");
            }
        }
    }
}
