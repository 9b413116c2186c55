//! Parameters of the arm, read at the start.

use planner::manipulator::Robot;
use planner::manipulator::nalgebra::DVector;
use r2r::{Node, ParameterValue};

use crate::ArmError;

pub(crate) struct Settings {
    pub(crate) robot: String,
    pub(crate) rate_hz: f64,
    pub(crate) clock: bool,
    pub(crate) speed: f64,
    positions: Option<Vec<f64>>,
}

impl Settings {
    pub(crate) fn read(node: &Node) -> Result<Self, ArmError> {
        let given = node.params.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let given = given.iter().map(|(name, parameter)| (name.clone(), parameter.value.clone()));
        Self::from_parameters(given).map_err(ArmError::Parameters)
    }

    fn from_parameters(given: impl Iterator<Item = (String, ParameterValue)>) -> Result<Self, String> {
        let mut settings = Self { robot: "ur5e".into(), rate_hz: 200.0, clock: false, speed: 1.0, positions: None };
        for (name, value) in given {
            match (name.as_str(), value) {
                ("use_sim_time" | "start_type_description_service", _) => {}
                ("robot", ParameterValue::String(robot)) => settings.robot = robot,
                ("clock", ParameterValue::Bool(clock)) => settings.clock = clock,
                ("rate_hz", value) => settings.rate_hz = number(&name, &value, [10.0, 1000.0])?,
                ("speed", value) => settings.speed = number(&name, &value, [0.01, 100.0])?,
                ("positions", ParameterValue::DoubleArray(positions)) => settings.positions = Some(positions),
                ("robot" | "clock" | "positions", value) => {
                    return Err(format!("{name} cannot be a {}", value.type_name()));
                }
                _ => return Err(format!("there is no parameter {name}")),
            }
        }
        if settings.speed != 1.0 && !settings.clock {
            return Err(format!("speed {} needs clock:=true: nobody else would know the time", settings.speed));
        }
        Ok(settings)
    }

    /// Where the joints are at the start, in the robot's order.
    pub(crate) fn start(&self, robot: &Robot) -> Result<Vec<f64>, ArmError> {
        let positions = self.positions.clone().unwrap_or_else(|| robot.preferred.as_slice().to_vec());
        let refuse = |why: String| ArmError::Parameters(format!("positions: {why}"));
        if positions.len() != robot.chain.dof() {
            return Err(refuse(format!("{} has {} joints, not {}", robot.name, robot.chain.dof(), positions.len())));
        }
        robot
            .check_within_limits("the start", &DVector::from_column_slice(&positions))
            .map_err(|error| refuse(error.to_string()))?;
        Ok(positions)
    }
}

fn number(name: &str, value: &ParameterValue, [least, most]: [f64; 2]) -> Result<f64, String> {
    let x = match value {
        ParameterValue::Double(x) => *x,
        ParameterValue::Integer(n) => *n as f64,
        other => return Err(format!("{name} must be a number, not a {}", other.type_name())),
    };
    if x >= least && x <= most { Ok(x) } else { Err(format!("{name} must be from {least} to {most}, not {x}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(given: &[(&str, ParameterValue)]) -> Result<Settings, String> {
        Settings::from_parameters(given.iter().map(|(name, value)| ((*name).to_owned(), value.clone())))
    }

    #[test]
    fn wrong_parameters_are_named() {
        let fast = ("speed", ParameterValue::Integer(10));
        assert!(read(&[fast.clone(), ("clock", ParameterValue::Bool(true))]).is_ok_and(|s| s.speed == 10.0));
        for (given, sentence) in [
            (fast, "speed 10 needs clock:=true: nobody else would know the time"),
            (("rate_hz", ParameterValue::Double(5.0)), "rate_hz must be from 10 to 1000, not 5"),
            (("clock", ParameterValue::Integer(1)), "clock cannot be a integer"),
            (("robto", ParameterValue::String("ur5e".into())), "there is no parameter robto"),
        ] {
            assert_eq!(read(&[given]).err().unwrap(), sentence);
        }
        let short = read(&[("positions", ParameterValue::DoubleArray(vec![0.0]))]).unwrap();
        let why = short.start(&Robot::shipped("ur5e").unwrap()).unwrap_err().to_string();
        assert!(why.ends_with("ur5e has 6 joints, not 1"), "{why}");
    }
}
