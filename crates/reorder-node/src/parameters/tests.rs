//! The table against the planner, the parameter file and what people write.

use super::declaration::Kind;
use super::*;

fn changed(changes: &[(&str, ParameterValue)]) -> Result<Parameters, String> {
    Parameters::at_start(changes.iter().map(|(name, value)| ((*name).to_owned(), value.clone())))
        .map_err(|error| error.to_string())
}

fn text(word: &str) -> ParameterValue {
    ParameterValue::String(word.into())
}

#[test]
fn parameters_become_configuration() {
    let parameters = changed(&[
        ("start_type_description_service", ParameterValue::Bool(true)),
        ("approach", ParameterValue::Bool(false)),
        ("metres_per_radian", ParameterValue::Integer(2)),
        ("timing.rate_hz", ParameterValue::Double(250.0)),
        ("timing.limits", text("acceleration")),
        ("timing.tool_speed_m_s", ParameterValue::Double(0.25)),
        ("start", ParameterValue::Integer(3)),
        ("robot.name", text("panda")),
    ])
    .unwrap();
    let config = &parameters.config;
    assert!(!config.approach);
    assert_eq!((config.metres_per_radian, config.timing.rate_hz), (2.0, 250.0), "an integer is a number");
    assert_eq!((config.timing.tool_speed_m_s, config.start), (Some(0.25), Some(3)));
    assert_eq!(config.timing.limits, planner::manipulator::JointLimits::Acceleration);
    assert_eq!(config.path, Config::default().path);
    assert_eq!(parameters.robot.load().unwrap().name, "panda");
    // What was set is what is told.
    assert_eq!(parameters.get("start"), Some(ParameterValue::Integer(3)));
    assert_eq!(parameters.get("timing.limits"), Some(text("acceleration")));
    assert_eq!(Parameters::default().get("start"), Some(ParameterValue::Integer(-1)));
}

/// Stamps by another clock than the controller's would start a trajectory at any time.
#[test]
fn simulated_time_turns_hand_overs_off() {
    let handover = |simulated| {
        let given = [("handover", ParameterValue::Bool(true)), ("use_sim_time", ParameterValue::Bool(simulated))];
        changed(&given).unwrap().planner_config().handover
    };
    assert!(handover(false) && !handover(true));
}

#[test]
fn wrong_parameters_are_refused_by_name() {
    for (name, value, sentence) in [
        ("aproach", ParameterValue::Bool(true), "there is no parameter aproach"),
        ("approach", text("yes"), "approach must be true or false, not a string"),
        ("approach", ParameterValue::BoolArray(vec![true]), "approach must be true or false, not a boolean array"),
        ("timing.rate_hz", text("fast"), "timing.rate_hz must be a number, not a string"),
        ("timing.rate_hz", ParameterValue::Double(-5.0), "timing.rate_hz must be from 10 to 10000, not -5"),
        ("timing.rate_hz", ParameterValue::Double(f64::NAN), "timing.rate_hz must be from 10 to 10000, not NaN"),
        ("topology", text("round"), "topology must be auto or open or closed, not \"round\""),
        ("topology", ParameterValue::Bool(false), "topology must be the string auto or open or closed, not a boolean"),
        ("path.max_branches", ParameterValue::Double(3.0), "path.max_branches must be a whole number, not a double"),
        ("path.max_branches", ParameterValue::Integer(0), "path.max_branches must be from 1 to 1000, not 0"),
        ("start", ParameterValue::Integer(-2), "start must be an index, or -1 for none, not -2"),
    ] {
        assert_eq!(changed(&[(name, value)]).unwrap_err(), format!("parameters: {sentence}"));
    }
    assert!(
        RobotSource { name: "hal".into(), ..RobotSource::default() }.load().unwrap_err().to_string().contains("hal")
    );
}

/// All of several changes or none, and nothing that belongs to the start.
#[test]
fn a_refused_change_changes_nothing() {
    let before = Parameters::default();
    let good = ("timing.rate_hz".to_owned(), ParameterValue::Double(50.0));
    let bad = ("timing.jerk_scale".to_owned(), ParameterValue::Double(2.0));
    assert_eq!(before.with(&[good.clone(), bad]).unwrap_err(), "timing.jerk_scale must be from 0.001 to 1, not 2");
    // Each alone is in its range; together they contradict each other.
    let of_tool = |name: &str, speed| (format!("timing.{name}tool_speed_m_s"), ParameterValue::Double(speed));
    let why = before.with(&[of_tool("", 0.1), of_tool("constant_", 0.2)]).unwrap_err();
    assert!(why.contains("at most tool_speed_m_s"), "{why}");
    let robot = ("robot.name".to_owned(), text("panda"));
    assert!(before.with(&[robot]).unwrap_err().starts_with("robot.name is read at the start only"));
    assert_eq!(before.with(&[good]).unwrap().config.timing.rate_hz, 50.0);
    assert_eq!(before, Parameters::default());
}

/// The planner has checks of its own: what the table allows must pass them, at both ends of every range.
#[test]
fn every_range_is_one_that_the_planner_accepts() {
    for row in TABLE {
        let ends = match row.kind {
            Kind::Real { range, .. } | Kind::OptionalReal { range, .. } => range.map(ParameterValue::Double),
            Kind::Count { range, .. } => range.map(|n| ParameterValue::Integer(n as i64)),
            Kind::Choice { words, .. } => [words[0], words[words.len() - 1]].map(text),
            _ => continue,
        };
        for end in ends {
            let set = Parameters::default().changed(&[(row.name.to_owned(), end.clone())], true).unwrap();
            assert_eq!(row.get(&set), end, "{}", row.name);
        }
    }
}

/// `config/reorder.yaml` is what `reorder_node --parameters` prints, and says nothing but the defaults.
#[test]
fn the_parameter_file_is_that_of_the_table() {
    let file = include_str!("../../../../config/reorder.yaml");
    assert_eq!(file, yaml::defaults(), "run `target/debug/reorder_node --parameters > config/reorder.yaml`");
    let document: serde_yaml::Value = serde_yaml::from_str(file).unwrap();
    let parameters = document["/**"]["ros__parameters"].as_mapping().unwrap();
    let count: usize = parameters.values().map(|value| value.as_mapping().map_or(1, serde_yaml::Mapping::len)).sum();
    assert_eq!(count, TABLE.len());
    assert_eq!(document["/**"]["ros__parameters"]["timing"]["rate_hz"].as_f64(), Some(100.0));
}
