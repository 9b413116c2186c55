//! The emulated arm as the rest of a ROS 2 system sees it.
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
    command.current_dir(ROOT).stderr(Stdio::piped());
    command
}

/// In real time, and as exactly as servos follow.
#[test]
fn it_executes_cancels_and_refuses_as_a_controller_does() {
    let mut arm = in_domain("85", env!("CARGO_BIN_EXE_dynamixel_arm")).spawn().unwrap();
    let script = format!("{ROOT}/tests/peers/drive_servos.py");
    let driven = in_domain("85", python()).arg(script).output();
    // Ctrl-C; a test that failed leaves no arm behind.
    let asked = Command::new("kill").args(["-INT", &arm.id().to_string()]).status();
    let ended = arm.wait().unwrap();
    let driven = driven.unwrap();
    assert!(driven.status.success(), "{}", String::from_utf8_lossy(&driven.stderr));
    assert!(asked.unwrap().success() && ended.success(), "{ended}");
}

#[test]
fn what_is_wrong_ends_it_with_one_sentence() {
    for (arguments, words) in [
        (["-p", "port:=/dev/ttyNOWHERE"], "port /dev/ttyNOWHERE cannot be opened"),
        (["-p", "config:=nowhere.yaml"], "nowhere.yaml"),
        (["-p", "prot:=sim"], "there is no parameter prot"),
    ] {
        let mut arm = in_domain("86", env!("CARGO_BIN_EXE_dynamixel_arm"));
        let output = arm.arg("--ros-args").args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let ours: Vec<&str> = said.lines().filter(|line| !line.contains("[rcl]")).collect();
        let [sentence] = ours[..] else { panic!("{said}") };
        assert!(sentence.starts_with("dynamixel_arm: ") && sentence.contains(words), "{said}");
    }
}
