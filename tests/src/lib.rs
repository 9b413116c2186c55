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

/// The interpreter that has rclpy: the set-up's, or the shell's where a ROS 2 is sourced.
pub fn ros_python() -> PathBuf {
    let sourced = std::env::var("AMENT_PREFIX_PATH").is_ok_and(|prefix| !Path::new(&prefix).ends_with(".deps/ros"));
    if sourced { "python3".into() } else { root().join(".deps/venv/bin/python") }
}

/// An executable of another crate, beside the test that runs: `cargo test --workspace` builds them all.
///
/// # Panics
/// Where it was not built.
pub fn executable(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test has a file");
    let built = test.ancestors().nth(2).expect("it lies in deps").join(name);
    assert!(built.is_file(), "{} is not there: run `cargo build --workspace`", built.display());
    built
}
