//! `$(var …)` and its kin in the texts of a launch file.

use std::collections::BTreeMap;
use std::path::Path;

/// What texts may refer to.
#[derive(Debug, Clone, Default)]
pub(super) struct Scope {
    pub(super) variables: BTreeMap<String, String>,
    /// Of the file at hand.
    pub(super) folder: String,
}

impl Scope {
    pub(super) fn of_file(file: &Path) -> Self {
        let folder = file.parent().map_or_else(|| ".".into(), |folder| folder.display().to_string());
        Self { variables: BTreeMap::new(), folder: if folder.is_empty() { ".".into() } else { folder } }
    }

    /// The text with every substitution made, inner ones first.
    pub(super) fn resolve(&self, text: &str) -> Result<String, String> {
        let mut text = text.to_owned();
        // The last opening has no other inside.
        while let Some(open) = text.rfind("$(") {
            let close = text[open..].find(')').ok_or_else(|| format!("{text:?} has no closing bracket"))? + open;
            // An expression may have brackets of its own inside its quotes; none of the launch files needs that.
            let value = self.evaluate(&text[open + 2..close])?;
            text.replace_range(open..=close, &value);
        }
        Ok(text)
    }

    fn evaluate(&self, inner: &str) -> Result<String, String> {
        let (kind, rest) = inner.trim().split_once(' ').unwrap_or((inner.trim(), ""));
        let rest = rest.trim();
        match kind {
            "var" => self.variables.get(rest).cloned().ok_or_else(|| format!("there is no variable {rest}")),
            "dirname" => Ok(self.folder.clone()),
            "env" => {
                let (name, default) =
                    rest.split_once(' ').map_or((rest, None), |(name, default)| (name, Some(default)));
                let value = std::env::var(name).ok().or_else(|| default.map(|text| text.trim().to_owned()));
                value.ok_or_else(|| format!("the environment has no {name}"))
            }
            "eval" => compare(rest.trim_matches('"')).map(|holds| (if holds { "true" } else { "false" }).to_owned()),
            _ => Err(format!("$({inner}) is not understood here: known are var, dirname, env and eval")),
        }
    }
}

/// `'a' == 'b'` and `'a' != 'b'`: of Python, the expressions that launch files here are written in, no more.
fn compare(expression: &str) -> Result<bool, String> {
    let not_known =
        || format!("the expression {expression:?} is not understood here: known are 'a' == 'b' and 'a' != 'b'");
    let (equal, (left, right)) = match (expression.split_once("=="), expression.split_once("!=")) {
        (Some(sides), None) => (true, sides),
        (None, Some(sides)) => (false, sides),
        _ => return Err(not_known()),
    };
    let quoted = |side: &str| Some(side.trim().strip_prefix('\'')?.strip_suffix('\'')?.to_owned());
    let (left, right) = quoted(left).zip(quoted(right)).ok_or_else(not_known)?;
    Ok((left == right) == equal)
}

/// As ROS reads the value of `if`.
pub(super) fn is_true(text: &str) -> Result<bool, String> {
    match text.trim().to_lowercase().as_str() {
        "true" | "1" => Ok(true),
        "false" | "0" => Ok(false),
        other => Err(format!("{other:?} is neither true nor false")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn substitutions_are_made_from_the_inside_out() {
        let mut scope = Scope::of_file(Path::new("launch/a.launch.yaml"));
        scope.variables.insert("robot".into(), "ur5e".into());
        scope.variables.insert("which".into(), "robot".into());
        assert_eq!(scope.resolve("$(dirname)/../$(var robot).yaml").unwrap(), "launch/../ur5e.yaml");
        assert_eq!(scope.resolve("$(var $(var which))").unwrap(), "ur5e");
        assert_eq!(scope.resolve("$(eval \"'$(var robot)' == 'ur5e'\")").unwrap(), "true");
        assert_eq!(scope.resolve("$(eval \"'$(var robot)' != 'ur5e'\")").unwrap(), "false");
        assert_eq!(scope.resolve("$(env NOBODY_SETS_THIS 7)").unwrap(), "7");
        for bad in ["$(var hal)", "$(var robot", "$(find-pkg-share x)", "$(eval 1 + 1)", "$(env NOBODY_SETS_THIS)"] {
            assert!(scope.resolve(bad).is_err(), "{bad}");
        }
        assert!(is_true("True").unwrap() && !is_true("0").unwrap() && is_true("maybe").is_err());
    }
}
