//! Velocities in the plane.

use std::ops::{Add, Mul, Neg, Sub};

use nalgebra::{Vector2, Vector3, Vector4};

/// Velocity of a pose in the plane, in the body frame. As a 3-vector: (vx, vy, ω).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanarTwist {
    /// Linear part, in metres per unit of the parameter.
    pub linear: Vector2<f64>,
    /// Angular part, counter-clockwise, in radians per unit of the parameter.
    pub angular: f64,
}

/// Velocity of a similarity of the plane, in the body frame. As a 4-vector: (vx, vy, ω, σ).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SimilarityTwist {
    /// Linear part, in metres per unit of the parameter.
    pub linear: Vector2<f64>,
    /// Angular part, counter-clockwise, in radians per unit of the parameter.
    pub angular: f64,
    /// Rate of the logarithm of the scale, per unit of the parameter.
    pub scaling: f64,
}

impl PlanarTwist {
    /// A twist from its two parts.
    pub fn new(linear: Vector2<f64>, angular: f64) -> Self {
        Self { linear, angular }
    }
    /// The 3-vector (vx, vy, ω).
    pub fn to_vector(self) -> Vector3<f64> {
        Vector3::new(self.linear.x, self.linear.y, self.angular)
    }
    /// The twist of a 3-vector (vx, vy, ω).
    pub fn from_vector(v: &Vector3<f64>) -> Self {
        Self::new(v.xy(), v.z)
    }
}

impl SimilarityTwist {
    /// A twist from its three parts.
    pub fn new(linear: Vector2<f64>, angular: f64, scaling: f64) -> Self {
        Self { linear, angular, scaling }
    }
    /// The 4-vector (vx, vy, ω, σ).
    pub fn to_vector(self) -> Vector4<f64> {
        Vector4::new(self.linear.x, self.linear.y, self.angular, self.scaling)
    }
    /// The twist of a 4-vector (vx, vy, ω, σ).
    pub fn from_vector(v: &Vector4<f64>) -> Self {
        Self::new(v.xy(), v.z, v.w)
    }
}

/// Adds and scales a struct field by field.
macro_rules! vector_space {
    ($type:ty { $($field:ident),+ }) => {
        impl Add for $type {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self { $($field: self.$field + other.$field),+ }
            }
        }
        impl Sub for $type {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self { $($field: self.$field - other.$field),+ }
            }
        }
        impl Neg for $type {
            type Output = Self;
            fn neg(self) -> Self {
                Self { $($field: -self.$field),+ }
            }
        }
        impl Mul<f64> for $type {
            type Output = Self;
            fn mul(self, k: f64) -> Self {
                Self { $($field: self.$field * k),+ }
            }
        }
    };
}
vector_space!(PlanarTwist { linear, angular });
vector_space!(SimilarityTwist { linear, angular, scaling });
