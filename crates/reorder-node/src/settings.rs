//! ROS parameters to planner configuration and robot.

use planner::Config;
use planner::manipulator::Robot;
use r2r::ParameterValue;
use serde::Deserialize;
use serde_yaml::{Mapping, Value};

use crate::NodeError;

/// Parameters that ROS itself gives to every node.
const OF_ROS: [&str; 2] = ["use_sim_time", "start_type_description_service"];

/// Which robot is planned for: a shipped one by name, or a URDF file with a settings file.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct RobotSettings {
    name: String,
    urdf_file: String,
    settings_file: String,
}

impl Default for RobotSettings {
    fn default() -> Self {
        Self { name: "ur5e".into(), urdf_file: String::new(), settings_file: String::new() }
    }
}

/// The robot and the configuration that the node's parameters describe. Unknown names are refused, so that a misspelt limit
/// does not silently keep its default.
pub(crate) fn from_parameters(
    parameters: impl IntoIterator<Item = (String, ParameterValue)>,
) -> Result<(Robot, Config), NodeError> {
    let mut tree = Mapping::new();
    let mut simulated_time = false;
    for (name, value) in parameters {
        simulated_time |= name == "use_sim_time" && value == ParameterValue::Bool(true);
        if !OF_ROS.contains(&name.as_str()) {
            insert(&mut tree, &name, yaml(&name, value)?)?;
        }
    }
    let robot = match tree.remove("robot") {
        None => RobotSettings::default(),
        Some(value) => serde_yaml::from_value(value).map_err(|e| NodeError::Parameters(format!("robot: {e}")))?,
    };
    let text = serde_yaml::to_string(&tree).map_err(|e| NodeError::Parameters(e.to_string()))?;
    let mut config = Config::from_yaml(&text).map_err(|e| NodeError::Parameters(e.to_string()))?;
    // Stamps are taken from the system's clock: on another one they would mean another time.
    config.handover &= !simulated_time;
    Ok((load(&robot)?, config))
}

fn load(settings: &RobotSettings) -> Result<Robot, NodeError> {
    if settings.urdf_file.is_empty() {
        return Robot::shipped(&settings.name).map_err(|e| NodeError::Parameters(format!("robot.name: {e}")));
    }
    let read = |file: &str| {
        std::fs::read_to_string(file).map_err(|e| NodeError::RobotFile { file: file.to_owned(), reason: e.to_string() })
    };
    Robot::from_urdf(&read(&settings.urdf_file)?, &read(&settings.settings_file)?)
        .map_err(|e| NodeError::RobotFile { file: settings.urdf_file.clone(), reason: e.to_string() })
}

/// Puts `a.b.c` into nested mappings.
fn insert(tree: &mut Mapping, name: &str, value: Value) -> Result<(), NodeError> {
    let Some((head, rest)) = name.split_once('.') else {
        tree.insert(name.into(), value);
        return Ok(());
    };
    let branch = tree.entry(head.into()).or_insert_with(|| Value::Mapping(Mapping::new()));
    let branch = branch
        .as_mapping_mut()
        .ok_or_else(|| NodeError::Parameters(format!("{head} is both a value and a group of values")))?;
    insert(branch, rest, value)
}

fn yaml(name: &str, value: ParameterValue) -> Result<Value, NodeError> {
    Ok(match value {
        ParameterValue::Bool(x) => x.into(),
        ParameterValue::Integer(x) => x.into(),
        ParameterValue::Double(x) => x.into(),
        ParameterValue::String(x) => x.into(),
        other => return Err(NodeError::Parameters(format!("{name} must be one value, not {other:?}"))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(parameters: &[(&str, ParameterValue)]) -> Result<(Robot, Config), String> {
        from_parameters(parameters.iter().map(|(n, v)| ((*n).to_owned(), v.clone()))).map_err(|e| e.to_string())
    }

    #[test]
    fn parameters_become_configuration() {
        let (robot, config) = read(&[
            ("use_sim_time", ParameterValue::Bool(false)),
            ("approach", ParameterValue::Bool(false)),
            ("metres_per_radian", ParameterValue::Integer(2)),
            ("timing.rate_hz", ParameterValue::Double(250.0)),
            ("robot.name", ParameterValue::String("ur5e".into())),
        ])
        .unwrap();
        assert_eq!(robot.name, "ur5e");
        assert!(!config.approach);
        assert_eq!(config.metres_per_radian, 2.0, "an integer is a number");
        assert_eq!(config.timing.rate_hz, 250.0);
        assert_eq!(config.path, Config::default().path);
    }

    /// Stamps by another clock than the controller's would start a trajectory at any time.
    #[test]
    fn simulated_time_turns_hand_overs_off() {
        let wanted = ("handover", ParameterValue::Bool(true));
        let handover =
            |simulated| read(&[wanted.clone(), ("use_sim_time", ParameterValue::Bool(simulated))]).unwrap().1.handover;
        assert!(handover(false) && !handover(true));
    }

    #[test]
    fn wrong_parameters_are_refused_by_name() {
        let misspelt = read(&[("aproach", ParameterValue::Bool(true))]).unwrap_err();
        assert!(misspelt.contains("aproach"), "{misspelt}");
        let nested = read(&[("timing.rate", ParameterValue::Double(1.0))]).unwrap_err();
        assert!(nested.contains("rate"), "{nested}");
        let robot = read(&[("robot.name", ParameterValue::String("hal".into()))]).unwrap_err();
        assert!(robot.contains("hal"), "{robot}");
        let list = read(&[("approach", ParameterValue::BoolArray(vec![true]))]).unwrap_err();
        assert!(list.contains("approach"), "{list}");
    }
}
