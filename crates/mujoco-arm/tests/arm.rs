//! The arm as the rest of a ROS 2 system sees it.
#![allow(clippy::unwrap_used, missing_docs)]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The interpreter that has rclpy: the set-up's, or the shell's where a ROS 2 is sourced.
fn python() -> PathBuf {
    let of_setup = Path::new(ROOT).join(".deps/venv/bin/python");
    let sourced = std::env::var("AMENT_PREFIX_PATH").is_ok_and(|prefix| !Path::new(&prefix).ends_with(".deps/ros"));
    if sourced { "python3".into() } else { of_setup }
}

fn in_domain(domain: &str, program: impl AsRef<Path>) -> Command {
    let mut command = Command::new(program.as_ref());
    command.env("ROS_DOMAIN_ID", domain).env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST").stdin(Stdio::null());
    command.stderr(Stdio::piped());
    command
}

#[test]
fn it_executes_cancels_and_refuses_as_a_controller_does() {
    let arguments = ["--ros-args", "-p", "clock:=true", "-p", "speed:=3.0", "-p", "rate_hz:=100.0"];
    let mut arm = in_domain("81", env!("CARGO_BIN_EXE_mujoco_arm")).args(arguments).spawn().unwrap();
    let driven = in_domain("81", python()).arg(format!("{ROOT}/tests/peers/drive_arm.py")).output();
    // Ctrl-C; a test that failed leaves no arm behind.
    let asked = Command::new("kill").args(["-INT", &arm.id().to_string()]).status();
    let ended = arm.wait().unwrap();
    let driven = driven.unwrap();
    assert!(driven.status.success(), "{}", String::from_utf8_lossy(&driven.stderr));
    assert!(asked.unwrap().success() && ended.success(), "{ended}");
}

#[test]
fn wrong_parameters_end_it_with_one_sentence() {
    for (arguments, words) in [
        (["-p", "robot:=hal"], "hal"),
        (["-p", "speed:=3.0"], "clock"),
        (["-p", "rate_hz:=fast"], "must be a number"),
        (["-p", "robot"], "command line"),
        (["--params-file", "/nowhere.yaml"], "/nowhere.yaml"),
    ] {
        let mut arm = in_domain("82", env!("CARGO_BIN_EXE_mujoco_arm"));
        let output = arm.arg("--ros-args").args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        // rcl logs for itself where it refuses its arguments; what we say is one line.
        let ours: Vec<&str> = said.lines().filter(|line| !line.contains("[rcl]")).collect();
        let [sentence] = ours[..] else { panic!("{said}") };
        assert!(sentence.starts_with("mujoco_arm: ") && sentence.contains(words), "{said}");
    }
}
