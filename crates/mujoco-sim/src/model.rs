//! Where models are and how they are loaded.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use mujoco_rs::prelude::*;

use crate::error::{Result, SimError};

/// Names of the models that the set-up provides.
const KNOWN: &[&str] = &["ur5e", "vx300s", "panda"];

/// Folder with models, where it is not that of the checkout.
const MODELS_VARIABLE: &str = "REORDER_MODELS";

/// Where the set-up puts them.
const MODELS_OF_THE_CHECKOUT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../.deps/mujoco");

/// The file of a model: a path that ends in `.xml` as it is, or a name (`ur5e`) in the folder that the environment variable
/// `REORDER_MODELS` gives, else in that of the set-up.
///
/// # Errors
/// [`SimError::UnknownRobot`] for any other name.
pub fn model_file(robot: &str) -> Result<PathBuf> {
    if Path::new(robot).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("xml")) {
        return Ok(robot.into());
    }
    if !KNOWN.contains(&robot) {
        return Err(SimError::UnknownRobot { name: robot.into(), known: KNOWN.join(", ") });
    }
    let folder = env::var_os(MODELS_VARIABLE).map_or_else(|| MODELS_OF_THE_CHECKOUT.into(), PathBuf::from);
    Ok(folder.join(robot).with_extension("xml"))
}

pub(crate) fn load(path: &Path) -> Result<MjModel> {
    let file = path.display().to_string();
    // MuJoCo reads the file again, for the sake of the meshes beside it; this finds what it would not say or would abort on.
    let hint = if path.is_file() {
        ""
    } else {
        "; `cargo xtask setup` fetches those of the shipped robots, REORDER_MODELS names another folder"
    };
    fs::read_to_string(path).map_err(|source| SimError::Read { file: file.clone(), source, hint })?;
    let refused = |error: MjModelError| {
        let reason = match error {
            MjModelError::LoadFailed(reason) => reason,
            other => other.to_string(),
        };
        SimError::Model { file, reason: reason.split_whitespace().collect::<Vec<_>>().join(" ") }
    };
    MjModel::from_xml(path).map_err(refused)
}

/// Index of the site of that name.
pub(crate) fn site(model: &MjModel, file: &str, name: &str) -> Result<usize> {
    (0..model.ffi().nsite as usize)
        .find(|&site| model.id_to_name(MjtObjBase::mjOBJ_SITE, site) == Some(name))
        .ok_or_else(|| SimError::MissingSite { file: file.into(), site: name.into() })
}
