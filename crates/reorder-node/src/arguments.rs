//! The command line, as far as r2r would panic on it.

use crate::NodeError;

/// Makes sure that every `--params-file` exists and is YAML.
pub(crate) fn check_parameter_files(arguments: impl Iterator<Item = String>) -> Result<(), NodeError> {
    let mut arguments = arguments.skip(1);
    while let Some(argument) = arguments.next() {
        if argument != "--params-file" {
            continue;
        }
        let missing = || NodeError::ParameterFile { file: "--params-file".into(), reason: "no file is named".into() };
        let file = arguments.next().ok_or_else(missing)?;
        let refuse = |reason: String| NodeError::ParameterFile { file: file.clone(), reason };
        let text = std::fs::read_to_string(&file).map_err(|error| refuse(error.to_string()))?;
        let document: serde_yaml::Value = serde_yaml::from_str(&text).map_err(|error| refuse(error.to_string()))?;
        let nodes = document.as_mapping().ok_or_else(|| refuse("it has no node names at its top".into()))?;
        for (node, content) in nodes {
            if !has_parameters(content) {
                let node = node.as_str().unwrap_or("?");
                return Err(refuse(format!("{node} has no ros__parameters")));
            }
        }
    }
    Ok(())
}

/// Directly, or under the names of namespaces.
fn has_parameters(content: &serde_yaml::Value) -> bool {
    let Some(content) = content.as_mapping() else { return false };
    content.contains_key("ros__parameters") || content.values().any(has_parameters)
}

/// r2r panics where rcl refuses the arguments; this makes an error of it.
pub(crate) fn create_context() -> Result<r2r::Context, NodeError> {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let created = std::panic::catch_unwind(r2r::Context::create);
    std::panic::set_hook(hook);
    match created {
        Ok(context) => Ok(context?),
        Err(panic) => {
            let why = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
            Err(NodeError::CommandLine(one_line(why.unwrap_or("no reason given"))))
        }
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(content: &str) -> String {
        let path = std::env::temp_dir().join(format!("reorder-node-{}-{}.yaml", std::process::id(), content.len()));
        std::fs::write(&path, content).unwrap();
        let arguments = ["node", "--ros-args", "--params-file", &path.display().to_string()].map(str::to_owned);
        let said = check_parameter_files(arguments.into_iter()).map_or_else(|e| e.to_string(), |()| "fine".into());
        std::fs::remove_file(path).unwrap();
        said
    }

    #[test]
    fn parameter_files_are_checked_before_ros_sees_them() {
        assert_eq!(check("reorder:\n  ros__parameters:\n    approach: true\n"), "fine");
        assert_eq!(check("cell:\n  reorder:\n    ros__parameters:\n      approach: true\n"), "fine");
        assert!(check("reorder:\n  approach: true\n").ends_with("reorder has no ros__parameters"));
        assert!(check("- 1\n- 2\n").ends_with("it has no node names at its top"));
        assert!(check("reorder: [1, 2\n").starts_with("parameter file "));
        let arguments = ["node", "--ros-args", "--params-file", "/nowhere.yaml"].map(str::to_owned);
        let said = check_parameter_files(arguments.into_iter()).unwrap_err().to_string();
        assert!(said.starts_with("parameter file /nowhere.yaml: No such file"), "{said}");
    }
}
