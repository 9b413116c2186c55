//! `reorder plan` at the edges: robots that are none, and very many poses.
#![allow(clippy::unwrap_used, missing_docs)]

use std::f64::consts::TAU;
use std::fmt::Write;

mod support;

use support::*;

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/robots/ur5e");

#[test]
fn a_robot_that_is_none_is_refused_with_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let settings = std::fs::read_to_string(format!("{ROBOT}.yaml")).unwrap();
    let urdf = format!("{ROBOT}.urdf");
    let bag = format!("{BAGS}/lasa_sine");
    for (from, to, sentence) in [
        ("tool_frame: tool0", "tool_frame: torch", "the URDF has no link \"torch\""),
        (
            "tool_frame: tool0",
            "tool_frame: base_link",
            "no chain of moving joints leads from \"base_link\" to \"base_link\"",
        ),
        (
            "shoulder_pan_joint: { acceleration_rad_s2: 5.0",
            "shoulder_pan_joint: { acceleration_rad_s2: 0.0",
            "joint \"shoulder_pan_joint\": its acceleration limit is 0, but must be positive",
        ),
        (
            "shoulder_pan_joint: { acceleration_rad_s2: 5.0",
            "shoulder_pan_joint: { acceleration_rad_s2: .nan",
            "joint \"shoulder_pan_joint\": its acceleration limit is NaN, but must be positive",
        ),
    ] {
        let limits = file(&folder, "robot.yaml", &settings.replace(from, to));
        let (code, said) = refusal(&["plan", &bag, "--robot", &urdf, "--limits", &limits]);
        assert_eq!((code, said), (2, format!("reorder: {limits}: {sentence}")));
    }
}

/// A spiral of two turns, nine micrometres from pose to pose, with the tool down.
#[test]
fn a_hundred_thousand_poses_are_planned() {
    const POSES: usize = 100_000;
    let mut table = "x,y,z,qx,qy,qz,qw\n".to_owned();
    for i in 0..POSES {
        // 61803 has no factor in common with the number of poses: every place once.
        let place = (i * 61_803 % POSES) as f64 / POSES as f64;
        let (s, half) = ((0.01 + 0.99 * place).sqrt(), std::f64::consts::FRAC_1_SQRT_2);
        let (sin, cos) = (2.0 * TAU * s).sin_cos();
        writeln!(table, "{},{},0.388,{half},{half},0,0", 0.133 + 0.15 * s * cos, -0.492 + 0.15 * s * sin).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let input = file(&folder, "spiral.csv", &table);
    let report = folder.path().join("report.json").display().to_string();
    let csv = out(&reorder(&["plan", &input, "--robot", "ur5e", "--report", &report]));
    let found: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(report).unwrap()).unwrap();
    assert_eq!((&found["n"], &found["plan"]["audit"]["limits_ok"]), (&POSES.into(), &true.into()));
    assert_eq!(found["plan"]["pose_times_s"].as_array().unwrap().len(), POSES);
    assert_eq!(csv.lines().count() as u64, 1 + found["plan"]["points"].as_u64().unwrap());
}
