//! Nodes and rclpy peers as child processes.
#![allow(dead_code)] // Not every file of tests needs everything.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};

pub(crate) const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
pub(crate) const PARAMETERS: [&str; 3] =
    ["--ros-args", "--params-file", concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/reorder.yaml")];

/// A ROS domain of its own for every test, so that tests run side by side do not hear each other.
pub(crate) struct Domain(pub(crate) u8);

impl Domain {
    fn command(&self, program: impl AsRef<Path>) -> Command {
        let mut command = Command::new(program.as_ref());
        command.env("ROS_DOMAIN_ID", self.0.to_string()).env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub(crate) fn node(&self, arguments: &[&str]) -> Process {
        Process(self.command(env!("CARGO_BIN_EXE_reorder_node")).args(arguments).spawn().unwrap())
    }

    pub(crate) fn peer(&self, script: &str, arguments: &[&str]) -> Process {
        let mut command = self.command(python());
        Process(command.arg(format!("{ROOT}/tests/peers/{script}")).args(arguments).spawn().unwrap())
    }
}

/// The interpreter that has rclpy: the set-up's, or the shell's where a ROS 2 is sourced.
fn python() -> PathBuf {
    let of_setup = Path::new(ROOT).join(".deps/venv/bin/python");
    let sourced = std::env::var("AMENT_PREFIX_PATH").is_ok_and(|prefix| !Path::new(&prefix).ends_with(".deps/ros"));
    if sourced { "python3".into() } else { of_setup }
}

pub(crate) struct Process(pub(crate) Child);

impl Process {
    pub(crate) fn wait_for_line(&mut self, wanted: &str) {
        let mut output = BufReader::new(self.0.stdout.take().unwrap());
        let mut line = String::new();
        while line.trim() != wanted {
            line.clear();
            assert_ne!(output.read_line(&mut line).unwrap(), 0, "it ended before it printed {wanted}");
        }
        self.0.stdout = Some(output.into_inner());
    }

    pub(crate) fn signal(&self, name: &str) {
        assert!(Command::new("kill").args([name, &self.0.id().to_string()]).status().unwrap().success());
    }

    /// Exit status and standard error. Whoever does not end by itself is killed by `Drop`, after the test failed.
    pub(crate) fn finish(mut self) -> (ExitStatus, String) {
        let mut said = String::new();
        self.0.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        (self.0.wait().unwrap(), said)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A peer that holds a conversation with the node and judges it by itself; the node lives on, and leaves when it is asked to.
pub(crate) fn conversation(domain: u8, script: &str, peer: &[&str], node: &[&str]) {
    let domain = Domain(domain);
    // The peer is the robot's driver too, and may be late with it where tests run side by side.
    let patient = ["-p", "joint_state_max_age_s:=30.0"];
    let node = domain.node(&[&PARAMETERS[..], &patient, node].concat());
    let (held, said) = domain.peer(script, peer).finish();
    assert!(held.success(), "{said}");
    node.signal("-INT");
    let (ended, log) = node.finish();
    assert!(ended.success(), "{ended}: {log}");
}

pub(crate) fn bag(shape: &str) -> String {
    format!("{ROOT}/tests/data/{shape}")
}
