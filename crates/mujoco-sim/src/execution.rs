//! What a run of a trajectory showed.

use planner::manipulator::nalgebra::DVector;
use planner::se3_geom::{Manifold, Pose, So3};

use crate::contact::ContactEvent;
use crate::error::{Result, SimError};

/// The joints at one moment, each vector in the order of [`Execution::joints`], in rad (m for slides) and per s.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Time from the start in s.
    pub time_s: f64,
    /// Where the trajectory wants the joints.
    pub reference: DVector<f64>,
    /// Where they are.
    pub position: DVector<f64>,
    /// How fast they are.
    pub velocity: DVector<f64>,
}

/// How one joint followed.
#[derive(Debug, Clone, PartialEq)]
pub struct JointTracking {
    /// Its name.
    pub name: String,
    /// Root mean square of its error over all steps, in rad.
    pub rms_rad: f64,
    /// Its greatest error, in rad.
    pub max_rad: f64,
    /// Peak over greatest actuator force; 0 where the model states no limit.
    pub max_torque_ratio: f64,
}

/// A run: figures over every step of the simulation from the trajectory's start to the end of settling.
#[derive(Debug, Clone, PartialEq)]
pub struct Execution {
    /// Duration of the trajectory in s, without settling.
    pub duration_s: f64,
    /// Time step of the simulation in s.
    pub timestep_s: f64,
    /// Root mean square of the error over all joints and steps, in rad.
    pub tracking_rms_rad: f64,
    /// Greatest error of any joint at any step, in rad.
    pub tracking_max_rad: f64,
    /// Joint by joint, in the order of the model's actuators.
    pub joints: Vec<JointTracking>,
    /// Greatest of the joints' ratios of actuator force to limit; 1 where an actuator gave all it can.
    pub max_torque_ratio: f64,
    /// Steps in which a control or an actuator force was cut off at its limit.
    pub saturated_steps: usize,
    /// In the order in which they began.
    pub contacts: Vec<ContactEvent>,
    /// Joint states at [`crate::ExecuteOptions::sample_rate_hz`], the first and the last step among them.
    pub samples: Vec<Sample>,
    /// `world_from_tool` at every step: entry k at time k·`timestep_s`.
    pub tool: Vec<Pose>,
    /// Simulated over elapsed time. The only figure that differs between equal runs.
    pub realtime_factor: f64,
}

/// How far the simulated tool was from where it should have been.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseErrors {
    /// Greatest distance in m.
    pub max_m: f64,
    /// Greatest angle in rad.
    pub max_rad: f64,
}

impl Execution {
    /// Where the tool was at `time_s`: `world_from_tool`, `None` outside the run.
    ///
    /// Between steps of h seconds the position is linear and the rotation turns at constant rate, which misses the motion by at
    /// most a·h²/8: at 2 ms and 10 m/s² by 5e-6 m.
    pub fn tool_at(&self, time_s: f64) -> Option<Pose> {
        let steps = time_s / self.timestep_s;
        let end = self.tool.len().checked_sub(1)?;
        // A pose due at the very end may be late by the rounding of a division.
        if !(steps >= 0.0 && steps <= end as f64 + 1e-6) {
            return None;
        }
        let before = (steps.floor() as usize).min(end);
        let after = (before + 1).min(end);
        let share = (steps - before as f64).clamp(0.0, 1.0);
        // A half turn within one step has no shortest way; the state before is then as good as any.
        let between = self.tool[before].try_lerp_slerp(&self.tool[after], share, 1e-12);
        Some(between.unwrap_or(self.tool[before]))
    }

    /// Distances of the tool from each pose (`world_from_tool`) at its time.
    ///
    /// # Errors
    /// Where there is not one time for each pose, or a time is outside the run.
    pub fn pose_errors(&self, poses: &[Pose], times_s: &[f64]) -> Result<PoseErrors> {
        if poses.len() != times_s.len() {
            return Err(SimError::PoseTimeCount { poses: poses.len(), times: times_s.len() });
        }
        let mut worst = PoseErrors { max_m: 0.0, max_rad: 0.0 };
        for (index, (pose, &time_s)) in poses.iter().zip(times_s).enumerate() {
            let end_s = (self.tool.len() - 1) as f64 * self.timestep_s;
            let tool = self.tool_at(time_s).ok_or(SimError::PoseTime { pose: index, time_s, end_s })?;
            worst.max_m = worst.max_m.max((tool.translation.vector - pose.translation.vector).norm());
            worst.max_rad = worst.max_rad.max(So3.distance(&tool.rotation, &pose.rotation));
        }
        Ok(worst)
    }
}

/// Collects figures while a run goes on.
pub(crate) struct Tally {
    squares: Vec<f64>,
    worst: Vec<f64>,
    torque_ratio: Vec<f64>,
    steps: usize,
}

impl Tally {
    pub(crate) fn new(joints: usize) -> Self {
        Self { squares: vec![0.0; joints], worst: vec![0.0; joints], torque_ratio: vec![0.0; joints], steps: 0 }
    }

    pub(crate) fn state(&mut self, error: &DVector<f64>) {
        for (joint, error) in error.iter().enumerate() {
            self.squares[joint] += error * error;
            self.worst[joint] = self.worst[joint].max(error.abs());
        }
        self.steps += 1;
    }

    /// Takes note of an actuator force as a share of its limit; whether the actuator gave all it can.
    pub(crate) fn torque_ratio(&mut self, joint: usize, ratio: f64) -> bool {
        self.torque_ratio[joint] = self.torque_ratio[joint].max(ratio);
        ratio >= 1.0
    }

    pub(crate) fn tracking_rms(&self) -> f64 {
        (self.squares.iter().sum::<f64>() / (self.steps * self.squares.len()) as f64).sqrt()
    }

    pub(crate) fn joints<'a>(&self, names: impl Iterator<Item = &'a str>) -> Vec<JointTracking> {
        let tracking = |(joint, name): (usize, &str)| JointTracking {
            name: name.to_owned(),
            rms_rad: (self.squares[joint] / self.steps as f64).sqrt(),
            max_rad: self.worst[joint],
            max_torque_ratio: self.torque_ratio[joint],
        };
        names.enumerate().map(tracking).collect()
    }
}
