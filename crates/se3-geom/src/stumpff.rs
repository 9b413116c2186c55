//! The Stumpff functions cₙ(x) = Σₖ (−x)ᵏ/(2k + n)!, of which everything about a rotation by θ is made, with x = θ².
//!
//! c₀ = cos θ, c₁ = sin θ/θ, c₂ = (1 − cos θ)/θ², c₃ = (θ − sin θ)/θ³, and cₙ = 1/n! − x·cₙ₊₂, so that two of them give all
//! lower ones by going down, without a division by x and without a sine. Their slopes are (1/θ) dcₙ/dθ = n·cₙ₊₂ − cₙ₊₁.
//! Source: Stumpff, *Himmelsmechanik I* (1959), §41.

/// The first coefficients of cₙ, n = `order`, by ascending powers of x: (−1)ᵏ/(2k + n)!.
pub(crate) const fn stumpff<const TERMS: usize>(order: usize) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    let (mut k, mut factorial, mut reached) = (0, 1.0, 0);
    while k < TERMS {
        while reached < 2 * k + order {
            reached += 1;
            factorial *= reached as f64;
        }
        coefficients[k] = if k % 2 == 0 { 1.0 / factorial } else { -1.0 / factorial };
        k += 1;
    }
    coefficients
}

/// Even and odd terms apart: two chains half as long, which the processor runs side by side.
#[inline]
pub(crate) fn polynomial<const TERMS: usize>(coefficients: &[f64; TERMS], x: f64) -> f64 {
    let square = x * x;
    let chain = |first: usize| coefficients.iter().skip(first).step_by(2).rev().fold(0.0, |sum, c| sum * square + c);
    chain(0) + x * chain(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_functions_are_those_of_the_angle() {
        for theta in [0.1_f64, 0.7, 1.5, 2.0] {
            let x = theta * theta;
            let [c0, c1, c2, c3, c4, c5] = std::array::from_fn(|n| polynomial(&stumpff::<12>(n), x));
            let (sine, cosine) = theta.sin_cos();
            let quotients = [cosine, sine / theta, (1.0 - cosine) / x, (theta - sine) / (theta * x)];
            for (series, quotient) in [c0, c1, c2, c3].into_iter().zip(quotients) {
                // The quotients divide a rounding of 1 by θ³ at most.
                assert!((series - quotient).abs() < 4.0 * f64::EPSILON / theta.powi(3).min(1.0));
            }
            for (low, high) in [(c2, 0.5 - x * c4), (c3, 1.0 / 6.0 - x * c5)] {
                assert!((low - high).abs() < 2.0 * f64::EPSILON);
            }
        }
    }
}
