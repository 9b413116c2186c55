//! Numbers that carry their derivatives along.

use std::ops::{Add, Mul, Neg, Sub};

/// A function of one variable near a point, as its Taylor polynomial f₀ + f₁ε + f₂ε² + f₃ε³ (fₖ = f⁽ᵏ⁾/k!): arithmetic on jets
/// differentiates whatever is computed with them, exactly to rounding.
///
/// ```
/// use se3_geom::Jet;
/// let t = Jet::variable(2.0);
/// assert_eq!((t * t * t).derivatives(), [8.0, 12.0, 12.0, 6.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet(pub(crate) [f64; 4]);

impl Jet {
    /// The variable itself, at `value`.
    pub fn variable(value: f64) -> Self {
        Self([value, 1.0, 0.0, 0.0])
    }
    /// A number that does not depend on the variable.
    pub fn constant(value: f64) -> Self {
        Self([value, 0.0, 0.0, 0.0])
    }
    /// The value.
    pub fn value(&self) -> f64 {
        self.0[0]
    }
    /// The value and the first three derivatives.
    pub fn derivatives(&self) -> [f64; 4] {
        let [f, d, half_dd, sixth_ddd] = self.0;
        [f, d, 2.0 * half_dd, 6.0 * sixth_ddd]
    }
    /// The derivative, of which nothing is known beyond its second derivative: the last place is zero.
    pub(crate) fn slope(&self) -> Self {
        Self([self.0[1], 2.0 * self.0[2], 3.0 * self.0[3], 0.0])
    }
    /// √f, for f > 0: from g² = f, place by place.
    pub fn sqrt(self) -> Self {
        let [f0, f1, f2, f3] = self.0;
        let g0 = f0.sqrt();
        let g1 = f1 / (2.0 * g0);
        let g2 = (f2 - g1 * g1) / (2.0 * g0);
        Self([g0, g1, g2, (f3 - 2.0 * g1 * g2) / (2.0 * g0)])
    }
    /// 1/f, for f ≠ 0: from g·f = 1, place by place.
    pub fn recip(self) -> Self {
        let [f0, f1, f2, f3] = self.0;
        let g0 = 1.0 / f0;
        let g1 = -f1 * g0 * g0;
        let g2 = -(f1 * g1 + f2 * g0) * g0;
        Self([g0, g1, g2, -(f1 * g2 + f2 * g1 + f3 * g0) * g0])
    }
    /// Σ cₖfᵏ.
    pub(crate) fn polynomial(self, coefficients: &[f64]) -> Self {
        coefficients.iter().rev().fold(Self::constant(0.0), |sum, c| sum * self + Self::constant(*c))
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}
impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}
impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}
impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| (0..=k).map(|i| self.0[i] * other.0[k - i]).sum()))
    }
}
impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}
