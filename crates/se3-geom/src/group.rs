//! Lie groups: composition and the group exponential, with no metric.

use nalgebra::{Isometry3, Matrix3, Matrix6, Quaternion, UnitQuaternion, Vector3};

use crate::angle_series::{AngleSeries, inverse_jacobian_coefficient};
use crate::manifold::CutLocus;
use crate::twist::Twist;

/// A matrix Lie group with its exponential. All operations are associated functions: a group has no metric to carry.
pub trait LieGroup: Copy {
    /// A group element.
    type Element: Clone;
    /// A Lie algebra element in coordinates.
    type Algebra: Copy;
    /// The matrix of a linear map on the algebra.
    type AlgebraMap;

    /// The neutral element.
    fn identity() -> Self::Element;
    /// The product ab.
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element;
    /// a⁻¹.
    fn inverse(a: &Self::Element) -> Self::Element;
    /// The group exponential.
    fn exp(v: Self::Algebra) -> Self::Element;
    /// The principal logarithm, with rotation angle below π.
    ///
    /// # Errors
    /// [`CutLocus`] at half a turn, where two logarithms are equally short.
    fn log(a: &Self::Element) -> Result<Self::Algebra, CutLocus>;
    /// Ad(a): a·exp(v)·a⁻¹ = exp(Ad(a)·v).
    fn adjoint(a: &Self::Element) -> Self::AlgebraMap;
    /// Jl(v): exp(v + δ) = exp(Jl(v)·δ)·exp(v) to first order in δ.
    fn left_jacobian(v: Self::Algebra) -> Self::AlgebraMap;
    /// Jr(v) = Jl(−v): exp(v + δ) = exp(v)·exp(Jr(v)·δ) to first order in δ.
    fn right_jacobian(v: Self::Algebra) -> Self::AlgebraMap;
}

/// The rotation group SO(3); algebra elements are rotation vectors in rad.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct So3Group;

/// The group SE(3) of rigid motions; algebra elements are twists (v, ω), and exp is the screw motion (R, p) = (Exp ω, Jl(ω)·v).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Se3Group;

impl LieGroup for So3Group {
    type Element = UnitQuaternion<f64>;
    type Algebra = Vector3<f64>;
    type AlgebraMap = Matrix3<f64>;

    fn identity() -> Self::Element {
        UnitQuaternion::identity()
    }
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element {
        a * b
    }
    fn inverse(a: &Self::Element) -> Self::Element {
        a.inverse()
    }
    fn exp(v: Vector3<f64>) -> Self::Element {
        let half_angle = 0.5 * v.norm();
        let scale = if half_angle > 0.0 { 0.5 * half_angle.sin() / half_angle } else { 0.5 };
        UnitQuaternion::new_unchecked(Quaternion::from_parts(half_angle.cos(), v * scale))
    }
    fn log(a: &Self::Element) -> Result<Vector3<f64>, CutLocus> {
        let (w, v) = if a.w < 0.0 { (-a.w, -a.imag()) } else { (a.w, a.imag()) };
        // Rounding of a product of quaternions leaves 4 ε in w: within that the side of half a turn is undecided.
        if w < 4.0 * f64::EPSILON {
            return Err(CutLocus { distance: std::f64::consts::PI });
        }
        let sine = v.norm();
        Ok(if sine > 0.0 { v * (2.0 * sine.atan2(w) / sine) } else { v * 2.0 })
    }
    fn adjoint(a: &Self::Element) -> Matrix3<f64> {
        a.to_rotation_matrix().into_inner()
    }
    fn left_jacobian(v: Vector3<f64>) -> Matrix3<f64> {
        Self::right_jacobian(-v)
    }
    fn right_jacobian(v: Vector3<f64>) -> Matrix3<f64> {
        let s = AngleSeries::at_squared_angle(v.norm_squared());
        let hat = v.cross_matrix();
        Matrix3::identity() - hat * s.b + hat * hat * s.c
    }
}

impl So3Group {
    /// Jr(v)⁻¹ = I + ½\[v\] + d\[v\]², for ‖v‖ < 2π (the thesis' appendix D, without its pole at π).
    pub fn right_jacobian_inverse(v: Vector3<f64>) -> Matrix3<f64> {
        let hat = v.cross_matrix();
        Matrix3::identity() + hat * 0.5 + hat * hat * inverse_jacobian_coefficient(v.norm_squared())
    }

    /// Jl(v)⁻¹ = Jr(−v)⁻¹, for ‖v‖ < 2π.
    pub fn left_jacobian_inverse(v: Vector3<f64>) -> Matrix3<f64> {
        Self::right_jacobian_inverse(-v)
    }
}

impl LieGroup for Se3Group {
    type Element = Isometry3<f64>;
    type Algebra = Twist;
    /// On 6-vectors (linear, angular).
    type AlgebraMap = Matrix6<f64>;

    fn identity() -> Self::Element {
        Isometry3::identity()
    }
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element {
        a * b
    }
    fn inverse(a: &Self::Element) -> Self::Element {
        a.inverse()
    }
    fn exp(v: Twist) -> Self::Element {
        let translation = So3Group::left_jacobian(v.angular) * v.linear;
        Isometry3::from_parts(translation.into(), So3Group::exp(v.angular))
    }
    fn log(a: &Self::Element) -> Result<Twist, CutLocus> {
        let angular = So3Group::log(&a.rotation)?;
        let linear = So3Group::left_jacobian_inverse(angular) * a.translation.vector;
        Ok(Twist { linear, angular })
    }
    fn adjoint(a: &Self::Element) -> Matrix6<f64> {
        let rotation = So3Group::adjoint(&a.rotation);
        block_upper(rotation, a.translation.vector.cross_matrix() * rotation)
    }
    /// Barfoot, *State Estimation for Robotics*, eq. 7.86; its coefficients are b_s and c_s of this crate's angle functions:
    /// (θ² + 2cos θ − 2)/(2θ⁴) = (b_s + c)/2 and (2θ − 3sin θ + θcos θ)/(2θ⁵) = −c_s/2.
    fn left_jacobian(v: Twist) -> Matrix6<f64> {
        let s = AngleSeries::at_squared_angle(v.angular.norm_squared());
        let (phi, rho) = (v.angular.cross_matrix(), v.linear.cross_matrix());
        let phi_rho_phi = phi * rho * phi;
        let coupling = rho * 0.5
            + (phi * rho + rho * phi + phi_rho_phi) * s.c
            + (phi * phi * rho + rho * phi * phi - phi_rho_phi * 3.0) * (0.5 * (s.b_s + s.c))
            - (phi_rho_phi * phi + phi * phi_rho_phi) * (0.5 * s.c_s);
        block_upper(So3Group::left_jacobian(v.angular), coupling)
    }
    fn right_jacobian(v: Twist) -> Matrix6<f64> {
        Self::left_jacobian(-v)
    }
}

/// \[diagonal, corner; 0, diagonal\].
fn block_upper(diagonal: Matrix3<f64>, corner: Matrix3<f64>) -> Matrix6<f64> {
    let mut m = Matrix6::zeros();
    m.fixed_view_mut::<3, 3>(0, 0).copy_from(&diagonal);
    m.fixed_view_mut::<3, 3>(3, 3).copy_from(&diagonal);
    m.fixed_view_mut::<3, 3>(0, 3).copy_from(&corner);
    m
}
