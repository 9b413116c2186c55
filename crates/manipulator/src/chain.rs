//! Forward kinematics and Jacobian of a serial chain as a product of exponentials.

use nalgebra::{DVector, Matrix6xX, Quaternion, UnitQuaternion, Vector3, Vector6};
use se3_geom::{Pose, Twist};

use crate::error::{ManipulatorError, Result};

/// A serial chain of single-axis joints, T(q) = M·exp(B₁q₁)⋯exp(Bₙqₙ).
///
/// M is `base_from_tool` with all joints at zero and Bᵢ the screw axis of joint i in the tool frame at zero, (v, ω) in m and rad per
/// unit of qᵢ (Lynch & Park, *Modern Robotics*, eq. 4.16). qᵢ is in rad, for prismatic joints in m.
#[derive(Debug, Clone)]
pub struct Chain {
    joint_names: Vec<String>,
    screws: Vec<Twist>,
    home: Pose,
    rotary: Vec<bool>,
}

impl Chain {
    pub(crate) fn new(joints: Vec<(String, Twist)>, home: Pose) -> Self {
        let rotary = joints.iter().map(|(_, screw)| screw.angular != nalgebra::Vector3::zeros()).collect();
        let (joint_names, screws) = joints.into_iter().unzip();
        Self { joint_names, screws, home, rotary }
    }

    /// A chain of named joints, base to tool, from their screw axes Sᵢ in the base frame, (v, ω) in m and rad per unit of qᵢ, and
    /// `base_from_tool` M, both with all joints at zero: Bᵢ = Ad(M⁻¹)·Sᵢ (Lynch & Park, *Modern Robotics*, §4.1.3).
    ///
    /// A turning joint about the unit vector u through the point a has Sᵢ = (a × u, u), a sliding one (u, 0).
    ///
    /// # Errors
    /// [`ManipulatorError::NoJoints`], [`ManipulatorError::InvalidJoint`] for an axis that has not unit length (to 1e-9, what
    /// is read from a file is rounded), [`ManipulatorError::NonFinite`].
    pub fn from_space_screws(joints: Vec<(String, Twist)>, base_from_tool: Pose) -> Result<Self> {
        if joints.is_empty() {
            return Err(ManipulatorError::NoJoints);
        }
        if !se3_geom::Manifold::is_finite(&se3_geom::Se3::default(), &base_from_tool) {
            return Err(ManipulatorError::NonFinite { what: "the tool's pose in the base frame" });
        }
        let mut body_screws = Vec::with_capacity(joints.len());
        for (name, Twist { linear, angular }) in joints {
            let slides = angular == nalgebra::Vector3::zeros();
            let length = if slides { linear.norm() } else { angular.norm() };
            if !((length - 1.0).abs() < 1e-9 && linear.norm().is_finite()) {
                let what = "the length of its axis";
                return Err(ManipulatorError::InvalidJoint { joint: name, what, value: length, must_be: "1" });
            }
            let at_tool = linear + angular.cross(&base_from_tool.translation.vector);
            let tool_from_base = base_from_tool.rotation.inverse();
            body_screws.push((name, Twist::new(tool_from_base * at_tool, tool_from_base * angular)));
        }
        Ok(Self::new(body_screws, base_from_tool))
    }

    /// Names of the moving joints, base to tool.
    pub fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    /// Number of moving joints.
    pub fn dof(&self) -> usize {
        self.screws.len()
    }

    /// Bᵢ, the screw axes in the tool frame at zero.
    pub(crate) fn screws(&self) -> &[Twist] {
        &self.screws
    }

    /// M, `base_from_tool` at zero.
    pub(crate) fn home(&self) -> &Pose {
        &self.home
    }

    /// Whether a joint turns (revolute or continuous), so that a full turn brings the arm back to the same pose.
    pub(crate) fn is_rotary(&self, joint: usize) -> bool {
        self.rotary[joint]
    }

    /// `base_from_tool` at configuration `q` of shape (dof).
    ///
    /// # Panics
    /// If `q` has fewer than dof values.
    pub fn forward(&self, q: &DVector<f64>) -> Pose {
        let mut pose = self.home;
        for joint in 0..self.dof() {
            pose *= self.joint_motion(joint, q[joint]);
        }
        // Six products of unit quaternions drift by some 1e-16; what leaves here has unit norm.
        pose.rotation.renormalize();
        pose
    }

    /// The body Jacobian J, of shape (6, dof): V = J·q̇ with V = (linear, angular) the tool's twist in the tool frame.
    ///
    /// Jᵢ = Ad(exp(−Bₙqₙ)⋯exp(−Bᵢ₊₁qᵢ₊₁))·Bᵢ (Lynch & Park, eq. 5.18).
    ///
    /// # Panics
    /// If `q` has fewer than dof values.
    pub fn body_jacobian(&self, q: &DVector<f64>) -> Matrix6xX<f64> {
        let mut jacobian = Matrix6xX::zeros(self.dof());
        self.forward_with_jacobian(q, &mut jacobian);
        jacobian
    }

    /// [`Self::forward`] and [`Self::body_jacobian`] in one pass, without allocation.
    pub(crate) fn forward_with_jacobian(&self, q: &DVector<f64>, jacobian: &mut Matrix6xX<f64>) -> Pose {
        // exp(Bᵢ₊₁qᵢ₊₁)⋯exp(Bₙqₙ)
        let mut beyond = Pose::identity();
        for i in (0..self.dof()).rev() {
            let Twist { linear, angular } = self.screws[i];
            let back = beyond.rotation.inverse();
            let carried = Twist::new(back * (linear + angular.cross(&beyond.translation.vector)), back * angular);
            jacobian.set_column(i, &carried.to_vector());
            beyond = self.joint_motion(i, q[i]) * beyond;
        }
        let mut pose = self.home * beyond;
        pose.rotation.renormalize();
        pose
    }

    fn joint_motion(&self, joint: usize, q: f64) -> Pose {
        joint_motion(&self.screws[joint], self.rotary[joint], q)
    }

    /// For every joint the greatest length that a unit of its motion moves the tool's origin by, in m (1 for a sliding joint), with
    /// the sliding joints out by at most `travel`.
    ///
    /// From axis to axis the links keep their lengths whatever the joints do: the sum of those lengths up to the tool bounds the
    /// tool's distance from the axis.
    pub(crate) fn reach_bounds(&self, travel: &DVector<f64>) -> DVector<f64> {
        let mut bounds = DVector::zeros(self.dof());
        let mut length = 0.0;
        let mut point = nalgebra::Vector3::zeros();
        for i in (0..self.dof()).rev() {
            let Twist { linear, angular } = self.screws[i];
            if self.rotary[i] {
                let on_axis = angular.cross(&linear);
                let nearest = on_axis + angular * angular.dot(&(point - on_axis));
                length += (point - nearest).norm();
                point = nearest;
                bounds[i] = length;
            } else {
                length += travel[i];
                bounds[i] = 1.0;
            }
        }
        bounds
    }

    /// J̇·q̇, the part of the tool's body acceleration V̇ = J·q̈ + J̇·q̇ that the joint rates alone make.
    ///
    /// From ∂Jᵢ/∂qⱼ = \[Jᵢ, Jⱼ\] for j > i and 0 otherwise (Lie bracket of twists).
    pub(crate) fn velocity_product(jacobian: &Matrix6xX<f64>, rates: &DVector<f64>) -> Vector6<f64> {
        let mut sum = Vector6::zeros();
        // Σᵢ Σⱼ>ᵢ [Jᵢ, Jⱼ]q̇ᵢq̇ⱼ, with the inner sum carried along.
        let mut beyond = Twist::zero();
        for i in (0..rates.len()).rev() {
            let own = Twist::from_vector(&(jacobian.column(i) * rates[i]));
            sum += bracket(own, beyond).to_vector();
            beyond = beyond + own;
        }
        sum
    }

    /// Velocity and acceleration of the tool frame's origin, in the axes of the tool frame: v and v̇ + ω × v of the body twist and its
    /// derivative.
    pub(crate) fn tool_motion(
        &self,
        q: &DVector<f64>,
        rates: &DVector<f64>,
        accelerations: &DVector<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let jacobian = self.body_jacobian(q);
        let twist = Twist::from_vector(&(&jacobian * rates));
        let change = Twist::from_vector(&(&jacobian * accelerations + Self::velocity_product(&jacobian, rates)));
        (twist.linear, change.linear + twist.angular.cross(&twist.linear))
    }
}

/// exp(Bq) of a turning or sliding joint's screw B. Axes have unit length, so that one sine and one cosine suffice (Lynch & Park,
/// eq. 3.88).
#[inline]
pub(crate) fn joint_motion(screw: &Twist, is_rotary: bool, q: f64) -> Pose {
    let Twist { linear, angular } = *screw;
    if !is_rotary {
        return Pose::from_parts((linear * q).into(), UnitQuaternion::identity());
    }
    let (half_sine, half_cosine) = (0.5 * q).sin_cos();
    let (sine, versine) = (2.0 * half_sine * half_cosine, 2.0 * half_sine * half_sine);
    let along = angular * (angular.dot(&linear) * (q - sine));
    let translation = linear * sine + angular.cross(&linear) * versine + along;
    let rotation = Quaternion::from_parts(half_cosine, angular * half_sine);
    Pose::from_parts(translation.into(), UnitQuaternion::new_unchecked(rotation))
}

/// The Lie bracket \[a, b\] of two twists.
pub(crate) fn bracket(a: Twist, b: Twist) -> Twist {
    Twist::new(a.angular.cross(&b.linear) + a.linear.cross(&b.angular), a.angular.cross(&b.angular))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    /// Central differences of the body twist along a motion of constant joint rates: the error must fall fourfold with the step.
    #[test]
    fn velocity_product_is_the_derivative_of_the_jacobian() {
        let chain = Robot::shipped("ur5e").unwrap().chain;
        for seed in 0..10 {
            let q = DVector::from_fn(6, |j, _| 2.0 * ((13 * seed + 5 * j) as f64).sin());
            let rates = DVector::from_fn(6, |j, _| ((17 * seed + 3 * j) as f64).cos());
            let exact = Chain::velocity_product(&chain.body_jacobian(&q), &rates);
            let defect = |h: f64| {
                let twist = |t: f64| chain.body_jacobian(&(&q + &rates * t)) * &rates;
                ((twist(h) - twist(-h)) / (2.0 * h) - exact).norm()
            };
            assert!(defect(1e-3) < 1e-5 && exact.norm() > 1e-2);
            // The next term is smaller by (h·‖q̇‖)² ≈ 1e-3.
            assert!((defect(0.02) / defect(0.01) - 4.0).abs() < 0.1);
        }
    }
}
