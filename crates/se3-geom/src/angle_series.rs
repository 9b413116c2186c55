//! The even functions of an angle that rotations are made of, accurate at every angle.
//!
//! With x = θ²: a = sin θ/θ, b = (1 − cos θ)/θ², c = (θ − sin θ)/θ³ and their derivatives by x, doubled:
//! f_s = (1/θ) df/dθ = 2 df/dx. All are entire in x. The quotients lose digits by cancellation for small θ, the power series by
//! alternation for large θ; at the switch, x = 4, both keep 15 digits (the largest term of a series is below 1 there, and its
//! 14th term is below 4¹⁴/30! ≈ 1e-24).

const SWITCH: f64 = 4.0;
const TERMS: usize = 14;

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

/// Σₖ (−x)ᵏ/(2k + first)! with its first two derivatives by x times 2 and 4.
fn alternating_series(x: f64, first: usize) -> [f64; 3] {
    // Horner in the ratio of successive terms, differentiated along.
    let (mut f, mut df, mut ddf) = (0.0, 0.0, 0.0);
    for k in (0..TERMS).rev() {
        // f_k = 1 − x/((2k+first+1)(2k+first+2)) · f_{k+1}
        let ratio = -1.0 / (((2 * k + first + 1) * (2 * k + first + 2)) as f64);
        ddf = ratio * (2.0 * df + x * ddf);
        df = ratio * (f + x * df);
        f = 1.0 + ratio * x * f;
    }
    let leading: f64 = (1..=first).map(|i| i as f64).product::<f64>().recip();
    [f * leading, 2.0 * df * leading, 4.0 * ddf * leading]
}

impl AngleSeries {
    pub(crate) fn at_squared_angle(x: f64) -> Self {
        if x < SWITCH {
            let [b, b_s, b_ss] = alternating_series(x, 2);
            let [c, c_s, c_ss] = alternating_series(x, 3);
            return Self { b, c, b_s, c_s, b_ss, c_ss };
        }
        let theta = x.sqrt();
        let a = theta.sin() / theta;
        let b = (1.0 - theta.cos()) / x;
        let c = (1.0 - a) / x;
        let b_s = (a - 2.0 * b) / x;
        let c_s = (b - 3.0 * c) / x;
        Self { b, c, b_s, c_s, b_ss: (c - b - 4.0 * b_s) / x, c_ss: (b_s - 5.0 * c_s) / x }
    }
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
const HALF_ANGLE_TERMS: usize = 11;
const SECOND: [f64; HALF_ANGLE_TERMS] = stumpff_coefficients(2);
const THIRD: [f64; HALF_ANGLE_TERMS] = stumpff_coefficients(3);

/// (−1)ᵏ/(2k + first)!: the coefficients of the Stumpff function c_first(x), with c₀ = cos √x and cₙ = 1/n! − x·cₙ₊₂.
const fn stumpff_coefficients<const N: usize>(first: usize) -> [f64; N] {
    let mut coefficients = [0.0; N];
    let (mut k, mut factorial, mut reached) = (0, 1.0, 0);
    while k < N {
        while reached < 2 * k + first {
            reached += 1;
            factorial *= reached as f64;
        }
        coefficients[k] = if k % 2 == 0 { 1.0 / factorial } else { -1.0 / factorial };
        k += 1;
    }
    coefficients
}

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

/// Even and odd terms apart: two chains half as long, which the processor runs side by side.
#[inline]
fn polynomial<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let square = x * x;
    let chain = |first: usize| coefficients.iter().skip(first).step_by(2).rev().fold(0.0, |sum, c| sum * square + c);
    chain(0) + x * chain(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both branches at the same x, just on either side of the switch: a wrong sign or factor in one of them cannot hide.
    #[test]
    fn branches_agree_at_the_switch() {
        let (below, above) = (SWITCH * (1.0 - 1e-15), SWITCH);
        let (s, q) = (AngleSeries::at_squared_angle(below), AngleSeries::at_squared_angle(above));
        for (name, u, v) in [
            ("b", s.b, q.b),
            ("c", s.c, q.c),
            ("b_s", s.b_s, q.b_s),
            ("c_s", s.c_s, q.c_s),
            ("b_ss", s.b_ss, q.b_ss),
            ("c_ss", s.c_ss, q.c_ss),
        ] {
            // The quotient form of the second derivatives divides a few roundings of O(0.1) by x² = 16.
            assert!((u - v).abs() < 2e-16 + 2e-15 * v.abs().max(0.02), "{name}: {u} {v}");
        }
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
