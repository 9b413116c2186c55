//! What the tests that cross crates share: the checkout, its recordings, and its Python.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use planner::se3_geom::Pose;

/// The top of the checkout.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The recorded, shuffled poses of a shape, and the input indices in true order.
///
/// # Panics
/// Where a recording of this repository is missing or broken.
pub fn recording(shape: &str) -> (Vec<Pose>, Vec<usize>) {
    let bag = root().join("tests/data").join(shape);
    let mut sets = pose_bag::read_poses(&bag, None).expect("the recording is readable");
    assert_eq!(sets.len(), 1, "one PoseArray a recording");
    let truth = std::fs::read_to_string(bag.with_extension("truth.json")).expect("the truth lies beside the bag");
    let truth: serde_json::Value = serde_json::from_str(&truth).expect("the truth is JSON");
    let order = truth["order"].as_array().expect("the truth has an order");
    (sets.remove(0).poses, order.iter().map(|i| i.as_u64().expect("an index") as usize).collect())
}

/// A Python script with the interpreter of the set-up, which has ROS 2, rosbags and numpy.
pub fn python(arguments: &[&str]) -> std::process::Output {
    let interpreter = root().join(".deps/venv/bin/python");
    let mut command = Command::new(&interpreter);
    command.args(arguments).current_dir(root()).stdin(Stdio::null());
    command.output().unwrap_or_else(|error| panic!("{}: {error}; run `cargo xtask setup`", interpreter.display()))
}
