//! The table as a parameter file with its comments: `config/reorder.yaml` is this text.

use r2r::ParameterValue;

use super::{Declaration, Parameters, TABLE};

const WIDTH: usize = 130;

/// The parameter file that changes nothing.
pub(crate) fn defaults() -> String {
    let mut text = String::from(
        "# Parameters of the node, whatever its name and namespace. Every value below is the default. Unknown names are refused. Written\n\
         # by `reorder_node --parameters`; `ros2 param describe` says the same.\n/**:\n  ros__parameters:\n",
    );
    let mut group = "";
    for declaration in TABLE {
        let (of, name) = declaration.name.split_once('.').unwrap_or(("", declaration.name));
        if of != group {
            group = of;
            text += &format!("    {group}:\n");
        }
        let indent = if group.is_empty() { "    " } else { "      " };
        for line in wrapped(&declaration.description(), WIDTH - indent.len() - 2) {
            text += &format!("{indent}# {line}\n");
        }
        text += &format!("{indent}{name}: {}\n", scalar(declaration));
    }
    text
}

fn scalar(declaration: &Declaration) -> String {
    match declaration.get(&Parameters::default()) {
        ParameterValue::Bool(flag) => flag.to_string(),
        ParameterValue::Integer(n) => n.to_string(),
        // With a point, or ROS takes it for an integer.
        ParameterValue::Double(x) => format!("{x:?}"),
        ParameterValue::String(text) if text.is_empty() => "\"\"".into(),
        ParameterValue::String(text) => text,
        other => format!("{other:?}"),
    }
}

fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last().map_or(0, |line| line.chars().count());
        if line > 0 && line + 1 + word.chars().count() > width {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            let gap = if line.is_empty() { "" } else { " " };
            *line += &format!("{gap}{word}");
        }
    }
    lines
}
