use nalgebra::{UnitComplex, Vector2};

use super::{LieGroup, NoLogarithm};

/// The rotations of the plane, SO(2); algebra elements are angles θ in rad, exp(θ) = e^{iθ}, log in \[−π, π\].
///
/// The group is commutative, so its adjoint and its Jacobians are 1.
///
/// ```
/// use se3_geom::{LieGroup, So2Group};
/// let quarter = So2Group::exp(std::f64::consts::FRAC_PI_2);
/// let half = So2Group::compose(&quarter, &quarter);
/// assert!((So2Group::log(&half)?.abs() - std::f64::consts::PI).abs() < 1e-15);
/// # Ok::<(), se3_geom::NoLogarithm>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct So2Group;

impl LieGroup for So2Group {
    type Element = UnitComplex<f64>;
    type Algebra = f64;
    type AlgebraMap = f64;
    type Point = Vector2<f64>;

    fn identity() -> Self::Element {
        UnitComplex::identity()
    }
    fn compose(a: &Self::Element, b: &Self::Element) -> Self::Element {
        a * b
    }
    fn inverse(a: &Self::Element) -> Self::Element {
        a.inverse()
    }
    fn exp(angle: f64) -> Self::Element {
        UnitComplex::new(angle)
    }
    fn log(a: &Self::Element) -> Result<f64, NoLogarithm> {
        let angle_rad = a.angle();
        if angle_rad.is_finite() { Ok(angle_rad) } else { Err(NoLogarithm { angle_rad, scale: 1.0 }) }
    }
    fn adjoint(_: &Self::Element) -> f64 {
        1.0
    }
    fn left_jacobian(_: f64) -> f64 {
        1.0
    }
    fn left_jacobian_inverse(_: f64) -> f64 {
        1.0
    }
    fn act(a: &Self::Element, x: &Vector2<f64>) -> Vector2<f64> {
        a * x
    }
}
