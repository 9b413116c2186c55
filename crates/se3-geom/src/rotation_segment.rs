//! One segment of the midpoint-chart cubic on SO(3).
//!
//! Between two rotations with relative rotation vector θ = log(Rᵢᵀ Rᵢ₊₁) the curve is R(t) = Rᵢ·Exp(θ/2)·Exp(φ(t)) with a cubic
//! φ from −θ/2 to +θ/2. The chart is centred at the segment's midpoint, so that reversing the curve only flips signs, and the
//! angles in it are half as large as in a chart at a knot.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::angle_series::AngleSeries;
use crate::group::{LieGroup, So3Group};

/// Rotation with body rate ω, ω̇ and ω̈.
pub(crate) struct RotationMotion {
    pub(crate) rotation: UnitQuaternion<f64>,
    pub(crate) rate: Vector3<f64>,
    pub(crate) acceleration: Vector3<f64>,
    pub(crate) jerk: Vector3<f64>,
}

/// A cubic c₀ + c₁τ + c₂τ² + c₃τ³ of a 3-vector.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cubic([Vector3<f64>; 4]);

impl Cubic {
    /// The cubic on \[0, h\] with the given end values and end slopes.
    pub(crate) fn hermite(h: f64, [x0, x1]: [Vector3<f64>; 2], [v0, v1]: [Vector3<f64>; 2]) -> Self {
        let slope = (x1 - x0) / h;
        Self([x0, v0, (slope * 3.0 - v0 * 2.0 - v1) / h, (v0 + v1 - slope * 2.0) / (h * h)])
    }

    /// Value and the first three derivatives.
    pub(crate) fn at(&self, t: f64) -> [Vector3<f64>; 4] {
        let [a, b, c, d] = self.0;
        [a + (b + (c + d * t) * t) * t, b + (c * 2.0 + d * (3.0 * t)) * t, c * 2.0 + d * (6.0 * t), d * 6.0]
    }
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct RotationSegment {
    midpoint: UnitQuaternion<f64>,
    chart: Cubic,
}

impl RotationSegment {
    /// The segment of length `h` from `start` over the rotation vector `theta` with body rates at both ends.
    pub(crate) fn new(start: &UnitQuaternion<f64>, theta: Vector3<f64>, h: f64, rates: [Vector3<f64>; 2]) -> Self {
        let half = theta * 0.5;
        let slopes =
            [So3Group::right_jacobian_inverse(-half) * rates[0], So3Group::right_jacobian_inverse(half) * rates[1]];
        Self { midpoint: start * So3Group::exp(half), chart: Cubic::hermite(h, [-half, half], slopes) }
    }

    pub(crate) fn rotation(&self, t: f64) -> UnitQuaternion<f64> {
        self.midpoint * So3Group::exp(self.chart.at(t)[0])
    }

    /// ω = φ̇ − b φ×φ̇ + c φ×(φ×φ̇) and its first two derivatives.
    pub(crate) fn at(&self, t: f64) -> RotationMotion {
        let [phi, p, q, r] = self.chart.at(t);
        let s = AngleSeries::at_squared_angle(phi.norm_squared());
        // u = φ×φ̇ and w = φ×u with their derivatives.
        let u = phi.cross(&p);
        let u_dot = phi.cross(&q);
        let u_ddot = p.cross(&q) + phi.cross(&r);
        let w = phi.cross(&u);
        let w_dot = p.cross(&u) + phi.cross(&u_dot);
        let w_ddot = q.cross(&u) + p.cross(&u_dot) * 2.0 + phi.cross(&u_ddot);
        // b and c depend on time through x = φ·φ, with ẋ/2 = φ·φ̇.
        let half_x_dot = phi.dot(&p);
        let half_x_ddot = p.dot(&p) + phi.dot(&q);
        let (b_dot, c_dot) = (s.b_s * half_x_dot, s.c_s * half_x_dot);
        let b_ddot = s.b_ss * half_x_dot * half_x_dot + s.b_s * half_x_ddot;
        let c_ddot = s.c_ss * half_x_dot * half_x_dot + s.c_s * half_x_ddot;
        RotationMotion {
            rotation: self.midpoint * So3Group::exp(phi),
            rate: p - u * s.b + w * s.c,
            acceleration: q - u * b_dot - u_dot * s.b + w * c_dot + w_dot * s.c,
            jerk: r - u * b_ddot - u_dot * (2.0 * b_dot) - u_ddot * s.b
                + w * c_ddot
                + w_dot * (2.0 * c_dot)
                + w_ddot * s.c,
        }
    }
}

/// The part of the body acceleration at a segment's end that is quadratic in the body rate ω there, and its derivative by ω.
///
/// `phi` is the chart coordinate of that end: +θ/2 at the right, −θ/2 at the left. With p = φ̇ = Jr⁻¹(φ)ω,
/// N = J̇r·φ̇ = −b_s(φ·p)(φ×p) + c_s(φ·p) φ×(φ×p) + c p×(φ×p).
pub(crate) fn quadratic_acceleration(rate: &Vector3<f64>, phi: &Vector3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let s = AngleSeries::at_squared_angle(phi.norm_squared());
    let chart_from_rate = So3Group::right_jacobian_inverse(*phi);
    let p = chart_from_rate * rate;
    let (along, u) = (phi.dot(&p), phi.cross(&p));
    let w = phi.cross(&u);
    let value = u * (-s.b_s * along) + w * (s.c_s * along) + p.cross(&u) * s.c;
    let phi_hat = phi.cross_matrix();
    let by_p = (u * phi.transpose() + phi_hat * along) * -s.b_s
        + (w * phi.transpose() + phi_hat * phi_hat * along) * s.c_s
        + (p.cross_matrix() * phi_hat - u.cross_matrix()) * s.c;
    (value, by_p * chart_from_rate)
}
