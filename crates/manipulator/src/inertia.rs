//! Mass and its distribution.

use std::ops::Add;

use nalgebra::{Matrix3, Vector3};
use se3_geom::Pose;

use crate::error::{ManipulatorError, Result};

/// The ten inertial parameters of a rigid body in some frame, in SI units.
///
/// Kept as moments about the frame's origin, in which bodies that move together simply add.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia {
    mass_kg: f64,
    /// m·c, in kg·m.
    first_moment: Vector3<f64>,
    /// ∫ (|x|²·1 − x·xᵀ) dm, in kg·m².
    about_origin: Matrix3<f64>,
}

impl Inertia {
    /// A body of given mass (kg), centre of mass (m) and symmetric inertia tensor about the centre of mass (kg·m², axes of the frame,
    /// products of inertia with the sign that makes the tensor symmetric positive semidefinite, as in URDF and MJCF). That no principal
    /// moment exceeds the sum of the others is not asked for: published descriptions break it by their rounding, and motion needs none
    /// of it.
    ///
    /// # Errors
    /// [`ManipulatorError::Inertia`] for a number that is not finite, a negative mass, or a tensor that is not symmetric positive
    /// semidefinite up to rounding of its digits (1e-6 of its trace).
    pub fn of_body(mass_kg: f64, center_m: Vector3<f64>, about_center: Matrix3<f64>) -> Result<Self> {
        let refused = |reason| Err(ManipulatorError::Inertia { reason });
        if !(mass_kg.is_finite() && center_m.iter().chain(&about_center).all(|x| x.is_finite())) {
            return refused("a figure is not a finite number");
        }
        if mass_kg < 0.0 {
            return refused("its mass is negative");
        }
        let slack = 1e-6 * about_center.trace().abs();
        if (about_center - about_center.transpose()).amax() > slack {
            return refused("its inertia tensor is not symmetric");
        }
        if about_center.symmetric_eigenvalues().min() < -slack {
            return refused("its inertia tensor is not positive semidefinite");
        }
        let first_moment = center_m * mass_kg;
        Ok(Self { mass_kg, first_moment, about_origin: about_center + mixed(first_moment, center_m) })
    }

    /// The same body in a parent frame.
    pub fn in_parent(&self, parent_from_frame: &Pose) -> Self {
        let (shift, turn) =
            (parent_from_frame.translation.vector, parent_from_frame.rotation.to_rotation_matrix().into_inner());
        let turned = turn * self.first_moment;
        // |x + p|²·1 − (x + p)(x + p)ᵀ, multiplied out and integrated.
        let shifted = mixed(turned, shift) + mixed(shift, turned) + mixed(shift * self.mass_kg, shift);
        Self {
            mass_kg: self.mass_kg,
            first_moment: turned + shift * self.mass_kg,
            about_origin: turn * self.about_origin * turn.transpose() + shifted,
        }
    }

    /// Mass in kg.
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Linear and angular momentum about the origin of a body that moves with the velocity `linear` of the origin and `angular`; with
    /// accelerations in their place the rates of change in a frame that does not turn.
    pub(crate) fn momentum(&self, linear: Vector3<f64>, angular: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (
            linear * self.mass_kg + angular.cross(&self.first_moment),
            self.about_origin * angular + self.first_moment.cross(&linear),
        )
    }
}

impl Add for Inertia {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            mass_kg: self.mass_kg + other.mass_kg,
            first_moment: self.first_moment + other.first_moment,
            about_origin: self.about_origin + other.about_origin,
        }
    }
}

/// aᵀb·1 − b·aᵀ, which for a = m·b is the tensor of a point mass.
fn mixed(a: Vector3<f64>, b: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * a.dot(&b) - b * a.transpose()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Translation3, UnitQuaternion};

    use super::*;

    /// Eight unequal point masses: what the tensor must be follows from the sum over them.
    #[test]
    fn points_add_up_in_every_frame() {
        let points: Vec<(f64, Vector3<f64>)> = (0..8)
            .map(|k| {
                let f = |j: usize| ((11 * k + 5 * j) as f64).sin();
                (1.5 + f(3), Vector3::new(f(0), f(1), f(2)))
            })
            .collect();
        let pose = Pose::from_parts(
            Translation3::new(0.3, -1.2, 0.7),
            UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -0.9, 1.3)),
        );
        let sum = |place: &dyn Fn(&Vector3<f64>) -> Vector3<f64>| {
            points.iter().fold(Inertia::default(), |sum, (mass, x)| {
                sum + Inertia::of_body(*mass, place(x), Matrix3::zeros()).unwrap()
            })
        };
        let (here, there) = (sum(&|x| *x), sum(&|x| pose.rotation * x + pose.translation.vector));
        let moved = here.in_parent(&pose);
        // Sums of some twenty terms of size up to 30.
        assert!((moved.about_origin - there.about_origin).amax() < 1e-13);
        assert!((moved.first_moment - there.first_moment).amax() < 1e-13 && moved.mass_kg == there.mass_kg);
        // Kinetic energy, from the points and from the moments: ½ Σ m|v + ω × x|².
        let (v, w) = (Vector3::new(0.2, 0.5, -0.3), Vector3::new(-1.0, 0.6, 0.8));
        let of_points: f64 = points.iter().map(|(m, x)| 0.5 * m * (v + w.cross(x)).norm_squared()).sum();
        let (p, l) = here.momentum(v, w);
        assert!((0.5 * (p.dot(&v) + l.dot(&w)) - of_points).abs() < 1e-13);
    }

    #[test]
    fn impossible_bodies_are_refused() {
        let (at, solid) = (Vector3::new(0.1, 0.2, 0.3), Matrix3::identity());
        assert!(Inertia::of_body(1.0, at, solid).is_ok());
        for (mass, center, tensor) in [
            (-1.0, at, solid),
            (f64::NAN, at, solid),
            (1.0, at * f64::INFINITY, solid),
            (1.0, at, -solid),
            (1.0, at, Matrix3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)),
        ] {
            assert!(matches!(Inertia::of_body(mass, center, tensor), Err(ManipulatorError::Inertia { .. })));
        }
    }
}
