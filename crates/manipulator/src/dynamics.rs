//! Inverse dynamics of a serial chain: the torques that a motion needs.

use nalgebra::{Matrix3, Vector3};
use se3_geom::Twist;

use crate::chain::{Chain, bracket, joint_motion};
use crate::error::{ManipulatorError, Result};
use crate::inertia::Inertia;

/// Standard gravity in a base frame whose z axis points up, in m/s².
pub const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];

/// What a joint's own drive adds to the torque: Jᵣ·q̈ + d·q̇ + f·sgn(q̇), in SI units (N in place of N·m for prismatic joints).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Drive {
    /// Inertia of rotor and gears as seen at the joint, Jᵣ in kg·m² (kg for prismatic joints). MuJoCo's `armature`.
    pub rotor_inertia_kg_m2: f64,
    /// Viscous friction d in N·m·s/rad.
    pub damping_n_m_s: f64,
    /// Dry friction f in N·m.
    pub friction_n_m: f64,
}

/// Link inertias, drives and gravity of a chain, and with them τ(q, q̇, q̈) = M(q)·q̈ + C(q, q̇)·q̇ + g(q) + drives.
///
/// ```
/// let robot = manipulator::Robot::shipped("panda")?;
/// let dynamics = robot.dynamics.as_ref().expect("its URDF has inertias");
/// let mut torque = [0.0; 7];
/// dynamics.torque(robot.preferred.as_slice(), &[0.0; 7], &[0.0; 7], &mut torque);
/// // The first axis is vertical, so that gravity does not load it; the fourth holds the bent forearm. MuJoCo says 18.573609 N·m.
/// assert!(torque[0].abs() < 1e-12 && (torque[3] - 18.573_609).abs() < 1e-6);
/// # Ok::<(), manipulator::ManipulatorError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Dynamics {
    joints: Vec<Joint>,
    /// Acceleration of the base that feels like gravity, in the tool frame at zero.
    lift: Vector3<f64>,
}

/// A joint with what it carries. The frame of link i is the one that lies in the tool frame when all joints are at zero; the joint's
/// screw axis Bᵢ is the same in that frame and in the one before, at every qᵢ.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Joint {
    screw: Twist,
    is_rotary: bool,
    link: Inertia,
    drive: Drive,
}

/// Of one link in its own frame, which lies in its parent's turned by `turn` and moved by `offset`.
#[derive(Debug, Clone, Copy)]
struct LinkState {
    turn: Matrix3<f64>,
    offset: Vector3<f64>,
    force: Vector3<f64>,
    moment: Vector3<f64>,
}

/// Chains of up to this many joints need no memory from the heap.
const JOINTS_ON_STACK: usize = 16;

/// The sign of a rate; 0 for what rounding makes of rest: positions of some rad, over steps of 0.1 ms at least, leave 1e-11 rad/s.
pub(crate) fn direction(rate: f64) -> f64 {
    if rate.abs() < 1e-9 { 0.0 } else { rate.signum() }
}

impl Dynamics {
    /// Dynamics of a chain whose joint i carries `links[i]` (up to the next joint), given in the base frame with all joints at zero,
    /// under `gravity_m_s2` in the base frame.
    ///
    /// # Errors
    /// [`ManipulatorError::WrongSize`] unless there is one link and one drive a joint, [`ManipulatorError::NonFinite`],
    /// [`ManipulatorError::InvalidJoint`] for a negative figure of a drive.
    pub fn new(chain: &Chain, links: &[Inertia], drives: &[Drive], gravity_m_s2: [f64; 3]) -> Result<Self> {
        let dof = chain.dof();
        for (what, given) in [("the list of links", links.len()), ("the list of drives", drives.len())] {
            if given != dof {
                return Err(ManipulatorError::WrongSize { what, expected: dof, given });
            }
        }
        if !gravity_m_s2.iter().all(|x| x.is_finite()) {
            return Err(ManipulatorError::NonFinite { what: "gravity" });
        }
        for (name, drive) in chain.joint_names().iter().zip(drives) {
            let figures = [
                ("its rotor inertia", drive.rotor_inertia_kg_m2),
                ("its damping", drive.damping_n_m_s),
                ("its dry friction", drive.friction_n_m),
            ];
            if let Some(&(what, value)) = figures.iter().find(|(_, value)| !(*value >= 0.0 && value.is_finite())) {
                return Err(ManipulatorError::InvalidJoint { joint: name.clone(), what, value, must_be: "at least 0" });
            }
        }
        let tool_from_base = chain.home().inverse();
        let joints = chain.screws().iter().enumerate().zip(links).zip(drives);
        let joints = joints
            .map(|(((i, &screw), link), &drive)| {
                let is_rotary = chain.is_rotary(i);
                Joint { screw, is_rotary, link: link.in_parent(&tool_from_base), drive }
            })
            .collect();
        Ok(Self { joints, lift: tool_from_base.rotation * -Vector3::from(gravity_m_s2) })
    }

    /// The drives, one a joint.
    pub fn drives(&self) -> impl Iterator<Item = &Drive> {
        self.joints.iter().map(|joint| &joint.drive)
    }

    /// Writes the joint torques in N·m (forces in N for prismatic joints) that give the accelerations `accelerations` at the state
    /// (`q`, `rates`), all of shape (dof), without contact at the tool.
    ///
    /// Recursive Newton–Euler (Lynch & Park, *Modern Robotics*, algorithm 8.3; Featherstone, *Rigid Body Dynamics Algorithms*,
    /// table 5.1), in time proportional to the number of joints and without allocation up to 16 of them.
    ///
    /// # Panics
    /// If a slice is shorter than dof.
    pub fn torque(&self, q: &[f64], rates: &[f64], accelerations: &[f64], torque: &mut [f64]) {
        self.rigid_torque(q, rates, accelerations, torque);
        for (i, Joint { drive, .. }) in self.joints.iter().enumerate() {
            torque[i] += drive.damping_n_m_s * rates[i] + drive.friction_n_m * direction(rates[i]);
        }
    }

    /// The same without damping and dry friction: quadratic in the rates.
    pub(crate) fn rigid_torque(&self, q: &[f64], rates: &[f64], accelerations: &[f64], torque: &mut [f64]) {
        let zero = LinkState {
            turn: Matrix3::identity(),
            offset: Vector3::zeros(),
            force: Vector3::zeros(),
            moment: Vector3::zeros(),
        };
        let mut on_stack = [zero; JOINTS_ON_STACK];
        let mut on_heap = Vec::new();
        let links = if self.joints.len() <= JOINTS_ON_STACK {
            &mut on_stack[..self.joints.len()]
        } else {
            on_heap.resize(self.joints.len(), zero);
            &mut on_heap[..]
        };
        let mut velocity = Twist::zero();
        let mut acceleration = Twist::new(self.lift, Vector3::zeros());
        for (i, (joint, state)) in self.joints.iter().zip(&mut *links).enumerate() {
            let parent_from_link = joint_motion(&joint.screw, joint.is_rotary, q[i]);
            let turn = parent_from_link.rotation.to_rotation_matrix().into_inner();
            let offset = parent_from_link.translation.vector;
            // Ad(parent_from_link⁻¹).
            let into_link = |twist: Twist| {
                Twist::new(turn.tr_mul(&(twist.linear - offset.cross(&twist.angular))), turn.tr_mul(&twist.angular))
            };
            let own = joint.screw * rates[i];
            velocity = into_link(velocity) + own;
            acceleration = into_link(acceleration) + bracket(velocity, own) + joint.screw * accelerations[i];
            let (force, moment) = joint.link.momentum(acceleration.linear, acceleration.angular);
            let (momentum, spin) = joint.link.momentum(velocity.linear, velocity.angular);
            *state = LinkState {
                turn,
                offset,
                force: force + velocity.angular.cross(&momentum),
                moment: moment + velocity.angular.cross(&spin) + velocity.linear.cross(&momentum),
            };
        }
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for (i, (joint, state)) in self.joints.iter().zip(&*links).enumerate().rev() {
            force += state.force;
            moment += state.moment;
            torque[i] = joint.screw.linear.dot(&force)
                + joint.screw.angular.dot(&moment)
                + joint.drive.rotor_inertia_kg_m2 * accelerations[i];
            force = state.turn * force;
            moment = state.turn * moment + state.offset.cross(&force);
        }
    }
}

#[cfg(test)]
#[path = "dynamics_tests.rs"]
mod tests;
