//! The node as the rest of a ROS 2 system sees it: rclpy processes publish to it, listen to it, call it and stop it.
#![allow(clippy::unwrap_used, clippy::approx_constant, missing_docs)]

mod support;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use planner::pose_bag::{BagWriter, msg};
use support::{Domain, PARAMETERS, Process, ROOT, bag, conversation};

fn receiver(domain: &Domain, bag: &str, out: &Path) -> Process {
    let robot = format!("{ROOT}/config/robots/ur5e");
    let (limits, urdf) = (format!("{robot}.yaml"), format!("{robot}.urdf"));
    let out = out.to_str().unwrap();
    let arguments = ["--limits", &limits, "--urdf", &urdf, "--bag", bag, "--out", out, "--timeout", "60"];
    let mut receiver = domain.peer("receive_trajectory.py", &arguments);
    receiver.wait_for_line("MATCHED");
    receiver
}

fn json(path: PathBuf) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Shuffled poses through rclpy, the node, and rclpy again: the receiver judges the trajectory by itself, the order is the true
/// one, and the node leaves cleanly on `signal`.
fn round_trip(domain: &Domain, shape: &str, signal: &str) {
    let folder = tempfile::tempdir().unwrap();
    let bag = format!("{ROOT}/tests/data/{shape}");
    let node = domain.node(&PARAMETERS);
    let receiver = receiver(domain, &bag, folder.path());
    let (published, said) = domain.peer("publish_bag.py", &[&bag, "--joint-state", "home"]).finish();
    assert!(published.success(), "{said}");
    let (received, problems) = receiver.finish();
    assert!(received.success(), "{problems}");

    let report = json(folder.path().join("report.json"));
    let truth = json(PathBuf::from(format!("{bag}.truth.json")))["order"].clone();
    let mut backward = truth.as_array().unwrap().clone();
    backward.reverse();
    assert!(report["order"] == truth || report["order"] == serde_json::Value::Array(backward));
    // The joint state came by name in another order than the robot's; the trajectory starts exactly there.
    let trajectory = json(folder.path().join("trajectory.json"));
    assert_eq!(trajectory["q"][0], serde_json::json!([-1.5708, -1.5708, 1.5708, -1.5708, -1.5708, 0.0]));

    let asked = Instant::now();
    node.signal(signal);
    let (ended, log) = node.finish();
    assert!(ended.success(), "{ended}: {log}");
    assert!(asked.elapsed() < Duration::from_secs(5), "{:?}", asked.elapsed());
}

/// What the receiver hears of poses that the node refuses, with no joint state. The node lives on, and leaves when it is asked to.
fn refusal(domain: &Domain, bag: &str, out: &Path) -> String {
    let node = domain.node(&PARAMETERS);
    let receiver = receiver(domain, bag, out);
    let (published, said) = domain.peer("publish_bag.py", &[bag]).finish();
    assert!(published.success(), "{said}");
    let (received, said) = receiver.finish();
    assert_eq!(received.code(), Some(4), "{said}");
    node.signal("-INT");
    assert!(node.finish().0.success(), "a refusal is no reason to fall over");
    said
}

#[test]
fn poses_become_a_trajectory_and_ctrl_c_ends_the_node() {
    round_trip(&Domain(61), "lasa_angle", "-INT");
}

#[test]
fn poses_become_a_trajectory_and_sigterm_ends_the_node() {
    round_trip(&Domain(62), "lasa_gshape", "-TERM");
}

/// Nothing is planned through poses of which one is none; the report says which.
#[test]
fn a_bad_pose_is_refused_by_its_index() {
    let domain = Domain(63);
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bad").display().to_string();
    let pose = |w: f64| msg::Pose {
        position: msg::Point { x: 0.4, y: 0.1, z: 0.4 },
        orientation: msg::Quaternion { x: 0.0, y: 0.0, z: 0.0, w },
    };
    let header = msg::Header { frame_id: "base_link".into(), ..Default::default() };
    let mut writer = BagWriter::create(&bag).unwrap();
    writer.write("/reorder/poses", 0, &msg::PoseArray { header, poses: vec![pose(1.0), pose(0.0)] }).unwrap();
    writer.finish().unwrap();

    let said = refusal(&domain, &bag, folder.path());
    assert_eq!(said.trim(), "Refused: pose 1: the quaternion is zero, so there is no orientation");
}

/// Without a joint state nobody knows where the robot stands, and a trajectory would begin with a jump.
#[test]
fn nothing_is_planned_for_a_robot_that_nobody_has_heard_of() {
    let domain = Domain(66);
    let folder = tempfile::tempdir().unwrap();
    let bag = format!("{ROOT}/tests/data/lasa_sine");
    let said = refusal(&domain, &bag, folder.path());
    assert!(said.starts_with("Refused: no joint state with all joints of ur5e has arrived"), "{said}");
}

/// A peer executes a trajectory, asks for other poses on the way, and finds no jump where the new trajectory takes over.
#[test]
fn new_poses_take_over_from_the_trajectory_under_execution() {
    let domain = Domain(67);
    // Slow, so that much of the motion is left even where planning takes long.
    let [scale, handover] = ["timing.acceleration_scale:=0.01", "handover:=true"];
    let node = domain.node(&[&PARAMETERS[..], &["-p", handover, "-p", scale]].concat());
    let robot = format!("{ROOT}/config/robots/ur5e");
    let [first, second] = ["lasa_sine", "lasa_angle"].map(|shape| format!("{ROOT}/tests/data/{shape}"));
    let (limits, urdf) = (format!("{robot}.yaml"), format!("{robot}.urdf"));
    let (judged, said) = domain.peer("take_over.py", &[&first, &second, "--limits", &limits, "--urdf", &urdf]).finish();
    assert!(judged.success(), "{said}");
    node.signal("-INT");
    let (ended, log) = node.finish();
    assert!(ended.success(), "{ended}: {log}");
}

#[test]
fn replan_and_clear_answer() {
    let domain = Domain(64);
    let node = domain.node(&PARAMETERS);
    let (called, said) = domain.peer("call_triggers.py", &["/reorder/replan", "/reorder/clear"]).finish();
    assert!(called.success(), "{said}");
    assert_eq!(
        said.lines().collect::<Vec<_>>(),
        ["/reorder/replan False: there are no poses to plan", "/reorder/clear True: poses and results are forgotten"]
    );
    node.signal("-INT");
    assert!(node.finish().0.success());
}

#[test]
fn parameters_are_described_checked_and_changed_at_run_time() {
    conversation(68, "check_parameters.py", &[&bag("lasa_angle")], &[]);
}

#[test]
fn the_life_cycle_is_that_of_a_managed_node_of_rclpy() {
    conversation(69, "check_lifecycle.py", &[], &["-p", "autostart:=false", "-p", "require_joint_state:=false"]);
}

#[test]
fn health_and_markers_say_what_goes_on() {
    conversation(70, "check_health.py", &[&bag("lasa_angle"), &format!("{ROOT}/config/robots/ur5e.urdf")], &[]);
}

#[test]
fn poses_are_taken_from_any_frame_that_tf_knows() {
    conversation(71, "check_frames.py", &[&bag("lasa_angle")], &[]);
}

#[test]
fn poses_that_come_one_by_one_are_planned_as_one() {
    let node = ["-p", "quiet_s:=0.0", "-p", "require_joint_state:=false"];
    conversation(73, "check_collecting.py", &[&bag("lasa_angle")], &node);
}

#[test]
fn trajectories_are_goals_of_a_controller() {
    conversation(72, "check_action.py", &[&bag("lasa_angle")], &["-p", "execution:=action"]);
}

#[test]
fn wrong_parameters_end_the_node_with_one_sentence() {
    let domain = Domain(65);
    for (arguments, words) in [
        (vec!["--ros-args", "--params-file", "/nowhere.yaml"], ["/nowhere.yaml", "No such file"]),
        (vec!["--ros-args", "-p", "aproach:=true"], ["aproach", "no parameter"]),
        (vec!["--ros-args", "-p", "timing.rate_hz:=fast"], ["rate_hz", "must be a number"]),
        (vec!["--ros-args", "-p", "robot.name:=hal"], ["robot.name", "hal"]),
        (vec!["--ros-args", "-p", "timing.rate_hz:=-5.0"], ["rate_hz", "-5"]),
        (vec!["--ros-args", "-p", "path.tolerance_m:=0.0"], ["tolerance_m", "0"]),
        (vec!["--ros-args", "-p", "approach"], ["command line", "approach"]),
    ] {
        let (ended, said) = domain.node(&arguments).finish();
        assert_eq!(ended.code(), Some(2), "{said}");
        // rcl logs for itself where it refuses its arguments; what we say is one line.
        let ours: Vec<&str> = said.lines().filter(|line| !line.contains("[rcl]")).collect();
        let [sentence] = ours[..] else { panic!("{said}") };
        assert!(sentence.starts_with("reorder_node: ") && words.iter().all(|w| sentence.contains(w)), "{said}");
    }
}
