//! Velocity of a pose.

use std::ops::{Add, Mul, Neg, Sub};

use nalgebra::{Vector3, Vector6};

/// Linear and angular velocity (or their derivatives) of a tool, in the body frame unless a name says `_spatial`.
///
/// Field order is that of ROS: `linear` first. As a 6-vector: (linear, angular).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Linear part, in metres per unit of the parameter.
    pub linear: Vector3<f64>,
    /// Angular part, in radians per unit of the parameter.
    pub angular: Vector3<f64>,
}

impl Twist {
    /// A twist from its two parts.
    #[inline]
    pub fn new(linear: Vector3<f64>, angular: Vector3<f64>) -> Self {
        Self { linear, angular }
    }
    /// No motion.
    #[inline]
    pub fn zero() -> Self {
        Self::default()
    }
    /// The 6-vector (linear, angular).
    pub fn to_vector(self) -> Vector6<f64> {
        let (v, w) = (self.linear, self.angular);
        Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
    }
    /// The twist of a 6-vector (linear, angular).
    pub fn from_vector(v: &Vector6<f64>) -> Self {
        Self::new(Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5]))
    }
}

impl Add for Twist {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.linear + other.linear, self.angular + other.angular)
    }
}
impl Sub for Twist {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.linear - other.linear, self.angular - other.angular)
    }
}
impl Neg for Twist {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.linear, -self.angular)
    }
}
impl Mul<f64> for Twist {
    type Output = Self;
    #[inline]
    fn mul(self, k: f64) -> Self {
        Self::new(self.linear * k, self.angular * k)
    }
}
