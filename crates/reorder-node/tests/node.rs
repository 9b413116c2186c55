//! The node as the rest of a ROS 2 system sees it: rclpy processes publish to it, listen to it, call it and stop it.
#![allow(clippy::unwrap_used, clippy::approx_constant, missing_docs)]

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use planner::pose_bag::{BagWriter, msg};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
const PARAMETERS: [&str; 3] =
    ["--ros-args", "--params-file", concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/reorder.yaml")];

/// A ROS domain of its own for every test, so that tests run side by side do not hear each other.
struct Domain(u8);

impl Domain {
    fn command(&self, program: impl AsRef<Path>) -> Command {
        let mut command = Command::new(program.as_ref());
        command.env("ROS_DOMAIN_ID", self.0.to_string()).env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn node(&self, arguments: &[&str]) -> Process {
        Process(self.command(env!("CARGO_BIN_EXE_reorder_node")).args(arguments).spawn().unwrap())
    }

    fn peer(&self, script: &str, arguments: &[&str]) -> Process {
        let mut command = self.command(python());
        Process(command.arg(format!("{ROOT}/tests/peers/{script}")).args(arguments).spawn().unwrap())
    }

    fn receiver(&self, bag: &str, out: &Path) -> Process {
        let robot = format!("{ROOT}/config/robots/ur5e");
        let (limits, urdf) = (format!("{robot}.yaml"), format!("{robot}.urdf"));
        let out = out.to_str().unwrap();
        let arguments = ["--limits", &limits, "--urdf", &urdf, "--bag", bag, "--out", out, "--timeout", "60"];
        let mut receiver = self.peer("receive_trajectory.py", &arguments);
        receiver.wait_for_line("MATCHED");
        receiver
    }
}

/// The interpreter that has rclpy: the set-up's, or the shell's where a ROS 2 is sourced.
fn python() -> PathBuf {
    let of_setup = Path::new(ROOT).join(".deps/venv/bin/python");
    let sourced = std::env::var("AMENT_PREFIX_PATH").is_ok_and(|prefix| !Path::new(&prefix).ends_with(".deps/ros"));
    if sourced { "python3".into() } else { of_setup }
}

struct Process(Child);

impl Process {
    fn wait_for_line(&mut self, wanted: &str) {
        let mut output = BufReader::new(self.0.stdout.take().unwrap());
        let mut line = String::new();
        while line.trim() != wanted {
            line.clear();
            assert_ne!(output.read_line(&mut line).unwrap(), 0, "it ended before it printed {wanted}");
        }
        self.0.stdout = Some(output.into_inner());
    }

    fn signal(&self, name: &str) {
        assert!(Command::new("kill").args([name, &self.0.id().to_string()]).status().unwrap().success());
    }

    /// Exit status and standard error. Whoever does not end by itself is killed by `Drop`, after the test failed.
    fn finish(mut self) -> (ExitStatus, String) {
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

fn json(path: PathBuf) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Shuffled poses through rclpy, the node, and rclpy again: the receiver judges the trajectory by itself, the order is the true
/// one, and the node leaves cleanly on `signal`.
fn round_trip(domain: &Domain, shape: &str, signal: &str) {
    let folder = tempfile::tempdir().unwrap();
    let bag = format!("{ROOT}/tests/data/{shape}");
    let node = domain.node(&PARAMETERS);
    let receiver = domain.receiver(&bag, folder.path());
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
    let receiver = domain.receiver(bag, out);
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
    let [scale, handover] = ["timing.acceleration_scale:=0.02", "handover:=true"];
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

/// A peer that holds a conversation with the node and judges it by itself; the node lives on, and leaves when it is asked to.
fn conversation(domain: u8, script: &str, peer: &[&str], node: &[&str]) {
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

fn bag(shape: &str) -> String {
    format!("{ROOT}/tests/data/{shape}")
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
fn what_cannot_be_used_is_said_and_the_next_good_message_is_answered() {
    conversation(74, "check_faults.py", &[&bag("lasa_angle")], &[]);
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
