use nalgebra::{Complex, Matrix4, Similarity2, Vector2};

use super::planar_exponential::{
    complex, inverse_phi_of, left_jacobian_inverse_row, left_jacobian_row, multiplication, phi, vector,
};
use super::{LieGroup, NoLogarithm, So2Group};
use crate::planar_twist::SimilarityTwist;

/// The group Sim(2) of the plane's similarities x ↦ s·R(θ)·x + t (thesis §4.6); maps on its algebra act on (vx, vy, ω, σ).
///
/// With the plane as complex numbers and z = σ + iω, exp(v, z) = (t, s·e^{iθ}) = (φ(z)·v, e^z) with φ(z) = (e^z − 1)/z: points
/// move on logarithmic spirals. This is the group's own exponential, not the product of SE(2) with scales.
///
/// Ad(t, m) = \[m, −t; 0, 1\]; Jl = \[φ, (φ′ − φ)v; 0, 1\] on (v, z).
///
/// ```
/// use se3_geom::{LieGroup, Sim2Group, SimilarityTwist, nalgebra::Vector2};
/// let doubling = Sim2Group::exp(SimilarityTwist::new(Vector2::x(), 0.0, 2f64.ln()));
/// let expected = Vector2::x() / 2f64.ln(); // (e^σ − 1)/σ with e^σ = 2
/// assert!((Sim2Group::act(&doubling, &Vector2::zeros()) - expected).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sim2Group;

impl LieGroup for Sim2Group {
    type Element = Similarity2<f64>;
    type Algebra = SimilarityTwist;
    type AlgebraMap = Matrix4<f64>;
    type Point = Vector2<f64>;

    fn identity() -> Self::Element {
        Similarity2::identity()
    }
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element {
        a * b
    }
    fn inverse(a: &Self::Element) -> Self::Element {
        a.inverse()
    }
    /// A scale e^σ too small for a number (σ < −708) is held at the smallest: a similarity has a positive scale.
    fn exp(v: SimilarityTwist) -> Self::Element {
        let translation = vector(phi(v.rate()) * complex(&v.linear));
        let scale = v.scaling.exp();
        let scale = if scale == 0.0 { f64::MIN_POSITIVE } else { scale };
        Similarity2::from_parts(translation.into(), So2Group::exp(v.angular), scale)
    }
    fn log(a: &Self::Element) -> Result<SimilarityTwist, NoLogarithm> {
        let (rotation, scale) = (&a.isometry.rotation, a.scaling());
        let angular = So2Group::log(rotation).map_err(|error| NoLogarithm { scale, ..error })?;
        let scaling = scale.ln();
        let inverse_phi = inverse_phi_of(scale, rotation, Complex::new(scaling, angular));
        let linear = vector(inverse_phi * complex(&a.isometry.translation.vector));
        if !(scaling.is_finite() && linear.iter().all(|x| x.is_finite())) {
            return Err(NoLogarithm { angle_rad: angular, scale });
        }
        Ok(SimilarityTwist { linear, angular, scaling })
    }
    fn adjoint(a: &Self::Element) -> Matrix4<f64> {
        let rotation = &a.isometry.rotation;
        let m = Complex::new(rotation.re, rotation.im) * a.scaling();
        with_top_rows([m, -complex(&a.isometry.translation.vector)])
    }
    fn left_jacobian(v: SimilarityTwist) -> Matrix4<f64> {
        with_top_rows(left_jacobian_row(complex(&v.linear), v.rate()))
    }
    fn left_jacobian_inverse(v: SimilarityTwist) -> Matrix4<f64> {
        with_top_rows(left_jacobian_inverse_row(complex(&v.linear), v.rate()))
    }
    fn act(a: &Self::Element, x: &Vector2<f64>) -> Vector2<f64> {
        a.isometry.rotation * (x * a.scaling()) + a.isometry.translation.vector
    }
}

impl SimilarityTwist {
    /// z = σ + iω.
    fn rate(&self) -> Complex<f64> {
        Complex::new(self.scaling, self.angular)
    }
}

/// The matrix of (v, ω, σ) ↦ (m·v + k·(σ + iω), ω, σ).
fn with_top_rows([m, k]: [Complex<f64>; 2]) -> Matrix4<f64> {
    let mut matrix = Matrix4::identity();
    matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(&multiplication(m));
    matrix.fixed_view_mut::<2, 1>(0, 2).copy_from(&vector(Complex::<f64>::i() * k));
    matrix.fixed_view_mut::<2, 1>(0, 3).copy_from(&vector(k));
    matrix
}
