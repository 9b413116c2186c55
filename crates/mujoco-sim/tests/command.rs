//! The command `reorder-simulate` from outside.

// Helpers of tests are not seen as tests.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mujoco_sim::planner::manipulator::JointTrajectory;
use mujoco_sim::planner::pose_bag::{read_poses, read_table, write_csv};
use mujoco_sim::{ExecuteOptions, read_trajectory};
use support::{FOLDED, HOME, quintic_move, ur5e};

const GOAL: [f64; 6] = [-0.6, -1.2, 1.2, -1.8, -1.0, 0.8];

/// An empty folder of this test.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn csv(trajectory: &JointTrajectory) -> String {
    let columns = ["position", "velocity", "acceleration"]
        .map(|kind| trajectory.joint_names.iter().map(|joint| format!(",{joint}.{kind}")).collect::<String>());
    let rows = trajectory.points.iter().map(|point| {
        let values = point.positions.iter().chain(&point.velocities).chain(&point.accelerations);
        point.time_s.to_string() + &values.map(|value| format!(",{value}")).collect::<String>() + "\n"
    });
    format!("t{}\n", columns.concat()) + &rows.collect::<String>()
}

fn simulate(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_reorder-simulate"));
    command.current_dir(folder).args(arguments).output().unwrap()
}

fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn complaint(folder: &Path, arguments: &[&str]) -> String {
    let output = simulate(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    assert!(output.stdout.is_empty());
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.trim_end().lines().count(), 1, "more than a sentence: {text}");
    text.strip_prefix("reorder-simulate: ").expect("names itself").trim_end().to_owned()
}

#[test]
fn everything_asked_for_is_written() {
    let folder = folder("all");
    let trajectory = quintic_move(HOME, GOAL, 2.0);
    fs::write(folder.join("trajectory.csv"), csv(&trajectory)).unwrap();
    let times: Vec<f64> = (0..=20).map(|i| f64::from(i) * 0.1).collect();
    let mut arm = ur5e();
    let poses: Vec<_> = times.iter().map(|&time| arm.tool_pose(trajectory.at(time)[0].as_slice()).unwrap()).collect();
    write_csv(folder.join("poses.csv"), &poses).unwrap();
    let report = serde_json::json!({ "n": 21, "plan": { "robot": "ur5e", "pose_times_s": times } });
    fs::write(folder.join("report.json"), report.to_string()).unwrap();

    let arguments = "trajectory.csv --robot ur5e --poses poses.csv --report report.json -o run.mcap --csv run.csv \
                     --picture run.svg --format json";
    let output = stdout(&simulate(&folder, &arguments.split_whitespace().collect::<Vec<_>>()));
    let summary: serde_json::Value = serde_json::from_str(&output).unwrap();

    let execution = arm.execute(&trajectory, &ExecuteOptions::default()).unwrap();
    let errors = execution.pose_errors(&poses, &times).unwrap();
    let figures = [
        ("duration_s", 2.0),
        ("tracking_rms_rad", execution.tracking_rms_rad),
        ("tracking_max_rad", execution.tracking_max_rad),
        ("max_torque_ratio", execution.max_torque_ratio),
        ("contacts", 0.0),
        ("pose_error_max_m", errors.max_m),
        ("pose_error_max_rad", errors.max_rad),
    ];
    for (key, expected) in figures {
        let found = summary[key].as_f64().unwrap_or_else(|| panic!("no {key} in {output}"));
        // JSON carries shortest round-trip decimals; the poses in the CSV were normalised once more on reading (some 1e-16).
        assert!((found - expected).abs() < 1e-12, "{key}: {found} instead of {expected}");
    }
    assert!(summary["realtime_factor"].as_f64().unwrap() > 0.0);

    let bag = read_poses(folder.join("run.mcap"), Some("/reorder/poses")).unwrap();
    assert_eq!(bag[0].poses.len(), poses.len());
    for (read, pose) in bag[0].poses.iter().zip(&poses) {
        assert_eq!(read.translation, pose.translation);
        // Quaternions are normalised on reading, some 1e-16; angles below 1e-8 come out of an arc cosine.
        assert!(read.rotation.angle_to(&pose.rotation) < 1e-7);
    }
    assert_eq!(bag[0].frame_id, "base_link");
    let table = read_table(folder.join("run.csv")).unwrap();
    assert_eq!(table.len(), execution.samples.len());
    let positions = table.select(&["t", "elbow_joint.position", "elbow_joint.reference"]).unwrap();
    let sample = &execution.samples[100];
    assert_eq!(positions[100], [sample.time_s, sample.position[2], sample.reference[2]]);

    let picture = fs::read_to_string(folder.join("run.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"));
    // Two projections of 21 poses each.
    assert_eq!(picture.matches("<circle").count(), 2 * 21);
    for words in ["Executed in MuJoCo: 2.00 s", "tracking error / rad", "joint velocity", "wrist_3_joint"] {
        assert!(picture.contains(words), "the picture does not say {words:?}");
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 6, "something else was left behind");
}

#[test]
fn contacts_are_told_and_are_no_failure() {
    let folder = folder("contacts");
    fs::write(folder.join("fold.csv"), csv(&quintic_move(HOME, FOLDED, 2.0))).unwrap();
    let text = stdout(&simulate(&folder, &["fold.csv", "--robot", "ur5e"]));
    assert!(text.contains("upper_arm_link and ") && text.contains(" mm deep"), "{text}");
    let json = stdout(&simulate(&folder, &["fold.csv", "--robot", "ur5e", "--format", "json"]));
    let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
    let count = summary["contacts"].as_u64().unwrap();
    assert!(count > 0 && summary["contact_events"].as_array().unwrap().len() as u64 == count);
    assert!(summary["pose_error_max_m"].is_null() && summary["sweep"].is_null());

    let swept = ["fold.csv", "--robot", "ur5e", "--clearance", "0.01"];
    let text = stdout(&simulate(&folder, &swept));
    assert!(text.contains("planned path ") && text.contains(" mm apart"), "{text}");
    let json = stdout(&simulate(&folder, &[&swept[..], &["--format", "json"]].concat()));
    let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
    let sweep = &summary["sweep"];
    let (contacts, approaches) = (sweep["contacts"].as_array().unwrap(), sweep["approaches"].as_array().unwrap());
    assert!(!contacts.is_empty() && approaches.len() >= contacts.len() && sweep["checks"].as_u64().unwrap() > 100);
}

#[test]
fn trajectories_read_back_as_they_were() {
    let folder = folder("read");
    let trajectory = quintic_move(HOME, GOAL, 1.7);
    fs::write(folder.join("trajectory.csv"), csv(&trajectory)).unwrap();
    assert_eq!(read_trajectory(folder.join("trajectory.csv")).unwrap(), trajectory);
}

#[test]
fn bad_input_gets_one_sentence_that_says_where() {
    let folder = folder("bad");
    let good = csv(&quintic_move(HOME, GOAL, 1.0));
    let lines: Vec<&str> = good.lines().collect();
    let write = |name: &str, text: String| fs::write(folder.join(name), text).unwrap();
    write("good.csv", good.clone());
    write("nan.csv", good.replace("-0.6", "NaN"));
    write("word.csv", good.replace("-0.6", "much"));
    write("empty.csv", String::new());
    write("header.csv", format!("{}\n", lines[0]));
    write("numbers.csv", format!("{}\n", lines[1]));
    write("poses.csv", "x,y,z,qx,qy,qz,qw\n0.4,0.1,0.3,0,0,0,1\n".into());
    write("short.csv", format!("{good}2,0,0\n"));
    write("backwards.csv", format!("{}\n{}\n{}\n", lines[0], lines[2], lines[1]));
    write("velocity.csv", good.replace("elbow_joint.velocity", "elbow_joint.speed"));
    write("elbow.csv", good.replace("elbow_joint", "elbow"));
    write("refused.json", r#"{"refusal": "pose 3 is out of reach"}"#.into());
    write("two.json", r#"{"plan": {"pose_times_s": [0.1, 0.2]}}"#.into());
    write("late.json", r#"{"plan": {"pose_times_s": [7.5]}}"#.into());
    write("half.json", r#"{"plan": {"#.into());

    let said = |name: &str| complaint(&folder, &[name, "--robot", "ur5e"]);
    assert_eq!(said("nan.csv"), "nan.csv, line 3: shoulder_pan_joint.position is not finite: NaN");
    assert_eq!(said("word.csv"), "word.csv, line 3: shoulder_pan_joint.position is not a number: \"much\"");
    assert_eq!(said("empty.csv"), "empty.csv is no joint trajectory: it has no rows");
    assert_eq!(said("header.csv"), "header.csv is no joint trajectory: it has no rows");
    assert!(
        said("numbers.csv").starts_with("numbers.csv is no joint trajectory: the first line has to name the columns")
    );
    assert_eq!(said("poses.csv"), "poses.csv is no joint trajectory: it has no column JOINT.position");
    assert_eq!(said("short.csv"), "short.csv, line 4: 3 fields instead of 19");
    assert!(said("backwards.csv").starts_with("backwards.csv, line 3: t is 0 s, which must"));
    assert!(said("velocity.csv").starts_with("velocity.csv has no column elbow_joint.velocity"));
    assert!(said("elbow.csv").starts_with("the model has no actuated joint elbow; it has"));
    assert!(said("missing.csv").starts_with("missing.csv: "));

    let with = |rest: &str| {
        let arguments = format!("good.csv {rest}");
        complaint(&folder, &arguments.split_whitespace().collect::<Vec<_>>())
    };
    assert!(with("--robot hal9000").starts_with("there is no model named \"hal9000\": known are ur5e"));
    assert!(with("--robot absent.xml").starts_with("absent.xml: "));
    assert!(with("--robot ur5e --settle -1").starts_with("option settle_s is -1"));
    assert_eq!(
        with("--robot ur5e --poses poses.csv --report refused.json"),
        "refused.json is no report of a plan: planning was refused: pose 3 is out of reach"
    );
    assert_eq!(with("--robot ur5e --poses poses.csv --report two.json"), "there are 2 times for 1 poses");
    assert!(
        with("--robot ur5e --poses poses.csv --report late.json").starts_with("pose 0 is due at 7.5 s, but the run")
    );
    assert!(
        with("--robot ur5e --poses poses.csv --report half.json").starts_with("half.json is no report of a plan: ")
    );
    assert_eq!(
        with("--robot ur5e --poses poses.csv --message 3"),
        "poses.csv holds 1 sets of poses (counted from 0): choose one of them with --message"
    );
    assert!(with("--robot ur5e -o run.bag").contains("must end in .mcap"));
    assert!(with("--robot ur5e --picture nowhere/run.svg").starts_with("nowhere/run.svg could not be written: "));
}
