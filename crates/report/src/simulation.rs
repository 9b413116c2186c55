//! What `reorder simulate --format json` printed.

use planner::manipulator::JointTrajectory;
use serde::{Deserialize, Serialize};

use crate::error::ReportError;
use crate::packed::Packed;
use crate::words::{Statement, counted, statement};

/// By how much a run may last longer or shorter than the trajectory it is of, in s: the command prints all digits, other programs may
/// not.
const SAME_DURATION_S: f64 = 1e-3;

/// A run of the trajectory in MuJoCo.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Simulation {
    duration_s: f64,
    tracking_rms_rad: f64,
    tracking_max_rad: f64,
    pose_error_max_m: Option<f64>,
    pose_error_max_rad: Option<f64>,
    contacts: usize,
    max_torque_ratio: f64,
    saturated_steps: usize,
    joints: Vec<Joint>,
    tracking: Tracking,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Joint {
    name: String,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Tracking {
    time_s: Vec<f64>,
    error_rad: Vec<Vec<f64>>,
}

/// The tracking error as the page draws it: rows of joints in the order of the trajectory's.
#[derive(Debug, Serialize)]
pub(crate) struct Followed {
    times_s: Packed,
    errors: Packed,
    statements: Vec<Statement>,
}

impl Simulation {
    /// Reads the JSON object.
    ///
    /// # Errors
    /// [`ReportError::Simulation`] with what is missing or wrong in it.
    pub fn from_json(text: &str) -> Result<Self, ReportError> {
        let wrong = |reason: String| ReportError::Simulation { reason };
        let simulation: Self = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
        let Tracking { time_s, error_rad } = &simulation.tracking;
        if error_rad.len() != simulation.joints.len() || error_rad.iter().any(|of| of.len() != time_s.len()) {
            return Err(wrong(
                "tracking.error_rad has not one list for each joint, with one error for each time".into(),
            ));
        }
        if time_s.windows(2).any(|pair| pair[1] <= pair[0]) {
            return Err(wrong("tracking.time_s does not increase".into()));
        }
        Ok(simulation)
    }

    /// The run of this trajectory.
    pub(crate) fn of(&self, trajectory: &JointTrajectory) -> Result<Followed, ReportError> {
        let wrong = |reason: String| ReportError::Simulation { reason };
        let planned_s = trajectory.duration_s();
        if (self.duration_s - planned_s).abs() > SAME_DURATION_S {
            let ran_s = self.duration_s;
            return Err(wrong(format!("it is of a trajectory of {ran_s:.3} s, and this one takes {planned_s:.3} s")));
        }
        let place = |name: &String| self.joints.iter().position(|joint| joint.name == *name);
        let mut joints = Vec::new();
        for name in &trajectory.joint_names {
            joints.push(place(name).ok_or_else(|| wrong(format!("it has no joint {name}")))?);
        }
        let Tracking { time_s, error_rad } = &self.tracking;
        let row = |k: usize| joints.iter().map(move |&joint| error_rad[joint][k]);
        Ok(Followed {
            times_s: Packed::double(time_s.iter().copied()),
            errors: Packed::single((0..time_s.len()).flat_map(row)),
            statements: self.statements(),
        })
    }

    fn statements(&self) -> Vec<Statement> {
        let (rms, worst) = (self.tracking_rms_rad, self.tracking_max_rad);
        let mut said = vec![statement("tracking", format!("{rms:.2e} rad rms, {worst:.2e} rad at worst"))];
        if let (Some(metres), Some(radians)) = (self.pose_error_max_m, self.pose_error_max_rad) {
            said.push(statement("poses", format!("{metres:.2e} m and {radians:.2e} rad off at worst")));
        }
        let (share, cut) = (100.0 * self.max_torque_ratio, counted(self.saturated_steps, "step"));
        said.push(statement("torque", format!("{share:.1} % of the limit at most, {cut} saturated")));
        said.push(statement("contacts", counted(self.contacts, "contact")));
        said
    }
}
