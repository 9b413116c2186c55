//! Parameters as they were given at the start.

use r2r::{Node, ParameterValue};

/// Names and values, but for those that every node has.
pub type Parameters = Vec<(String, ParameterValue)>;

/// Those that rcl adds to every node.
const OF_EVERY_NODE: [&str; 2] = ["use_sim_time", "start_type_description_service"];

pub(crate) fn given(node: &Node) -> Parameters {
    let given = node.params.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let own = given.iter().filter(|(name, _)| !OF_EVERY_NODE.contains(&name.as_str()));
    own.map(|(name, parameter)| (name.clone(), parameter.value.clone())).collect()
}

/// A number within bounds, or a sentence.
///
/// # Errors
/// Where it is none, or beyond them.
pub fn number(name: &str, value: &ParameterValue, [least, most]: [f64; 2]) -> Result<f64, String> {
    let x = match value {
        ParameterValue::Double(x) => *x,
        ParameterValue::Integer(n) => *n as f64,
        other => return Err(format!("{name} must be a number, not a {}", other.type_name())),
    };
    if x >= least && x <= most { Ok(x) } else { Err(format!("{name} must be from {least} to {most}, not {x}")) }
}
