use nalgebra::{Isometry3, Matrix3, Matrix6, Vector3};

use super::so3::{Logarithm, apply_isotropic, logarithm, rotation_of};
use super::{LieGroup, NoLogarithm, So3Group};
use crate::angle_series::{AngleSeries, HalfAngle, JacobianCoefficients, inverse_jacobian_coefficient};
use crate::twist::Twist;

/// The group SE(3) of rigid motions; algebra elements are twists (v, ω), maps on them act on 6-vectors (linear, angular).
///
/// exp is the screw motion (R, p) = (exp ω, Jl(ω)·v): the tool turns about a fixed axis in space while it slides along it. It is
/// not the geodesic of [`Se3`](crate::Se3), where the origin of the tool moves on a straight line.
///
/// Ad(R, p) = \[R, \[p\]R; 0, R\]; Jl = \[Jl(ω), Q; 0, Jl(ω)\] with Q of Barfoot, *State Estimation for Robotics*, eq. 7.86.
///
/// ```
/// use se3_geom::{LieGroup, Se3Group, Twist, nalgebra::Vector3};
/// // Half a turn about z while the origin sets off along x: the screw carries it round to (0, 2/π, 0).
/// let screw = Se3Group::exp(Twist::new(Vector3::x(), Vector3::z() * std::f64::consts::PI));
/// let expected = Vector3::y() * std::f64::consts::FRAC_2_PI;
/// assert!((screw.translation.vector - expected).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Se3Group;

impl LieGroup for Se3Group {
    type Element = Isometry3<f64>;
    type Algebra = Twist;
    type AlgebraMap = Matrix6<f64>;
    type Point = Vector3<f64>;

    fn identity() -> Self::Element {
        Isometry3::identity()
    }
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element {
        a * b
    }
    fn inverse(a: &Self::Element) -> Self::Element {
        a.inverse()
    }
    #[inline]
    fn exp(v: Twist) -> Self::Element {
        let half = HalfAngle::of_squared_angle(v.angular.norm_squared());
        let JacobianCoefficients { a, b, c } = half.jacobian_coefficients();
        let translation = apply_isotropic(a, b, c, &v.angular, &v.linear);
        Isometry3::from_parts(translation.into(), rotation_of(v.angular, &half))
    }
    #[inline]
    fn log(a: &Self::Element) -> Result<Twist, NoLogarithm> {
        let Logarithm { rotation_vector: angular, half_angle_by_tangent: e } =
            logarithm(a.rotation.w, a.rotation.imag())?;
        let d = inverse_jacobian_coefficient(angular.norm_squared(), e);
        let linear = apply_isotropic(e, -0.5, d, &angular, &a.translation.vector);
        if !linear.iter().all(|x| x.is_finite()) {
            return Err(NoLogarithm { angle_rad: angular.norm(), scale: 1.0 });
        }
        Ok(Twist { linear, angular })
    }
    fn adjoint(a: &Self::Element) -> Matrix6<f64> {
        let rotation = So3Group::adjoint(&a.rotation);
        block_upper(rotation, a.translation.vector.cross_matrix() * rotation)
    }
    fn left_jacobian(v: Twist) -> Matrix6<f64> {
        block_upper(So3Group::left_jacobian(v.angular), coupling(v))
    }
    fn left_jacobian_inverse(v: Twist) -> Matrix6<f64> {
        let diagonal = So3Group::left_jacobian_inverse(v.angular);
        block_upper(diagonal, -diagonal * coupling(v) * diagonal)
    }
    fn act(a: &Self::Element, x: &Vector3<f64>) -> Vector3<f64> {
        a.rotation * x + a.translation.vector
    }
}

/// Q of Barfoot's eq. 7.86; its coefficients are b_s and c_s of this crate's angle functions:
/// (θ² + 2cos θ − 2)/(2θ⁴) = (b_s + c)/2 and (2θ − 3sin θ + θcos θ)/(2θ⁵) = −c_s/2.
fn coupling(v: Twist) -> Matrix3<f64> {
    let s = AngleSeries::at_squared_angle(v.angular.norm_squared());
    let (phi, rho) = (v.angular.cross_matrix(), v.linear.cross_matrix());
    let phi_rho_phi = phi * rho * phi;
    rho * 0.5
        + (phi * rho + rho * phi + phi_rho_phi) * s.c
        + (phi * phi * rho + rho * phi * phi - phi_rho_phi * 3.0) * (0.5 * (s.b_s + s.c))
        - (phi_rho_phi * phi + phi * phi_rho_phi) * (0.5 * s.c_s)
}

/// \[diagonal, corner; 0, diagonal\].
fn block_upper(diagonal: Matrix3<f64>, corner: Matrix3<f64>) -> Matrix6<f64> {
    let mut m = Matrix6::zeros();
    m.fixed_view_mut::<3, 3>(0, 0).copy_from(&diagonal);
    m.fixed_view_mut::<3, 3>(3, 3).copy_from(&diagonal);
    m.fixed_view_mut::<3, 3>(0, 3).copy_from(&corner);
    m
}
