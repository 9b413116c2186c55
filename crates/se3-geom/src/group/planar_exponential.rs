//! The exponential of the plane's similarities as maps τ ↦ m·τ + t of complex numbers: exp(v, z) = (t = φ(z)·v, m = e^z) with
//! z = σ + iω and φ(z) = (e^z − 1)/z. SE(2) is the part with σ = 0.

use nalgebra::{Complex, Matrix2, UnitComplex, Vector2};

/// Below it |z|² might underflow where φ divides by z; three terms of its series leave |z|³/24 < 1e-25.
const TINY: f64 = 1e-8;
/// φ′ = (e^z − φ)/z divides a difference of about z/2 by z and loses log₂(2/|z|) bits: one at the switch.
const SERIES_RADIUS: f64 = 1.0;
/// The first term of the series of φ′ left out, of z¹⁸, is below 19/20! ≈ 8e-18 inside that radius.
const SERIES_TERMS: u32 = 17;

/// e^z − 1, without cancellation near z = 0: e^σcos ω − 1 = (e^σ − 1)cos ω − 2sin²(ω/2).
fn exp_minus_one(z: Complex<f64>) -> Complex<f64> {
    let (half_sine, half_cosine) = (0.5 * z.im).sin_cos();
    let (growth, fall) = (z.re.exp_m1(), 2.0 * half_sine * half_sine);
    Complex::new(growth * (1.0 - fall) - fall, z.re.exp() * 2.0 * half_sine * half_cosine)
}

/// φ(z) = (e^z − 1)/z = Σ zᵏ/(k+1)!.
pub(super) fn phi(z: Complex<f64>) -> Complex<f64> {
    if z.l1_norm() < TINY { z * z / 6.0 + z * 0.5 + 1.0 } else { exp_minus_one(z) / z }
}

/// φ′(z) = (e^z − φ(z))/z = Σ (k+1)·zᵏ/(k+2)!.
fn phi_derivative(z: Complex<f64>) -> Complex<f64> {
    if z.norm() >= SERIES_RADIUS {
        return (z.exp() - phi(z)) / z;
    }
    // The ratio of successive terms is z·(k+2)/((k+1)(k+3)).
    (0..SERIES_TERMS).rev().fold(Complex::new(0.5, 0.0), |sum, k| {
        let k = f64::from(k);
        z * sum * ((k + 2.0) / ((k + 1.0) * (k + 3.0))) + 0.5
    })
}

/// 1/φ(log m) for m = scale·rotation, z = log m. From m itself: e^z − 1 = m − 1, with cos ω − 1 = −sin²ω/(1 + cos ω).
pub(super) fn inverse_phi_of(scale: f64, rotation: &UnitComplex<f64>, z: Complex<f64>) -> Complex<f64> {
    if z.l1_norm() < TINY {
        return z * z / 12.0 - z * 0.5 + 1.0;
    }
    let (cosine, sine) = (rotation.re, rotation.im);
    let fall = if cosine > 0.0 { sine * sine / (1.0 + cosine) } else { 1.0 - cosine };
    z / Complex::new((scale - 1.0) * cosine - fall, scale * sine)
}

/// The top rows of Jl(v, z) = \[φ, φ′v − φv; 0, 1\]: what δv and δz are multiplied by.
pub(super) fn left_jacobian_row(v: Complex<f64>, z: Complex<f64>) -> [Complex<f64>; 2] {
    let phi = phi(z);
    [phi, (phi_derivative(z) - phi) * v]
}

/// The top rows of Jl(v, z)⁻¹ = \[1/φ, v − φ′v/φ; 0, 1\].
pub(super) fn left_jacobian_inverse_row(v: Complex<f64>, z: Complex<f64>) -> [Complex<f64>; 2] {
    let inverse = phi(z).inv();
    [inverse, v - phi_derivative(z) * inverse * v]
}

pub(super) fn complex(v: &Vector2<f64>) -> Complex<f64> {
    Complex::new(v.x, v.y)
}

pub(super) fn vector(z: Complex<f64>) -> Vector2<f64> {
    Vector2::new(z.re, z.im)
}

/// The real matrix of a multiplication by z.
pub(super) fn multiplication(z: Complex<f64>) -> Matrix2<f64> {
    Matrix2::new(z.re, -z.im, z.im, z.re)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Series and quotient share no formula but φ. Just within the switch, where the quotient has lost one bit, all of the
    /// series' terms count: its last two are 18/19! ≈ 1.5e-16 and 17/18! ≈ 2.7e-15.
    #[test]
    fn the_series_of_the_slope_is_its_quotient_at_the_switch() {
        for k in 0..16 {
            let z = Complex::from_polar(0.999_999, std::f64::consts::FRAC_PI_8 * f64::from(k));
            let quotient = (z.exp() - phi(z)) / z;
            // Terms of at most e, with a rounding of ε/2 each for e^z, φ and the difference.
            assert!((phi_derivative(z) - quotient).norm() < 1.5 * std::f64::consts::E * f64::EPSILON, "{z}");
        }
        // Σ (k+1)/(k+2)! = 1: the slope at 1 is e − (e − 1).
        assert!((phi_derivative(Complex::new(1.0 - f64::EPSILON, 0.0)).re - 1.0).abs() < 2.0 * f64::EPSILON);
        assert_eq!(phi_derivative(Complex::new(0.0, 0.0)).re, 0.5);
    }
}
