//! What a YAML launch file asks for: the subset of ROS 2 launch that the files in `launch/` are written in.
//!
//! Everything is read in order, as launch does: what is set holds for what follows, to the end of its group. Unknown actions and keys
//! are refused, as launch refuses them.

use std::fs;
use std::path::{Path, PathBuf};

use serde_yaml::{Mapping, Value};

use super::substitution::{Scope, is_true};

/// A process to be started.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Process {
    pub(super) program: Program,
    pub(super) arguments: Vec<String>,
    pub(super) environment: Vec<(String, String)>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Program {
    /// An executable of a ROS package.
    Node {
        package: String,
        executable: String,
    },
    Command(String),
}

/// What holds in a group.
#[derive(Debug, Clone, Default)]
struct Context {
    scope: Scope,
    namespace: String,
    remaps: Vec<(String, String)>,
    environment: Vec<(String, String)>,
}

/// The processes of a file, with some of its arguments given.
pub(super) fn processes(file: &Path, given: &[(String, String)]) -> Result<Vec<Process>, String> {
    let mut context = Context { scope: Scope::of_file(file), ..Context::default() };
    let mut found = Vec::new();
    let declared = read(file, given, &mut context, &mut found)?;
    match given.iter().find(|(name, _)| !declared.contains(name)) {
        Some((name, _)) => Err(format!("{} has no argument {name}: it has {}", file.display(), declared.join(", "))),
        None => Ok(found),
    }
}

/// Reads a file into `found`; the names of its arguments.
fn read(
    file: &Path,
    given: &[(String, String)],
    context: &mut Context,
    found: &mut Vec<Process>,
) -> Result<Vec<String>, String> {
    let named = |why: String| format!("{}: {why}", file.display());
    let text = fs::read_to_string(file).map_err(|error| named(error.to_string()))?;
    let document: Value = serde_yaml::from_str(&text).map_err(|error| named(error.to_string()))?;
    let actions =
        document.get("launch").and_then(Value::as_sequence).ok_or_else(|| named("it has no list `launch`".into()))?;
    let mut declared = Vec::new();
    for action in actions {
        act(action, given, context, found, &mut declared).map_err(named)?;
    }
    Ok(declared)
}

fn act(
    action: &Value,
    given: &[(String, String)],
    context: &mut Context,
    found: &mut Vec<Process>,
    declared: &mut Vec<String>,
) -> Result<(), String> {
    let (name, content) = only_entry(action)?;
    if name == "group" {
        // What is set inside ends with it.
        let mut inner = context.clone();
        let actions = content.as_sequence().ok_or("a group must be a list")?;
        return actions.iter().try_for_each(|action| act(action, given, &mut inner, found, declared));
    }
    let mut keys = Keys::of(name, content)?;
    if !keys.holds(&context.scope)? {
        return Ok(());
    }
    match name {
        "arg" => {
            let name = keys.text("name", &context.scope)?;
            let default = keys.optional("default", &context.scope)?;
            keys.take("description");
            let value = given.iter().rfind(|(known, _)| *known == name).map(|(_, value)| value.clone()).or(default);
            let value = value.ok_or_else(|| format!("the argument {name} has no default: give {name}:=…"))?;
            declared.push(name.clone());
            context.scope.variables.insert(name, value);
        }
        "let" => {
            let (name, value) = (keys.text("name", &context.scope)?, keys.text("value", &context.scope)?);
            context.scope.variables.insert(name, value);
        }
        "set_env" => {
            let pair = (keys.text("name", &context.scope)?, keys.text("value", &context.scope)?);
            context.environment.push(pair);
        }
        "log" => println!("{}", keys.text("message", &context.scope)?),
        "push_ros_namespace" => {
            let namespace = keys.text("namespace", &context.scope)?;
            context.namespace = joined(&context.namespace, &namespace);
        }
        "set_remap" => context.remaps.push((keys.text("from", &context.scope)?, keys.text("to", &context.scope)?)),
        "node" => found.push(node(&mut keys, context)?),
        "executable" => {
            let command = keys.text("cmd", &context.scope)?;
            let environment = environment(&mut keys, context)?;
            keys.take("output");
            let mut words = command.split_whitespace().map(str::to_owned);
            let program = Program::Command(words.next().ok_or("cmd is empty")?);
            found.push(Process { program, arguments: words.collect(), environment });
        }
        "include" => {
            let file = PathBuf::from(keys.text("file", &context.scope)?);
            let mut arguments = Vec::new();
            for argument in keys.list("arg")? {
                let mut pair = Keys::of("arg", &argument)?;
                arguments.push((pair.text("name", &context.scope)?, pair.text("value", &context.scope)?));
                pair.nothing_left()?;
            }
            let mut inner = Context { scope: Scope::of_file(&file), ..context.clone() };
            read(&file, &arguments, &mut inner, found)?;
            // As in launch, only a group keeps to itself what an included file sets.
            (context.environment, context.remaps, context.namespace) =
                (inner.environment, inner.remaps, inner.namespace);
        }
        _ => return Err(format!("the action {name} is not understood here")),
    }
    keys.nothing_left()
}

fn node(keys: &mut Keys, context: &Context) -> Result<Process, String> {
    let scope = &context.scope;
    let package = keys.text("pkg", scope)?;
    let executable = keys.text("exec", scope)?;
    let mut arguments: Vec<String> =
        keys.optional("args", scope)?.unwrap_or_default().split_whitespace().map(str::to_owned).collect();
    keys.take("output");
    if keys.optional("respawn", scope)?.is_some_and(|respawn| respawn != "false") {
        return Err("respawn is not understood here, but \"false\"".into());
    }
    arguments.push("--ros-args".into());
    let namespace = keys
        .optional("namespace", scope)?
        .map_or_else(|| context.namespace.clone(), |own| joined(&context.namespace, &own));
    if !namespace.is_empty() {
        arguments.extend(["-r".into(), format!("__ns:={namespace}")]);
    }
    if let Some(name) = keys.optional("name", scope)? {
        arguments.extend(["-r".into(), format!("__node:={name}")]);
    }
    for (from, to) in &context.remaps {
        arguments.extend(["-r".into(), format!("{from}:={to}")]);
    }
    for remap in keys.list("remap")? {
        let mut pair = Keys::of("remap", &remap)?;
        arguments.extend(["-r".into(), format!("{}:={}", pair.text("from", scope)?, pair.text("to", scope)?)]);
        pair.nothing_left()?;
    }
    for parameter in keys.list("param")? {
        parameters("", &parameter, scope, &mut arguments)?;
    }
    let environment = environment(keys, context)?;
    Ok(Process { program: Program::Node { package, executable }, arguments, environment })
}

/// A file, a name with a value, or a name with parameters of its own.
fn parameters(group: &str, parameter: &Value, scope: &Scope, arguments: &mut Vec<String>) -> Result<(), String> {
    let mut keys = Keys::of("param", parameter)?;
    if let Some(file) = keys.optional("from", scope)? {
        arguments.extend(["--params-file".into(), file]);
        return keys.nothing_left();
    }
    let name = format!("{group}{}", keys.text("name", scope)?);
    for inner in keys.list("param")? {
        parameters(&format!("{name}."), &inner, scope, arguments)?;
    }
    if let Some(value) = keys.take("value") {
        arguments.extend(["-p".into(), format!("{name}:={}", written(&value, scope)?)]);
    }
    keys.nothing_left()
}

/// As ROS reads it back from a command line.
fn written(value: &Value, scope: &Scope) -> Result<String, String> {
    match value {
        Value::String(text) => scope.resolve(text),
        Value::Sequence(values) => {
            let values = values.iter().map(|value| written(value, scope)).collect::<Result<Vec<_>, _>>()?;
            Ok(format!("[{}]", values.join(", ")))
        }
        Value::Bool(flag) => Ok(flag.to_string()),
        Value::Number(number) => Ok(number.to_string()),
        _ => Err("a parameter must be a text, a number, a flag or a list of these".into()),
    }
}

fn environment(keys: &mut Keys, context: &Context) -> Result<Vec<(String, String)>, String> {
    let mut environment = context.environment.clone();
    for entry in keys.list("env")? {
        let mut pair = Keys::of("env", &entry)?;
        environment.push((pair.text("name", &context.scope)?, pair.text("value", &context.scope)?));
        pair.nothing_left()?;
    }
    Ok(environment)
}

/// A namespace inside another; one with a leading slash stands by itself.
fn joined(outer: &str, inner: &str) -> String {
    match inner {
        "" => outer.to_owned(),
        inner if inner.starts_with('/') => inner.to_owned(),
        inner => format!("{}/{inner}", outer.trim_end_matches('/')),
    }
}

fn only_entry(action: &Value) -> Result<(&str, &Value), String> {
    let mapping = action.as_mapping().filter(|mapping| mapping.len() == 1);
    let entry = mapping.and_then(|mapping| mapping.iter().next());
    let entry = entry.and_then(|(name, content)| Some((name.as_str()?, content)));
    entry.ok_or_else(|| "every entry must be one action with its content".into())
}

/// The keys of an action that nobody has asked for yet.
struct Keys {
    action: String,
    left: Mapping,
}

impl Keys {
    fn of(action: &str, content: &Value) -> Result<Self, String> {
        let left = content.as_mapping().cloned().ok_or_else(|| format!("{action} must have keys and values"))?;
        Ok(Self { action: action.to_owned(), left })
    }

    fn take(&mut self, key: &str) -> Option<Value> {
        self.left.remove(key)
    }

    fn optional(&mut self, key: &str, scope: &Scope) -> Result<Option<String>, String> {
        let Some(value) = self.take(key) else { return Ok(None) };
        let text = value.as_str().map(str::to_owned).or_else(|| value.as_bool().map(|flag| flag.to_string()));
        let text = text.or_else(|| value.as_f64().map(|number| number.to_string()));
        scope.resolve(&text.ok_or_else(|| format!("{key} of {} must be one value", self.action))?).map(Some)
    }

    fn text(&mut self, key: &str, scope: &Scope) -> Result<String, String> {
        self.optional(key, scope)?.ok_or_else(|| format!("{} has no {key}", self.action))
    }

    fn list(&mut self, key: &str) -> Result<Vec<Value>, String> {
        match self.take(key) {
            None => Ok(Vec::new()),
            Some(Value::Sequence(values)) => Ok(values),
            Some(_) => Err(format!("{key} of {} must be a list", self.action)),
        }
    }

    /// Whether the conditions of the action hold.
    fn holds(&mut self, scope: &Scope) -> Result<bool, String> {
        let wanted = self.optional("if", scope)?.map_or(Ok(true), |text| is_true(&text))?;
        let unwanted = self.optional("unless", scope)?.map_or(Ok(false), |text| is_true(&text))?;
        Ok(wanted && !unwanted)
    }

    fn nothing_left(&self) -> Result<(), String> {
        match self.left.keys().next().and_then(Value::as_str) {
            Some(key) => Err(format!("{} has a key {key} that is not understood here", self.action)),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
#[path = "file_tests.rs"]
mod tests;
