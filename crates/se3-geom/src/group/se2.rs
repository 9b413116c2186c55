use nalgebra::{Complex, Isometry2, Matrix3, Vector2};

use super::planar_exponential::{
    complex, inverse_phi_of, left_jacobian_inverse_row, left_jacobian_row, multiplication, phi, vector,
};
use super::{LieGroup, NoLogarithm, So2Group};
use crate::planar_twist::PlanarTwist;

/// The group SE(2) of rigid motions of the plane; algebra elements are planar twists, maps on them act on (vx, vy, ω).
///
/// With the plane as complex numbers, exp(v, ω) = (t, θ) = (φ(iω)·v, ω) with φ(z) = (e^z − 1)/z: the point moves on a circular
/// arc. It is not the geodesic of the product metric, a straight line.
///
/// Ad(t, θ) = \[R(θ), −it; 0, 1\]; Jl = \[φ, i(φ′ − φ)v; 0, 1\] with φ at iω.
///
/// ```
/// use se3_geom::{LieGroup, PlanarTwist, Se2Group, nalgebra::Vector2};
/// let half_circle = Se2Group::exp(PlanarTwist::new(Vector2::x(), std::f64::consts::PI));
/// assert!((half_circle.translation.vector - Vector2::y() * std::f64::consts::FRAC_2_PI).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Se2Group;

impl LieGroup for Se2Group {
    type Element = Isometry2<f64>;
    type Algebra = PlanarTwist;
    type AlgebraMap = Matrix3<f64>;
    type Point = Vector2<f64>;

    fn identity() -> Self::Element {
        Isometry2::identity()
    }
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element {
        a * b
    }
    fn inverse(a: &Self::Element) -> Self::Element {
        a.inverse()
    }
    fn exp(v: PlanarTwist) -> Self::Element {
        let translation = vector(phi(Complex::new(0.0, v.angular)) * complex(&v.linear));
        Isometry2::from_parts(translation.into(), So2Group::exp(v.angular))
    }
    fn log(a: &Self::Element) -> Result<PlanarTwist, NoLogarithm> {
        let angular = So2Group::log(&a.rotation)?;
        let inverse_phi = inverse_phi_of(1.0, &a.rotation, Complex::new(0.0, angular));
        let linear = vector(inverse_phi * complex(&a.translation.vector));
        if !linear.iter().all(|x| x.is_finite()) {
            return Err(NoLogarithm { angle_rad: angular, scale: 1.0 });
        }
        Ok(PlanarTwist { linear, angular })
    }
    fn adjoint(a: &Self::Element) -> Matrix3<f64> {
        let t = a.translation.vector;
        with_top_rows([Complex::new(a.rotation.re, a.rotation.im), -complex(&t)])
    }
    fn left_jacobian(v: PlanarTwist) -> Matrix3<f64> {
        with_top_rows(left_jacobian_row(complex(&v.linear), Complex::new(0.0, v.angular)))
    }
    fn left_jacobian_inverse(v: PlanarTwist) -> Matrix3<f64> {
        with_top_rows(left_jacobian_inverse_row(complex(&v.linear), Complex::new(0.0, v.angular)))
    }
    fn act(a: &Self::Element, x: &Vector2<f64>) -> Vector2<f64> {
        a.rotation * x + a.translation.vector
    }
}

/// The matrix of (v, ω) ↦ (m·v + k·iω, ω).
fn with_top_rows([m, k]: [Complex<f64>; 2]) -> Matrix3<f64> {
    let mut matrix = Matrix3::identity();
    matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(&multiplication(m));
    matrix.fixed_view_mut::<2, 1>(0, 2).copy_from(&vector(Complex::<f64>::i() * k));
    matrix
}
