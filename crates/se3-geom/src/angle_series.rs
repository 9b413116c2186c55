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

/// d = (1 − (θ/2)·cot(θ/2))/θ², the coefficient of \[φ\]² in Jr⁻¹: smooth on (0, 2π), where the thesis' appendix D divides by zero at π.
pub(crate) fn inverse_jacobian_coefficient(x: f64) -> f64 {
    if x < 0.25 {
        // Bernoulli series Σ |B₂ₖ|/(2k)! xᵏ⁻¹ ; the ninth term is below x⁸·3e-16·… < 1e-20 at the switch.
        const D: [f64; 9] = [
            1.0 / 12.0,
            1.0 / 720.0,
            1.0 / 30240.0,
            1.0 / 1_209_600.0,
            1.0 / 47_900_160.0,
            691.0 / 1_307_674_368_000.0,
            1.0 / 74_724_249_600.0,
            3617.0 / 10_670_622_842_880_000.0,
            43867.0 / 5_109_094_217_170_944_000.0,
        ];
        return D.iter().rev().fold(0.0, |sum, d| sum * x + d);
    }
    let half = 0.5 * x.sqrt();
    (1.0 - half / half.tan()) / x
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
        let (u, v) = (inverse_jacobian_coefficient(0.25 - 1e-16), inverse_jacobian_coefficient(0.25));
        // 1 − cos-like cancellation: 0.02/0.25 loses a factor 50 of one rounding.
        assert!((u - v).abs() < 50.0 * f64::EPSILON, "{u} {v}");
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
