//! The node's parameters: one table says name, type, range, default and description of each, for ROS, for the checks, and for
//! `config/reorder.yaml`.

mod declaration;
mod services;
mod table;
mod yaml;

use declaration::Declaration;
pub(crate) use services::{ParameterCall, ParameterServices};
pub(crate) use yaml::defaults;

use planner::Config;
use planner::manipulator::Robot;
use r2r::ParameterValue;

use crate::NodeError;
use table::TABLE;

/// What ROS itself gives to every node beside `use_sim_time`, and is not ours to declare.
const OF_ROS: &str = "start_type_description_service";

/// Every parameter with its present value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameters {
    pub(crate) config: Config,
    pub(crate) robot: RobotSource,
    /// Whether the node's clock is that of `/clock`.
    pub(crate) use_sim_time: bool,
    /// Whether the node goes to work by itself, or waits until its life cycle is managed from outside.
    pub(crate) autostart: bool,
    pub(crate) execution: Execution,
    /// The controller's action, where trajectories are sent as goals.
    pub(crate) action: String,
    /// Poses that arrive one by one are a set when none has come for so long, in s; 0: when ~/replan is called.
    pub(crate) quiet_s: f64,
    /// How long poses wait for the transform from their frame, in s.
    pub(crate) transform_timeout_s: f64,
}

/// How a trajectory gets to the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Execution {
    Topic,
    Action,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            // A source that is wrong must not keep the node from all others.
            config: Config { max_poses: 10_000, ..Config::default() },
            robot: RobotSource::default(),
            use_sim_time: false,
            autostart: true,
            execution: Execution::Topic,
            action: "joint_trajectory_controller/follow_joint_trajectory".into(),
            quiet_s: 1.0,
            transform_timeout_s: 1.0,
        }
    }
}

/// Which robot is planned for: a shipped one by name, or a URDF file with a settings file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct RobotSource {
    pub(crate) name: String,
    pub(crate) urdf_file: String,
    pub(crate) settings_file: String,
    /// Whether what is published on `robot_description` takes the place of the URDF.
    pub(crate) from_description: bool,
}

impl Default for RobotSource {
    fn default() -> Self {
        Self { name: "ur5e".into(), urdf_file: String::new(), settings_file: String::new(), from_description: true }
    }
}

/// A name and the value that somebody wants it to have.
pub(crate) type Change = (String, ParameterValue);

impl Parameters {
    /// What ROS gave to the node at its start. Unknown names are refused, so that a misspelt limit does not silently keep its default.
    pub(crate) fn at_start(given: impl IntoIterator<Item = Change>) -> Result<Self, NodeError> {
        let ours: Vec<Change> = given.into_iter().filter(|(name, _)| name != OF_ROS).collect();
        Self::default().changed(&ours, true).map_err(NodeError::Parameters)
    }

    /// These parameters with some changes, all of them or none.
    ///
    /// # Errors
    /// One sentence that names the parameter and says what is wrong; nothing is changed then.
    pub(crate) fn with(&self, changes: &[Change]) -> Result<Self, String> {
        self.changed(changes, false)
    }

    fn changed(&self, changes: &[Change], at_start: bool) -> Result<Self, String> {
        let mut parameters = self.clone();
        for (name, value) in changes {
            let declaration = find(name).ok_or_else(|| format!("there is no parameter {name}"))?;
            declaration.set(&mut parameters, value, at_start).map_err(|why| format!("{name} {why}"))?;
        }
        parameters.config.check().map_err(|refusal| refusal.to_string())?;
        Ok(parameters)
    }

    pub(crate) fn get(&self, name: &str) -> Option<ParameterValue> {
        find(name).map(|declaration| declaration.get(self))
    }

    /// What the planner has to heed.
    pub(crate) fn planner_config(&self) -> Config {
        // Stamps are taken from the system's clock: on another one they would mean another time.
        Config { handover: self.config.handover && !self.use_sim_time, ..self.config.clone() }
    }
}

impl RobotSource {
    pub(crate) fn load(&self) -> Result<Robot, NodeError> {
        if self.urdf_file.is_empty() {
            return Robot::shipped_with(&self.name, &self.settings()?)
                .map_err(|e| NodeError::Parameters(format!("robot.name: {e}")));
        }
        Robot::from_urdf(&read(&self.urdf_file)?, &self.settings()?)
            .map_err(|e| NodeError::RobotFile { file: self.urdf_file.clone(), reason: e.to_string() })
    }

    /// The robot that a URDF from `robot_description` describes, with these settings.
    pub(crate) fn described(&self, urdf: &str) -> Result<Robot, String> {
        let settings = self.settings().map_err(|error| error.to_string())?;
        Robot::from_urdf(urdf, &settings).map_err(|error| error.to_string())
    }

    /// Frames and limits that no URDF says: from a file, or those of the shipped robot.
    fn settings(&self) -> Result<String, NodeError> {
        if self.settings_file.is_empty() {
            let description = Robot::shipped_description(&self.name);
            return description
                .map(|(_, settings)| settings.to_owned())
                .map_err(|e| NodeError::Parameters(format!("robot.name: {e}")));
        }
        read(&self.settings_file)
    }
}

fn read(file: &str) -> Result<String, NodeError> {
    let failed = |e: std::io::Error| NodeError::RobotFile { file: file.to_owned(), reason: e.to_string() };
    std::fs::read_to_string(file).map_err(failed)
}

fn find(name: &str) -> Option<&'static Declaration> {
    TABLE.iter().find(|declaration| declaration.name == name)
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
