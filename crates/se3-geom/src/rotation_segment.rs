//! One segment of the midpoint-chart cubic on SO(3).
//!
//! Between two rotations with relative rotation vector θ = log(Rᵢᵀ Rᵢ₊₁) the curve is R(t) = Rᵢ·Exp(θ/2)·Exp(φ(t)) with a cubic
//! φ from −θ/2 to +θ/2. The chart is centred at the segment's midpoint, so that reversing the curve only flips signs, and the
//! angles in it are half as large as in a chart at a knot.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::angle_series::AngleSeries;
use crate::curve::Cubic;
use crate::group::{LieGroup, So3Group};

/// Rotation with body rate ω, ω̇ and ω̈.
pub(crate) struct RotationMotion {
    pub(crate) rotation: UnitQuaternion<f64>,
    pub(crate) rate: Vector3<f64>,
    pub(crate) acceleration: Vector3<f64>,
    pub(crate) jerk: Vector3<f64>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct RotationSegment {
    midpoint: UnitQuaternion<f64>,
    chart: Cubic<3>,
}

impl RotationSegment {
    /// The segment of length `h` from `start` over the rotation vector `theta`, with the second derivatives of its chart
    /// coordinates at both ends.
    pub(crate) fn new(start: &UnitQuaternion<f64>, theta: Vector3<f64>, h: f64, bends: [Vector3<f64>; 2]) -> Self {
        let half = theta * 0.5;
        Self { midpoint: start * So3Group::exp(half), chart: Cubic::bent(h, [-half, half], bends) }
    }

    pub(crate) fn rotation(&self, t: f64) -> UnitQuaternion<f64> {
        self.midpoint * So3Group::exp(self.chart.value(t))
    }

    /// At least the angle turned through over \[0, h\]: the chart's length, since Jr shortens vectors.
    pub(crate) fn turned_at_most(&self, h: f64) -> f64 {
        self.chart.length_bound(h)
    }

    /// ω = φ̇ − b φ×φ̇ + c φ×(φ×φ̇) and its first two derivatives.
    #[inline]
    pub(crate) fn at(&self, t: f64) -> RotationMotion {
        let [phi, p, q, r] = self.chart.at(t);
        let x = phi.norm_squared();
        let s = AngleSeries::at_squared_angle(x);
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
            rotation: self.midpoint * s.rotation(&phi, x),
            rate: p - u * s.b + w * s.c,
            acceleration: q - u * b_dot - u_dot * s.b + w * c_dot + w_dot * s.c,
            jerk: r - u * b_ddot - u_dot * (2.0 * b_dot) - u_ddot * s.b
                + w * c_ddot
                + w_dot * (2.0 * c_dot)
                + w_ddot * s.c,
        }
    }
}

/// The part of the body acceleration at a segment's ends that is quadratic in the body rate there.
///
/// `half_turn` φ is the chart coordinate of the right end, −φ that of the left. With p = φ̇ = Jr⁻¹(φ)ω and s = φ·ω = φ·p,
/// N(ω; φ) = J̇r·φ̇ = −b_s·s φ×p + (c_s·s² + c·p·p) φ − s(c + c_s·φ·φ) p.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuadraticAcceleration {
    half_turn: Vector3<f64>,
    chart_from_rate: Matrix3<f64>,
    c: f64,
    b_s: f64,
    c_s: f64,
    along_rate: f64,
}

impl QuadraticAcceleration {
    pub(crate) fn new(theta: &Vector3<f64>) -> Self {
        let half_turn = theta * 0.5;
        let AngleSeries { c, b_s, c_s, .. } = AngleSeries::at_squared_angle(half_turn.norm_squared());
        Self {
            half_turn,
            chart_from_rate: So3Group::right_jacobian_inverse(half_turn),
            c,
            b_s,
            c_s,
            along_rate: c + c_s * half_turn.norm_squared(),
        }
    }

    /// N at the right end, with the factor with which it enters the equations there, +1.
    pub(crate) fn right(&self, rate: &Vector3<f64>) -> Vector3<f64> {
        self.value(&self.half_turn, &(self.chart_from_rate * rate), self.half_turn.dot(rate))
    }

    /// −N at the left end: it enters the equations there with the factor −1.
    pub(crate) fn left(&self, rate: &Vector3<f64>) -> Vector3<f64> {
        let phi = -self.half_turn;
        -self.value(&phi, &self.chart_from_rate.tr_mul(rate), phi.dot(rate))
    }

    /// φ̈ at the left end: ω̇ = Jr·φ̈ + N solved for it.
    pub(crate) fn left_bend(&self, rate: &Vector3<f64>, acceleration: &Vector3<f64>) -> Vector3<f64> {
        self.chart_from_rate.tr_mul(&(acceleration + self.left(rate)))
    }

    /// φ̈ at the right end.
    pub(crate) fn right_bend(&self, rate: &Vector3<f64>, acceleration: &Vector3<f64>) -> Vector3<f64> {
        self.chart_from_rate * (acceleration - self.right(rate))
    }

    /// The derivative of [`Self::right`].
    pub(crate) fn right_by_rate(&self, rate: &Vector3<f64>) -> Matrix3<f64> {
        let p = self.chart_from_rate * rate;
        self.by_chart_rate(&self.half_turn, &p, self.half_turn.dot(rate)) * self.chart_from_rate
    }

    /// The derivative of [`Self::left`]. Jr⁻¹(−φ) is the transpose of Jr⁻¹(φ).
    pub(crate) fn left_by_rate(&self, rate: &Vector3<f64>) -> Matrix3<f64> {
        let phi = -self.half_turn;
        let p = self.chart_from_rate.tr_mul(rate);
        -(self.by_chart_rate(&phi, &p, phi.dot(rate)) * self.chart_from_rate.transpose())
    }

    fn value(&self, phi: &Vector3<f64>, p: &Vector3<f64>, s: f64) -> Vector3<f64> {
        phi * (self.c_s * s * s + self.c * p.norm_squared()) - phi.cross(p) * (self.b_s * s) - p * (s * self.along_rate)
    }

    fn by_chart_rate(&self, phi: &Vector3<f64>, p: &Vector3<f64>, s: f64) -> Matrix3<f64> {
        let column = phi.cross(p) * -self.b_s + phi * (2.0 * self.c_s * s) - p * self.along_rate;
        let (twist, shrink) = (phi * (self.b_s * s), s * self.along_rate);
        let mut by_p = column * phi.transpose() + phi * (p * (2.0 * self.c)).transpose() - twist.cross_matrix();
        for k in 0..3 {
            by_p[(k, k)] -= shrink;
        }
        by_p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N is what the acceleration of a segment has beyond its linear part, at both ends and at every angle a chart can take.
    #[test]
    fn quadratic_part_is_that_of_the_segment() {
        for angle in [1e-6, 0.4, 1.5, 2.6, 3.1] {
            let theta = Vector3::new(0.6, -0.48, 0.64) * angle;
            let (h, rates) = (0.7, [Vector3::new(1.1, -2.0, 0.3), Vector3::new(-0.4, 0.9, 1.7)]);
            let half = theta * 0.5;
            let slopes =
                [So3Group::right_jacobian_inverse(-half) * rates[0], So3Group::right_jacobian_inverse(half) * rates[1]];
            let chart = Cubic::hermite(h, [-half, half], slopes);
            let segment = RotationSegment { midpoint: So3Group::exp(half), chart };
            let n = QuadraticAcceleration::new(&theta);
            let carry = So3Group::adjoint(&So3Group::exp(theta * 0.5));
            let start =
                theta * (6.0 / (h * h)) - rates[0] * (4.0 / h) - carry * rates[1] * (2.0 / h) - n.left(&rates[0]);
            let end = theta * (-6.0 / (h * h))
                + rates[1] * (4.0 / h)
                + carry.transpose() * rates[0] * (2.0 / h)
                + n.right(&rates[1]);
            // Terms of size 6θ/h² < 40: a hundred roundings of them.
            assert!((segment.at(0.0).acceleration - start).norm() < 1e-12, "{angle}");
            assert!((segment.at(h).acceleration - end).norm() < 1e-12, "{angle}");
            // And the same segment comes from its accelerations.
            let bends = [n.left_bend(&rates[0], &start), n.right_bend(&rates[1], &end)];
            let bent = RotationSegment::new(&UnitQuaternion::identity(), theta, h, bends);
            assert!((bent.at(0.0).rate - rates[0]).norm() + (bent.at(h).rate - rates[1]).norm() < 1e-12, "{angle}");
        }
    }

    /// The derivative against central differences, which are exact for a quadratic up to rounding/step.
    #[test]
    fn derivative_is_the_slope() {
        let n = QuadraticAcceleration::new(&Vector3::new(1.9, -1.1, 1.6));
        let rate = Vector3::new(0.8, 2.1, -1.3);
        for k in 0..3 {
            let step = Vector3::ith(k, 0.5);
            let right = n.right(&(rate + step)) - n.right(&(rate - step));
            let left = n.left(&(rate + step)) - n.left(&(rate - step));
            assert!((right - n.right_by_rate(&rate).column(k)).norm() < 1e-14);
            assert!((left - n.left_by_rate(&rate).column(k)).norm() < 1e-14);
        }
    }
}
