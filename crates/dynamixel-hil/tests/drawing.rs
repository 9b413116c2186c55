//! The program, as `cargo xtask hil` runs it, by simulated time: a recorded shape from poses to MuJoCo.
#![allow(clippy::unwrap_used, missing_docs)]

use std::process::{Command, Output};

use serde_json::Value;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_dynamixel-hil")).args(arguments).current_dir(ROOT).output().unwrap()
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_recorded_shape_is_drawn_within_bounds() {
    let summary = json(&run(&["draw", "--bus-time", "tests/data/lasa_angle"]));
    let run = &summary["runs"][0];
    println!("{run:#}");
    let number = |key: &str| run[key].as_f64().unwrap();
    // Half of what `cargo xtask hil` allows on a busy machine: no step is late here but where the machine stalls the SDK.
    assert!(number("tracking_rms_rad") < 0.01 && number("pose_error_max_m") < 0.005, "{run}");
    assert!(number("fastest_rad_s") < 2.2 && number("rate_hz") > 210.0, "{run}");
    assert!(number("duration_s") > 3.0 && number("fastest_rad_s") > 0.5 && run["verdict"] == "certified", "{run}");
}

#[test]
fn the_check_lists_every_servo_and_moves_none() {
    let checked = json(&run(&["check"]));
    let servos = checked["servos"].as_array().unwrap();
    assert_eq!(servos.len(), 9);
    assert_eq!(servos[3]["name"], "elbow");
    assert!(servos.iter().all(|servo| servo["torque"] == false && servo["errors"].is_null()), "{checked}");
    assert_eq!(json(&run(&["release"]))["released"].as_array().unwrap().len(), 9);
}

#[test]
fn what_is_wrong_is_one_sentence() {
    for (arguments, words) in [
        (&["--port", "/dev/ttyNOWHERE", "check"][..], "port /dev/ttyNOWHERE cannot be opened"),
        (&["--config", "nowhere.yaml", "check"], "nowhere.yaml: "),
        (&["draw", "nowhere"], "nowhere"),
        (&["--port", "/dev/ttyNOWHERE", "draw", "tests/data/lasa_angle"], "set port to sim"),
    ] {
        let output = run(arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.lines().count() == 1 && said.contains(words), "{said}");
    }
}
