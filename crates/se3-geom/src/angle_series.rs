//! The even functions of an angle that rotations are made of, accurate at every angle.
//!
//! With x = θ²: a = sin θ/θ, b = (1 − cos θ)/θ², c = (θ − sin θ)/θ³ and their derivatives f_s = (1/θ) df/dθ = 2 df/dx. All are
//! entire in x. The quotients lose digits by cancellation for small θ, the power series by alternation for large θ.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::group::{LieGroup, So3Group};
use crate::stumpff::{polynomial, stumpff};

/// θ² below which the series serve: at 2 rad their largest term is below 1 and the quotients have lost nothing yet. A chart centred
/// at a segment's midpoint seldom goes further.
const SWITCH: f64 = 4.0;
/// Ten terms leave 4¹³/26! ≈ 2e-19 in cos θ at the switch.
const SIXTH: [f64; 10] = stumpff(6);
const SEVENTH: [f64; 10] = stumpff(7);

/// Coefficients of Jr and of its first two time derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AngleSeries {
    /// (1 − cos θ)/θ²
    pub(crate) b: f64,
    /// (θ − sin θ)/θ³
    pub(crate) c: f64,
    /// (1/θ) db/dθ
    pub(crate) b_s: f64,
    /// (1/θ) dc/dθ
    pub(crate) c_s: f64,
    /// (1/θ) db_s/dθ
    pub(crate) b_ss: f64,
    /// (1/θ) dc_s/dθ
    pub(crate) c_ss: f64,
}

impl AngleSeries {
    #[inline]
    pub(crate) fn at_squared_angle(x: f64) -> Self {
        if x < SWITCH { Self::by_series(x) } else { Self::by_quotients(x) }
    }

    /// b = c₂ and c = c₃, and their slopes by n·cₙ₊₂ − cₙ₊₁, twice.
    #[inline]
    fn by_series(x: f64) -> Self {
        let (c6, c7) = (polynomial(&SIXTH, x), polynomial(&SEVENTH, x));
        let (c4, c5) = (1.0 / 24.0 - x * c6, 1.0 / 120.0 - x * c7);
        Self {
            b: 0.5 - x * c4,
            c: 1.0 / 6.0 - x * c5,
            b_s: 2.0 * c4 - (1.0 / 6.0 - x * c5),
            c_s: 3.0 * c5 - c4,
            b_ss: c4 - 5.0 * c5 + 8.0 * c6,
            c_ss: c5 - 7.0 * c6 + 15.0 * c7,
        }
    }

    #[cold]
    fn by_quotients(x: f64) -> Self {
        let theta = x.sqrt();
        let a = theta.sin() / theta;
        let b = (1.0 - theta.cos()) / x;
        let c = (1.0 - a) / x;
        let b_s = (a - 2.0 * b) / x;
        let c_s = (b - 3.0 * c) / x;
        Self { b, c, b_s, c_s, b_ss: (c - b - 4.0 * b_s) / x, c_ss: (b_s - 5.0 * c_s) / x }
    }

    /// Exp(φ), given the functions at x = φ·φ.
    #[inline]
    pub(crate) fn rotation(&self, phi: &Vector3<f64>, x: f64) -> UnitQuaternion<f64> {
        if x >= SWITCH {
            return far_rotation(phi);
        }
        let (cosine, sine_by_angle) = (1.0 - x * self.b, 1.0 - x * self.c);
        // cos(θ/2) ≥ 0.54 here, so that the half angle costs no digits.
        let half_cosine = (0.5 * (1.0 + cosine)).sqrt();
        let imaginary = phi * (0.5 * sine_by_angle / half_cosine);
        UnitQuaternion::new_unchecked(Quaternion::from_parts(half_cosine, imaginary))
    }
}

/// Apart, so that what seldom happens does not stand in the way of what mostly does.
#[cold]
fn far_rotation(phi: &Vector3<f64>) -> UnitQuaternion<f64> {
    So3Group::exp(*phi)
}

/// What a rotation and its first-order maps are made of: functions of half an angle, without cancellation at any angle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfAngle {
    /// sin(θ/2)/θ
    pub(crate) sine_by_angle: f64,
    /// cos(θ/2)
    pub(crate) cosine: f64,
    /// (θ − sin θ)/θ³
    c: f64,
}

/// Jl(ω) = a·I + b·\[ω\] + c·ωωᵀ.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JacobianCoefficients {
    /// sin θ/θ
    pub(crate) a: f64,
    /// (1 − cos θ)/θ²
    pub(crate) b: f64,
    /// (θ − sin θ)/θ³
    pub(crate) c: f64,
}

/// θ² below which half-angle functions come from series: a little above π², so that every principal angle is served without a
/// root, a quotient or a sine. Terms stay below 1.3 in size up to there, so that alternation costs no digit.
const HALF_ANGLE_SWITCH: f64 = 10.0;
/// At the switch the first term left out is 2.5¹¹/24! ≈ 4e-20.
const SECOND: [f64; 11] = stumpff(2);
const THIRD: [f64; 11] = stumpff(3);

impl HalfAngle {
    #[inline]
    pub(crate) fn of_squared_angle(x: f64) -> Self {
        if x < HALF_ANGLE_SWITCH {
            let y = 0.25 * x;
            let (c2, c3) = (polynomial(&SECOND, y), polynomial(&THIRD, y));
            let cosine = 1.0 - y * c2;
            // The last by doubling: 4·c₃(4y) = c₂(y) + c₀(y)·c₃(y).
            return Self { sine_by_angle: 0.5 - 0.5 * y * c3, cosine, c: 0.25 * (c2 + cosine * c3) };
        }
        let angle = x.sqrt();
        let (sine, cosine) = (0.5 * angle).sin_cos();
        let sine_by_angle = sine / angle;
        Self { sine_by_angle, cosine, c: (1.0 - 2.0 * sine_by_angle * cosine) / x }
    }

    #[inline]
    pub(crate) fn jacobian_coefficients(&self) -> JacobianCoefficients {
        let a = 2.0 * self.sine_by_angle * self.cosine;
        let b = 2.0 * self.sine_by_angle * self.sine_by_angle;
        JacobianCoefficients { a, b, c: self.c }
    }

    /// e = (θ/2)·cot(θ/2).
    pub(crate) fn half_angle_by_tangent(&self) -> f64 {
        0.5 * self.cosine / self.sine_by_angle
    }
}

const INVERSE_SWITCH: f64 = 0.25;

/// d = (1 − e)/θ², the coefficient of ωωᵀ in Jl⁻¹ and of \[ω\]² in it, given x = θ² and e = (θ/2)·cot(θ/2): smooth on (0, 2π),
/// where the thesis' appendix D divides by zero at π.
pub(crate) fn inverse_jacobian_coefficient(x: f64, e: f64) -> f64 {
    // (1 − e)/θ² divides a difference of about θ²/12 by θ², and at θ = 1/2 has lost five bits (its contribution to Jl⁻¹, θ² times as
    // large, none). Below, Σ |B₂ₖ|/(2k)! xᵏ⁻¹; the ninth term is below 0.25⁸·9e-15 ≈ 1e-19 at the switch.
    const D: [f64; 8] = [
        1.0 / 12.0,
        1.0 / 720.0,
        1.0 / 30240.0,
        1.0 / 1_209_600.0,
        1.0 / 47_900_160.0,
        691.0 / 1_307_674_368_000.0,
        1.0 / 74_724_249_600.0,
        3617.0 / 10_670_622_842_880_000.0,
    ];
    if x < INVERSE_SWITCH { polynomial(&D, x) } else { (1.0 - e) / x }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both ways at the same angles, on either side of the switch: they share no formula, so a wrong sign or factor shows.
    #[test]
    fn series_and_quotients_agree() {
        for angle in [1.3, 1.9, 1.999_999, 2.0, 2.000_001, 2.1] {
            let phi = Vector3::new(0.6, -0.48, 0.64) * angle;
            let x = phi.norm_squared();
            let (s, q) = (AngleSeries::by_series(x), AngleSeries::by_quotients(x));
            for (name, u, v) in [
                ("b", s.b, q.b),
                ("c", s.c, q.c),
                ("b_s", s.b_s, q.b_s),
                ("c_s", s.c_s, q.c_s),
                ("b_ss", s.b_ss, q.b_ss),
                ("c_ss", s.c_ss, q.c_ss),
            ] {
                // A few roundings of the largest term, which is below 0.1 or 1/k! of the function's own series; the quotient form of
                // the second derivatives divides as many by x² > 2.
                assert!((u - v).abs() < 2e-16 + 2e-15 * v.abs().max(0.02), "{name} at {angle}: {u} {v}");
            }
        }
    }

    #[test]
    fn a_chart_has_the_rotation_of_the_exponential() {
        for angle in [0.0, 1e-200, 1e-8, 0.1, 0.7, 1.3, 1.9, 1.999_999, 2.000_001, 3.0] {
            let phi = Vector3::new(0.6, -0.48, 0.64) * angle;
            let x = phi.norm_squared();
            let rotation = AngleSeries::at_squared_angle(x).rotation(&phi, x);
            assert!((rotation.coords - So3Group::exp(phi).coords).norm() < 4.0 * f64::EPSILON, "{angle}");
        }
    }

    #[test]
    fn branches_agree_at_the_switches() {
        let d_at = |x: f64| inverse_jacobian_coefficient(x, HalfAngle::of_squared_angle(x).half_angle_by_tangent());
        let (d, d_far) = (d_at(INVERSE_SWITCH * (1.0 - 1e-15)), d_at(INVERSE_SWITCH));
        // Two roundings of e, divided by x = 1/4.
        assert!((d - d_far).abs() < 8.0 * f64::EPSILON, "{d} {d_far}");
        let [near, far] = [HALF_ANGLE_SWITCH * (1.0 - 1e-15), HALF_ANGLE_SWITCH].map(HalfAngle::of_squared_angle);
        // Terms of size 1.3: a few roundings, and x differs by five of them.
        assert!((near.cosine - far.cosine).abs() < 8.0 * f64::EPSILON);
        assert!((near.sine_by_angle - far.sine_by_angle).abs() < 4.0 * f64::EPSILON);
        assert!((near.c - far.c).abs() < 2.0 * f64::EPSILON);
    }

    /// d = −b_s/(2b), of functions that lose no digits at any angle.
    #[test]
    fn the_inverse_coefficient_keeps_its_digits() {
        for x in [0.0, 1e-200, 1e-12, 1e-7, 1e-5, 1e-3, 0.01, 0.1, 0.2, 0.24, 0.26, 0.5, 2.0, 3.9, 5.0, 9.0] {
            let d = inverse_jacobian_coefficient(x, HalfAngle::of_squared_angle(x).half_angle_by_tangent());
            let series = AngleSeries::at_squared_angle(x);
            // Of sizes 0.08 to 0.2: a few of their roundings; from half a radian on also two of e ≤ 1, divided by x.
            let rounding = if x < 0.25 { 0.0 } else { 1.0 / x };
            assert!((d + series.b_s / (2.0 * series.b)).abs() < f64::EPSILON * (0.5 + rounding), "{x}: {d}");
        }
    }

    #[test]
    fn half_angle_functions_equal_the_series() {
        for x in [1e-12, 0.1, 0.3, 2.0, 3.9, 4.1, 9.0, 20.0] {
            let (half, series) =
                (HalfAngle::of_squared_angle(x).jacobian_coefficients(), AngleSeries::at_squared_angle(x));
            assert!((half.b - series.b).abs() < 4.0 * f64::EPSILON, "b at {x}");
            assert!((half.c - series.c).abs() < 4.0 * f64::EPSILON, "c at {x}");
            assert!((half.a - (1.0 - x * series.c)).abs() < 4.0 * f64::EPSILON * (1.0 + x), "a at {x}");
        }
    }

    #[test]
    fn derivatives_are_slopes_of_the_functions() {
        for x in [1e-6_f64, 0.3, 2.0, 3.9, 4.1, 9.0, 20.0] {
            let h: f64 = 1e-5 * (1.0 + x);
            let (lo, mid, hi) = (
                AngleSeries::at_squared_angle(x - h.min(x)),
                AngleSeries::at_squared_angle(x),
                AngleSeries::at_squared_angle(x + h),
            );
            let span = h + h.min(x);
            // Central differences: truncation h²/6·f''' < 1e-10, rounding 1e-16/h < 1e-11.
            for (name, f0, f1, slope) in [
                ("b", lo.b, hi.b, mid.b_s),
                ("c", lo.c, hi.c, mid.c_s),
                ("b_s", lo.b_s, hi.b_s, mid.b_ss),
                ("c_s", lo.c_s, hi.c_s, mid.c_ss),
            ] {
                let difference = 2.0 * (f1 - f0) / span;
                // one-sided at x = 1e-6: first order
                let tolerance = if x < h { 1e-6 } else { 1e-9 };
                assert!((difference - slope).abs() < tolerance, "{name} at {x}: {difference} {slope}");
            }
        }
    }
}
