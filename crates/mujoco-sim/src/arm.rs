//! A simulated arm that executes trajectories.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use mujoco_rs::prelude::*;
use planner::manipulator::JointTrajectory;
use planner::manipulator::nalgebra::DVector;
use planner::se3_geom::Pose;

use crate::chain::site_pose;
use crate::command::Command;
use crate::contact::{ContactLog, Touch, touches};
use crate::error::{Result, SimError};
use crate::execution::{Execution, Sample, Tally};
use crate::model;
use crate::servo::{Servo, servos};

/// An arm in MuJoCo with a position servo on every joint.
///
/// Gains and ranges of the servos are those of the model's actuators. Poses are `world_from_tool`, the tool being a site of the model.
pub struct SimulatedArm {
    servos: Vec<Servo>,
    tool_site: usize,
    plant: MjData<Arc<MjModel>>,
    /// The controller's idea of the arm: the same model without contacts and limits, for inverse dynamics.
    computed_torque: MjData<Arc<MjModel>>,
}

/// How a trajectory is executed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExecuteOptions {
    /// How long the run goes on after the trajectory's end, in s.
    pub settle_s: f64,
    /// Whether the controls carry, beside the reference position, the servo's damping at the reference velocity and the torque
    /// that the reference motion needs. Without it they are the reference position alone.
    pub feed_forward: bool,
    /// How often joint states are kept in the result, in Hz.
    pub sample_rate_hz: f64,
}

impl Default for ExecuteOptions {
    fn default() -> Self {
        Self { settle_s: 0.5, feed_forward: true, sample_rate_hz: 100.0 }
    }
}

/// Longer runs are a mistake of units; they would fill the memory with tool poses.
const LONGEST_RUN_S: f64 = 3600.0;

/// No arm is that fast; MuJoCo itself notices divergence much later, and then silently resets the state.
const RUNAWAY_PER_S: f64 = 1e3;

impl SimulatedArm {
    /// Loads an MJCF model whose tool is marked by the site `tool_site`.
    ///
    /// # Errors
    /// Where the file is no model, has no such site, or actuators that are not position servos.
    pub fn load(path: impl AsRef<Path>, tool_site: &str) -> Result<Self> {
        let file = path.as_ref().display().to_string();
        let model = model::load(path.as_ref())?;
        let servos = servos(&model, &file)?;
        let site = model::site(&model, &file, tool_site)?;
        let mut free = model.clone();
        free.opt_mut().disableflags |= MjtDisableBit::mjDSBL_CONSTRAINT as i32 | MjtDisableBit::mjDSBL_CONTACT as i32;
        let data = |model| {
            let failed = |error: MjDataError| SimError::Model { file: file.clone(), reason: error.to_string() };
            MjData::try_new(Arc::new(model)).map_err(failed)
        };
        Ok(Self { servos, tool_site: site, plant: data(model)?, computed_torque: data(free)? })
    }

    /// Names of the joints, in the order in which every vector of this arm stands.
    pub fn joint_names(&self) -> impl Iterator<Item = &str> {
        self.servos.iter().map(|servo| servo.joint.as_str())
    }

    /// `world_from_tool` at the configuration `q`, in rad (m for slides).
    ///
    /// # Errors
    /// Where `q` has another size than there are joints, or is not finite.
    pub fn tool_pose(&mut self, q: &[f64]) -> Result<Pose> {
        self.place(q)?;
        self.plant.forward_kinematics();
        Ok(self.present_tool_pose())
    }

    /// All points at which bodies touch at the configuration `q`, in rad (m for slides).
    ///
    /// # Errors
    /// As [`SimulatedArm::tool_pose`].
    pub fn touches(&mut self, q: &[f64]) -> Result<Vec<Touch>> {
        self.place(q)?;
        self.plant.fwd_position();
        Ok(touches(self.plant.model(), self.plant.contact(), 0.0).into_iter().map(|(_, touch)| touch).collect())
    }

    /// Executes a trajectory from rest at its first point, and lets the arm settle at its last.
    ///
    /// In every step of h seconds from tₙ the control of each servo is
    ///
    /// c = q_ref(tₙ) + (kd·q̇_ref(tₙ + h/2) + τ)/kp, τ = M(q_ref)·q̈_ref + C(q_ref, q̇_ref),
    ///
    /// with the last two terms only under [`ExecuteOptions::feed_forward`]. τ is the inverse dynamics (mass matrix with rotor inertia,
    /// Coriolis, gravity, less passive forces) of the *reference* motion, so that it depends on nothing measured and adds no
    /// loop of its own to the servo's. Gravity and Coriolis terms alone would leave the inertia to the position error, which
    /// then is M·q̈/kp ≈ 5 kg m²·5 rad/s²/2000 N m/rad ≈ 0.01 rad. The velocity is that of the middle of the step because MuJoCo's
    /// integrators move the joints over the step with one velocity, the mean, to which also the damping applies.
    ///
    /// The same trajectory gives the same run, bit for bit, but for the elapsed time.
    ///
    /// # Errors
    /// Where trajectory and model have not the same joints, the trajectory or an option is malformed, or the simulation diverges.
    pub fn execute(&mut self, trajectory: &JointTrajectory, options: &ExecuteOptions) -> Result<Execution> {
        let command = Command::new(trajectory, &self.servos)?;
        options.check()?;
        let duration_s = trajectory.duration_s();
        let (whole_s, limit_s) = (duration_s + options.settle_s, LONGEST_RUN_S);
        if whole_s > limit_s {
            return Err(SimError::TooLong { duration_s: whole_s, limit_s });
        }
        let timestep_s = self.plant.model_opt().timestep;
        let steps = (whole_s / timestep_s).ceil() as usize;
        let stride = (1.0 / (options.sample_rate_hz * timestep_s)).round().max(1.0) as usize;

        let start = Instant::now();
        self.place(command.at(0.0)[0].as_slice())?;
        let mut tally = Tally::new(self.servos.len());
        let mut contacts = ContactLog::default();
        let mut saturated_steps = 0;
        let (mut samples, mut tool) = (Vec::new(), Vec::with_capacity(steps + 1));
        for step in 0..=steps {
            let time_s = step as f64 * timestep_s;
            let reference = command.at(time_s);
            self.plant.step1();
            let (position, velocity) = self.joint_state();
            tally.state(&(&position - &reference[0]));
            contacts.record(time_s, touches(self.plant.model(), self.plant.contact(), 0.0));
            tool.push(self.present_tool_pose());
            if step % stride == 0 || step == steps {
                samples.push(Sample { time_s, reference: reference[0].clone(), position, velocity });
            }
            if step == steps {
                break;
            }
            let mid_velocity = &command.at(time_s + 0.5 * timestep_s)[1];
            let free = self.set_controls(&reference, mid_velocity, options.feed_forward);
            self.plant.step2();
            self.check_stable(time_s, timestep_s)?;
            let at_limit = self.note_torques(&mut tally);
            saturated_steps += usize::from(!free || at_limit);
        }
        let elapsed_s = start.elapsed().as_secs_f64();

        let joints = tally.joints(self.servos.iter().map(|servo| servo.joint.as_str()));
        Ok(Execution {
            duration_s,
            timestep_s,
            tracking_rms_rad: tally.tracking_rms(),
            tracking_max_rad: joints.iter().map(|joint| joint.max_rad).fold(0.0, f64::max),
            max_torque_ratio: joints.iter().map(|joint| joint.max_torque_ratio).fold(0.0, f64::max),
            joints,
            saturated_steps,
            contacts: contacts.into_events(),
            samples,
            tool,
            realtime_factor: steps as f64 * timestep_s / elapsed_s,
        })
    }

    pub(crate) fn servos(&self) -> &[Servo] {
        &self.servos
    }

    pub(crate) fn model(&self) -> &MjModel {
        self.plant.model()
    }

    /// The same model at its initial state, where shapes nearer than `margin_m` to each other count as contacts.
    pub(crate) fn kinematic_twin(&self, margin_m: f64) -> Result<MjData<Arc<MjModel>>> {
        let mut model = self.plant.model().clone();
        model.geom_margin_mut().fill(margin_m);
        MjData::try_new(Arc::new(model))
            .map_err(|error| SimError::Model { file: "the loaded model".into(), reason: error.to_string() })
    }

    /// Puts the arm at rest at a configuration, everything else of the model as it was loaded.
    fn place(&mut self, q: &[f64]) -> Result<()> {
        if q.len() != self.servos.len() {
            let (expected, given) = (self.servos.len(), q.len());
            return Err(SimError::WrongSize { what: "the configuration".into(), expected, given });
        }
        if !q.iter().all(|value| value.is_finite()) {
            return Err(SimError::NonFinite { what: "the configuration".into() });
        }
        self.plant.reset();
        for (servo, &value) in self.servos.iter().zip(q) {
            self.plant.qpos_mut()[servo.position] = value;
        }
        Ok(())
    }

    /// One step of [`SimulatedArm::step_towards`], and its length in s.
    pub(crate) fn step(&mut self, reference: [DVector<f64>; 3], mid_velocity: &DVector<f64>) -> Result<f64> {
        let timestep_s = self.plant.model_opt().timestep;
        let time_s = self.plant.ffi().time;
        self.plant.step1();
        self.set_controls(&reference, mid_velocity, true);
        self.plant.step2();
        self.check_stable(time_s, timestep_s)?;
        Ok(timestep_s)
    }

    /// Positions in rad (m for slides) and velocities per s, in the order of [`SimulatedArm::joint_names`].
    pub fn joint_state(&self) -> (DVector<f64>, DVector<f64>) {
        let count = self.servos.len();
        let of = |values: &[f64], place: fn(&Servo) -> usize| {
            DVector::from_iterator(count, self.servos.iter().map(|servo| values[place(servo)]))
        };
        (of(self.plant.qpos(), |servo| servo.position), of(self.plant.qvel(), |servo| servo.velocity))
    }

    fn present_tool_pose(&self) -> Pose {
        site_pose(&self.plant, self.tool_site)
    }

    /// Sets all controls; whether all were within their ranges.
    fn set_controls(&mut self, reference: &[DVector<f64>; 3], mid_velocity: &DVector<f64>, feed_forward: bool) -> bool {
        if feed_forward {
            self.inverse_dynamics(reference);
        }
        let torques = self.computed_torque.qfrc_inverse();
        let mut all_free = true;
        for (joint, servo) in self.servos.iter().enumerate() {
            let position = reference[0][joint];
            let wanted = match feed_forward {
                true => servo.control_for(position, mid_velocity[joint], torques[servo.velocity]),
                false => position,
            };
            let (control, free) = servo.clamp(wanted);
            self.plant.ctrl_mut()[servo.control] = control;
            all_free &= free;
        }
        all_free
    }

    /// Computes the generalised forces that the reference motion needs, for every degree of freedom of the model.
    fn inverse_dynamics(&mut self, [position, velocity, acceleration]: &[DVector<f64>; 3]) {
        let data = &mut self.computed_torque;
        for (joint, servo) in self.servos.iter().enumerate() {
            data.qpos_mut()[servo.position] = position[joint];
            data.qvel_mut()[servo.velocity] = velocity[joint];
            data.qacc_mut()[servo.velocity] = acceleration[joint];
        }
        data.inverse();
    }

    /// Notes the actuator forces of the last step; whether one was at its limit.
    fn note_torques(&self, tally: &mut Tally) -> bool {
        let forces = self.plant.actuator_force();
        let mut at_limit = false;
        for (joint, servo) in self.servos.iter().enumerate() {
            at_limit |= tally.torque_ratio(joint, forces[servo.force].abs() / servo.greatest_force);
        }
        at_limit
    }

    fn check_stable(&self, time_s: f64, timestep_s: f64) -> Result<()> {
        let was_reset = self.plant.ffi().time < time_s + 0.5 * timestep_s;
        let (position, velocity) = self.joint_state();
        let calm = velocity.iter().all(|v| v.abs() < RUNAWAY_PER_S) && position.iter().all(|q| q.is_finite());
        if was_reset || !calm { Err(SimError::Diverged { time_s, timestep_s }) } else { Ok(()) }
    }
}

impl ExecuteOptions {
    fn check(&self) -> Result<()> {
        if !(self.settle_s >= 0.0 && self.settle_s.is_finite()) {
            let must_be = "zero or a positive number";
            return Err(SimError::InvalidOption { name: "settle_s", value: self.settle_s, must_be });
        }
        if !(self.sample_rate_hz > 0.0 && self.sample_rate_hz.is_finite()) {
            let must_be = "a positive number";
            return Err(SimError::InvalidOption { name: "sample_rate_hz", value: self.sample_rate_hz, must_be });
        }
        Ok(())
    }
}
