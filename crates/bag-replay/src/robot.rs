//! Robots by name or from files.

use std::fs;
use std::path::Path;

use planner::manipulator::{ManipulatorError, Robot};

use crate::error::ReplayError;

/// A shipped robot (by name), with its own limits or those of a file, or a robot from a URDF and a file with limits, which has the form
/// of `config/robots/ur5e.yaml`.
///
/// # Errors
/// [`ReplayError::Io`], [`ReplayError::Robot`] with the file at fault, [`ReplayError::NoLimits`].
pub fn load_robot(name: &str, limits: Option<&Path>) -> Result<Robot, ReplayError> {
    let read = |path: &Path| fs::read_to_string(path).map_err(ReplayError::io(path));
    let urdf = name.ends_with(".urdf").then(|| Path::new(name));
    match (urdf, limits) {
        (Some(_), None) => Err(ReplayError::NoLimits { urdf: name.to_owned() }),
        (None, None) => Robot::shipped(name).map_err(at_fault(None)),
        (Some(urdf), Some(limits)) => {
            Robot::from_urdf(&read(urdf)?, &read(limits)?).map_err(at_fault_of_both(urdf, limits))
        }
        (None, Some(limits)) => {
            Robot::shipped_with(name, &read(limits)?).map_err(at_fault(Some(limits.display().to_string())))
        }
    }
}

fn at_fault(files: Option<String>) -> impl FnOnce(ManipulatorError) -> ReplayError {
    move |source| ReplayError::Robot { files, source: Box::new(source) }
}

/// Which of the two is at fault where they do not fit is for the user to say.
fn at_fault_of_both(urdf: &Path, limits: &Path) -> impl FnOnce(ManipulatorError) -> ReplayError {
    let [urdf, limits] = [urdf, limits].map(|path| path.display().to_string());
    move |error| {
        let files = match error {
            ManipulatorError::Urdf { .. } | ManipulatorError::LinkInertia { .. } => urdf,
            ManipulatorError::Settings { .. } => limits,
            _ => format!("{urdf} with {limits}"),
        };
        at_fault(Some(files))(error)
    }
}
