//! Parameters of the arm, read at the start.

use arm_node::{Pacing, ParameterValue, Parameters, number};
use planner::manipulator::Robot;
use planner::manipulator::nalgebra::DVector;

pub(crate) struct Settings {
    pub(crate) robot: String,
    pub(crate) pacing: Pacing,
    positions: Option<Vec<f64>>,
}

impl Settings {
    pub(crate) fn from_parameters(given: Parameters) -> Result<Self, String> {
        let pacing = Pacing { rate_hz: 200.0, clock: false, speed: 1.0 };
        let mut settings = Self { robot: "ur5e".into(), pacing, positions: None };
        for (name, value) in given {
            match (name.as_str(), value) {
                ("robot", ParameterValue::String(robot)) => settings.robot = robot,
                ("clock", ParameterValue::Bool(clock)) => settings.pacing.clock = clock,
                ("rate_hz", value) => settings.pacing.rate_hz = number(&name, &value, [10.0, 1000.0])?,
                ("speed", value) => settings.pacing.speed = number(&name, &value, [0.01, 100.0])?,
                ("positions", ParameterValue::DoubleArray(positions)) => settings.positions = Some(positions),
                ("robot" | "clock" | "positions", value) => {
                    return Err(format!("{name} cannot be a {}", value.type_name()));
                }
                _ => return Err(format!("there is no parameter {name}")),
            }
        }
        let Pacing { clock, speed, .. } = settings.pacing;
        if speed != 1.0 && !clock {
            return Err(format!("speed {speed} needs clock:=true: nobody else would know the time"));
        }
        Ok(settings)
    }

    /// Where the joints are at the start, in the robot's order.
    pub(crate) fn start(&self, robot: &Robot) -> Result<Vec<f64>, String> {
        let positions = self.positions.clone().unwrap_or_else(|| robot.preferred.as_slice().to_vec());
        let refuse = |why: String| format!("positions: {why}");
        if positions.len() != robot.chain.dof() {
            return Err(refuse(format!("{} has {} joints, not {}", robot.name, robot.chain.dof(), positions.len())));
        }
        robot
            .check_within_limits("the start", &DVector::from_column_slice(&positions))
            .map_err(|error| refuse(error.to_string()))?;
        Ok(positions)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(given: &[(&str, ParameterValue)]) -> Result<Settings, String> {
        Settings::from_parameters(given.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect())
    }

    #[test]
    fn wrong_parameters_are_named() {
        let fast = ("speed", ParameterValue::Integer(10));
        assert!(read(&[fast.clone(), ("clock", ParameterValue::Bool(true))]).is_ok_and(|s| s.pacing.speed == 10.0));
        for (given, sentence) in [
            (fast, "speed 10 needs clock:=true: nobody else would know the time"),
            (("rate_hz", ParameterValue::Double(5.0)), "rate_hz must be from 10 to 1000, not 5"),
            (("clock", ParameterValue::Integer(1)), "clock cannot be a integer"),
            (("robto", ParameterValue::String("ur5e".into())), "there is no parameter robto"),
        ] {
            assert_eq!(read(&[given]).err().unwrap(), sentence);
        }
        let short = read(&[("positions", ParameterValue::DoubleArray(vec![0.0]))]).unwrap();
        let why = short.start(&Robot::shipped("ur5e").unwrap()).unwrap_err();
        assert!(why.ends_with("ur5e has 6 joints, not 1"), "{why}");
    }
}
