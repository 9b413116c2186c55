//! An arm that is led step by step, by a controller that runs beside the simulation.

use planner::manipulator::nalgebra::DVector;

use crate::arm::SimulatedArm;
use crate::error::{Result, SimError};

/// Where the joints are to be, in the order of [`SimulatedArm::joint_names`].
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// In rad (m for slides).
    pub position: DVector<f64>,
    /// Per s.
    pub velocity: DVector<f64>,
    /// Per s².
    pub acceleration: DVector<f64>,
    /// The velocity half a time step later, per s: see [`SimulatedArm::execute`].
    pub mid_velocity: DVector<f64>,
}

impl Reference {
    /// Rest at a configuration.
    pub fn rest(position: DVector<f64>) -> Self {
        let zeros = DVector::zeros(position.len());
        Self { position, velocity: zeros.clone(), acceleration: zeros.clone(), mid_velocity: zeros }
    }
}

impl SimulatedArm {
    /// Puts the arm at rest at a configuration, in rad (m for slides), at time 0 of the simulation.
    ///
    /// # Errors
    /// As [`SimulatedArm::tool_pose`].
    pub fn stand_at(&mut self, q: &[f64]) -> Result<()> {
        self.tool_pose(q).map(drop)
    }

    /// The model's time step, in s.
    pub fn timestep_s(&self) -> f64 {
        self.model().opt().timestep
    }

    /// Makes one time step with the controls of [`SimulatedArm::execute`], feed-forward included. Returns how long it was, in s.
    ///
    /// # Errors
    /// Where the reference has another size than there are joints or is not finite, or the simulation diverges.
    pub fn step_towards(&mut self, reference: &Reference) -> Result<f64> {
        let Reference { position, velocity, acceleration, mid_velocity } = reference;
        let expected = self.servos().len();
        for (what, values) in [
            ("the reference position", position),
            ("the reference velocity", velocity),
            ("the reference acceleration", acceleration),
            ("the reference velocity half a step on", mid_velocity),
        ] {
            if values.len() != expected {
                return Err(SimError::WrongSize { what: what.into(), expected, given: values.len() });
            }
            if !values.iter().all(|value| value.is_finite()) {
                return Err(SimError::NonFinite { what: what.into() });
            }
        }
        self.step([position.clone(), velocity.clone(), acceleration.clone()], mid_velocity)
    }
}
