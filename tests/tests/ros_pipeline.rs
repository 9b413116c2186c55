//! Node, arm and publishers as processes that die, are far apart, or are launched together.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fs;
use std::process::{Child, Command, Output, Stdio};

use end_to_end::{executable, root, ros_python};

/// A peer in a domain of its own, with what it prints.
fn peer(domain: u8, script: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(ros_python());
    command.arg(root().join("tests/peers").join(script)).args(arguments).stdin(Stdio::null());
    command.env("ROS_DOMAIN_ID", domain.to_string()).env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
    command.output().unwrap()
}

fn expect_success(output: &Output) {
    let [printed, said] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success(), "{said}{printed}");
    eprintln!("{printed}");
}

/// On an idle machine it takes two to four seconds, most of them Python's.
fn restarts(domain: u8, execution: &str) {
    let [node, arm] = ["reorder_node", "mujoco_arm"].map(|name| executable(name).display().to_string());
    let bag = root().join("tests/data/lasa_angle").display().to_string();
    expect_success(&peer(
        domain,
        "check_restarts.py",
        &[&node, &arm, &bag, "--execution", execution, "--within", "10"],
    ));
}

#[test]
fn whoever_is_killed_comes_back_and_no_goal_is_executed_twice() {
    restarts(83, "action");
}

#[test]
fn whoever_is_killed_comes_back_and_no_trajectory_is_executed_twice() {
    restarts(84, "topic");
}

/// A sample of `cargo xtask soak link`.
#[test]
fn across_a_long_link_every_array_is_answered_or_counted() {
    let unshare = |arguments: &[&str]| {
        let mut command = Command::new("unshare");
        command.args(["--user", "--map-root-user", "--net"]).args(arguments).stdin(Stdio::null());
        command.output()
    };
    if !unshare(&["true"]).is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: this machine gives nobody a network namespace of their own");
        return;
    }
    let path = |of: &str| root().join(of).display().to_string();
    let (python, node) = (ros_python().display().to_string(), executable("reorder_node").display().to_string());
    let (script, bag, profile) =
        (path("tests/peers/two_hosts.py"), path("tests/data/lasa_angle"), path("config/dds/wan.xml"));
    let output = unshare(&[&python, &script, &node, &bag, "--profile", &profile, "--seconds", "8", "--cuts", "2"]);
    expect_success(&output.unwrap());
}

/// What a launch starts leaves with it, also where only the launch is asked to leave, as a container's first process is.
#[test]
fn a_launched_pipeline_moves_the_arm_and_leaves_nothing_behind() {
    let domain = 85;
    for signal in ["-INT", "-TERM"] {
        let mark = format!("REORDER_TEST_LAUNCH={}{signal}", std::process::id());
        let mut launch = launch(domain, &mark, &["launch/ur5e_simulation.launch.yaml"]);
        let seen = peer(domain, "check_launch.py", &[&root().join("tests/data/lasa_angle").display().to_string()]);
        let started = marked(&mark);
        assert!(Command::new("kill").args([signal, &launch.id().to_string()]).status().unwrap().success());
        let ended = launch.wait().unwrap();
        expect_success(&seen);
        assert_eq!((ended.success(), started, marked(&mark)), (true, 3, 0), "launch, node and arm");
    }
}

/// The publisher waits for the arm and ends; the rest goes on.
#[test]
fn a_bag_is_replayed_once_the_robot_is_heard_of() {
    let mark = format!("REORDER_TEST_REPLAY={}", std::process::id());
    let mut launch = launch(86, &mark, &["launch/bag_replay.launch.yaml"]);
    let seen = peer(86, "check_launch.py", &[]);
    assert!(Command::new("kill").args(["-INT", &launch.id().to_string()]).status().unwrap().success());
    assert!(launch.wait().unwrap().success());
    expect_success(&seen);
    assert_eq!(marked(&mark), 0);
}

/// `cargo xtask launch` with what is built already.
fn launch(domain: u8, mark: &str, arguments: &[&str]) -> Child {
    let (name, value) = mark.split_once('=').unwrap();
    // As cargo names it, or the set-up's ROS 2 would be taken for another one.
    let root = root().canonicalize().unwrap();
    let mut command = Command::new(executable("xtask"));
    command.args(["launch", "--no-build"]).args(arguments).current_dir(&root).stdin(Stdio::null());
    command.env("CARGO_MANIFEST_DIR", root.join("crates/xtask")).env(name, value);
    command.env("ROS_DOMAIN_ID", domain.to_string()).stdout(Stdio::piped()).spawn().unwrap()
}

/// Processes that are left of a launch, by what only they have in their environment.
fn marked(mark: &str) -> usize {
    let environments =
        fs::read_dir("/proc").unwrap().filter_map(|entry| fs::read(entry.ok()?.path().join("environ")).ok());
    environments.filter(|text| text.split(|byte| *byte == 0).any(|variable| variable == mark.as_bytes())).count()
}
