use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::{LieGroup, NoLogarithm};
use crate::angle_series::{HalfAngle, JacobianCoefficients, inverse_jacobian_coefficient};

/// The rotation group SO(3); algebra elements are rotation vectors ω in rad.
///
/// exp(ω) = (cos θ/2, ω·sin(θ/2)/θ) as a quaternion, θ = ‖ω‖ (Rodrigues). log has θ in \[0, π\] and is as accurate at 0 and at π
/// as in between, because its angle is 2·arctan of the quotient of the sine and the cosine of θ/2.
///
/// Jl(ω) = a·I + b·\[ω\] + c·ωωᵀ with a = sin θ/θ, b = (1 − cos θ)/θ², c = (1 − a)/θ²;
/// Jl(ω)⁻¹ = e·I − ½\[ω\] + d·ωωᵀ with e = (θ/2)·cot(θ/2), d = (1 − e)/θ² (Barfoot, *State Estimation for Robotics*, §7.1.5;
/// the thesis' appendix D without its pole at π).
///
/// ```
/// use se3_geom::{LieGroup, So3Group, nalgebra::Vector3};
/// let quarter = So3Group::exp(Vector3::z() * std::f64::consts::FRAC_PI_2);
/// assert!((So3Group::act(&quarter, &Vector3::x()) - Vector3::y()).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct So3Group;

impl LieGroup for So3Group {
    type Element = UnitQuaternion<f64>;
    type Algebra = Vector3<f64>;
    type AlgebraMap = Matrix3<f64>;
    type Point = Vector3<f64>;

    fn identity() -> Self::Element {
        UnitQuaternion::identity()
    }
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element {
        a * b
    }
    fn inverse(a: &Self::Element) -> Self::Element {
        a.inverse()
    }
    #[inline]
    fn exp(v: Vector3<f64>) -> Self::Element {
        rotation_of(v, &HalfAngle::of_squared_angle(v.norm_squared()))
    }
    #[inline]
    fn log(a: &Self::Element) -> Result<Vector3<f64>, NoLogarithm> {
        Ok(logarithm(a.w, a.imag())?.rotation_vector)
    }
    fn adjoint(a: &Self::Element) -> Matrix3<f64> {
        a.to_rotation_matrix().into_inner()
    }
    fn left_jacobian(v: Vector3<f64>) -> Matrix3<f64> {
        let JacobianCoefficients { a, b, c } = HalfAngle::of_squared_angle(v.norm_squared()).jacobian_coefficients();
        isotropic(a, b, c, &v)
    }
    fn left_jacobian_inverse(v: Vector3<f64>) -> Matrix3<f64> {
        let squared_angle = v.norm_squared();
        let e = HalfAngle::of_squared_angle(squared_angle).half_angle_by_tangent();
        isotropic(e, -0.5, inverse_jacobian_coefficient(squared_angle, e), &v)
    }
    fn act(a: &Self::Element, x: &Vector3<f64>) -> Vector3<f64> {
        a * x
    }
}

#[inline]
pub(super) fn rotation_of(v: Vector3<f64>, half: &HalfAngle) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::from_parts(half.cosine, v * half.sine_by_angle))
}

/// A logarithm, with the number that its Jacobian needs.
pub(crate) struct Logarithm {
    pub(crate) rotation_vector: Vector3<f64>,
    /// (θ/2)·cot(θ/2)
    pub(super) half_angle_by_tangent: f64,
}

/// The logarithm of the rotation with quaternion w + v, of any positive norm.
#[inline]
pub(crate) fn logarithm(w: f64, v: Vector3<f64>) -> Result<Logarithm, NoLogarithm> {
    // q and −q are the same rotation; the one with w ≥ 0 has the angle below π.
    let (w, v) = if w < 0.0 { (-w, -v) } else { (w, v) };
    let sine = v.norm();
    // The quotient is infinite at half a turn, and its arctangent right there too.
    // What bounds the time of a logarithm is a root, two divisions and an arctangent, one after the other. A series after a
    // reduction by table took as long as the platform's arctangent.
    let angle_rad = 2.0 * (sine / w.abs()).atan();
    let size = sine + w;
    if !(size > 0.0 && size.is_finite()) {
        return Err(NoLogarithm { angle_rad, scale: 1.0 });
    }
    // The square of a sine below 1e-162 underflows; the angle is twice the sine there to 300 digits.
    let angle_by_sine = if sine > 0.0 { angle_rad / sine } else { 2.0 / w };
    Ok(Logarithm { rotation_vector: v * angle_by_sine, half_angle_by_tangent: 0.5 * angle_by_sine * w })
}

/// p·I + q·\[v\] + r·vvᵀ.
pub(super) fn isotropic(p: f64, q: f64, r: f64, v: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(p) + v.cross_matrix() * q + v * (v.transpose() * r)
}

/// The same matrix applied to a vector: p·x + q·(v × x) + r·(v·x)·v.
#[inline]
pub(super) fn apply_isotropic(p: f64, q: f64, r: f64, v: &Vector3<f64>, x: &Vector3<f64>) -> Vector3<f64> {
    x * p + v.cross(x) * q + v * (r * v.dot(x))
}
