//! What must not hurt the node: too much at once, for too long, files that are none, and namespaces.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use std::fs;
use std::io::Read;

use support::{Domain, PARAMETERS, bag, conversation};

const QUIET: [&str; 3] = ["--ros-args", "--log-level", "error"];

#[test]
fn what_cannot_be_used_is_said_and_the_next_good_message_is_answered() {
    conversation(74, "check_faults.py", &[&bag("lasa_angle")], &[]);
}

/// What a peer prints that is given the process of a node, too.
fn judged(domain: u8, script: &str, bag: &str, peer: &[&str]) -> serde_json::Value {
    let domain = Domain(domain);
    let node = domain
        .node(&[&QUIET[..], &["-p", "joint_state_max_age_s:=30.0", "-p", "timing.limits:=acceleration"]].concat());
    let process = node.0.id().to_string();
    let mut judge = domain.peer(script, &[&[bag], peer, &[&process]].concat());
    let mut printed = String::new();
    judge.0.stdout.take().unwrap().read_to_string(&mut printed).unwrap();
    let (judged, said) = judge.finish();
    assert!(judged.success(), "{said}{printed}");
    node.signal("-INT");
    assert!(node.finish().0.success());
    eprintln!("{printed}");
    serde_json::from_str(&printed).unwrap()
}

#[test]
fn a_million_poses_are_refused_while_everything_else_goes_on() {
    judged(75, "check_million.py", &bag("lasa_angle"), &[]);
}

/// A sample of `cargo xtask soak load`, slower, so that a busy machine plans in time.
#[test]
fn under_load_every_array_is_answered_or_counted() {
    let peer = ["--rate", "2", "--seconds", "10", "--warm-up", "5", "--pid"];
    let figures = judged(76, "load_node.py", &bag("lasa_sine"), &peer);
    let grown = figures["memory_mib_end"].as_f64().unwrap() - figures["memory_mib_warm"].as_f64().unwrap();
    assert!(grown <= 5.0, "memory grew by {grown} MiB");
    assert!(figures["answered"].as_u64().unwrap() > 0, "{figures}");
}

/// The file is for a node of any name, wherever it is.
#[test]
fn the_parameter_file_holds_in_a_namespace() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("parameters.yaml").display().to_string();
    let shipped = fs::read_to_string(PARAMETERS[2]).unwrap();
    let changed = shipped.replace("rate_hz: 100.0", "rate_hz: 125.0");
    assert_ne!(changed, shipped);
    fs::write(&file, changed).unwrap();
    let domain = Domain(77);
    for (place, node) in
        [(["__ns:=/left", "__node:=reorder"], "/left/reorder"), (["__ns:=/", "__node:=planner"], "/planner")]
    {
        let _node = domain.node(&["--ros-args", "-r", place[0], "-r", place[1], "--params-file", &file]);
        let mut reader = domain.peer("get_parameter.py", &[node, "timing.rate_hz"]);
        let mut printed = String::new();
        reader.0.stdout.take().unwrap().read_to_string(&mut printed).unwrap();
        let (read, said) = reader.finish();
        assert!(read.success() && printed.trim() == "125.0", "{printed}{said}");
    }
}

/// Where rcl or r2r would panic or say nothing.
#[test]
fn a_parameter_file_that_is_none_ends_the_node_with_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("parameters.yaml").display().to_string();
    let of_node = |content: &str| format!("/**:\n  ros__parameters:\n{content}").into_bytes();
    for (content, words) in [
        (Vec::new(), "no node names"),
        (b"\xff\xfe\x00\x01".to_vec(), "UTF-8"),
        (b"/**:\n\tros__parameters: {}\n".to_vec(), "parameter file"),
        (b"/**:\n  ros__parameters: [1, 2\n".to_vec(), "parameter file"),
        (b"/**:\n  ros__parameters: 5\n".to_vec(), ""),
        (of_node("    timing: {rate_hz: fast}\n"), "timing.rate_hz must be a number"),
        (of_node("    approach: 1\n"), "approach must be true or false"),
        (of_node("    approach: [[1], [2]]\n"), "command line"),
        (of_node("    robot: {name: hal}\n"), "hal"),
        (of_node("    timing.rate_hz: 1.0e999\n"), "rate_hz"),
    ] {
        fs::write(&file, &content).unwrap();
        one_sentence(&file, words);
    }
    one_sentence(&folder.path().display().to_string(), "directory");
}

fn one_sentence(file: &str, words: &str) {
    let (ended, said) = Domain(78).node(&["--ros-args", "--params-file", file]).finish();
    assert_eq!(ended.code(), Some(2), "{said}");
    // rcl logs for itself where it refuses a file; what we say is one line.
    let ours: Vec<&str> = said.lines().filter(|line| line.starts_with("reorder_node: ")).collect();
    assert!(ours.len() == 1 && ours[0].contains(words), "{words:?} in {said}");
    assert!(!said.contains("panicked"), "{said}");
}

/// It takes as long as DDS needs to give a participant up that died (20 s).
#[test]
fn a_controller_that_dies_is_missed() {
    conversation(79, "check_dead_controller.py", &[&bag("lasa_angle")], &["-p", "execution:=action"]);
}
