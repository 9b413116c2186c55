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
        assert_eq!((code, said), (2, format!("reorder: {urdf} with {limits}: {sentence}")));
    }
    // What one file alone is guilty of is told of that one.
    let description = std::fs::read_to_string(&urdf).unwrap();
    let limits = file(&folder, "robot.yaml", &settings);
    let twice = description.replace("<link name=\"wrist_2_link\"", "<link name=\"wrist_1_link\"");
    for (urdf, sentence) in [("", "the URDF cannot be read: "), (&twice, "two links are named \"wrist_1_link\"")] {
        let urdf = file(&folder, "arm.urdf", urdf);
        let (code, said) = refusal(&["plan", &bag, "--robot", &urdf, "--limits", &limits]);
        assert!(code == 2 && said.starts_with(&format!("reorder: {urdf}: ")) && said.contains(sentence), "{said}");
    }
    let limits = file(&folder, "none.yaml", "base_frame: [");
    let (code, said) = refusal(&["plan", &bag, "--robot", &urdf, "--limits", &limits]);
    assert!(code == 2 && said.starts_with(&format!("reorder: {limits}: the robot settings")), "{said}");
}

#[test]
fn an_arm_of_five_joints_is_refused_for_that() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = std::fs::read_to_string(format!("{ROBOT}.urdf")).unwrap();
    let start = urdf.find("<joint name=\"wrist_3_joint\"").unwrap();
    let joint = &urdf[start..start + urdf[start..].find("</joint>").unwrap()];
    let urdf = file(&folder, "arm.urdf", &urdf.replace(joint, &joint.replace("\"revolute\"", "\"fixed\"")));
    let settings = std::fs::read_to_string(format!("{ROBOT}.yaml")).unwrap();
    let settings: Vec<_> = settings.lines().filter(|line| !line.contains("wrist_3_joint")).collect();
    let limits = file(&folder, "arm.yaml", &settings.join("\n"));
    let (code, said) = refusal(&["plan", &format!("{BAGS}/lasa_sine"), "--robot", &urdf, "--limits", &limits]);
    assert!(
        code == 1 && said.ends_with("the arm has 5 moving joints, and following a curve of poses takes six"),
        "{said}"
    );
}

/// Results never take the place of what they are made from, nor of each other, and appear together.
#[test]
fn outputs_spare_inputs_and_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let bag = format!("{BAGS}/lasa_sine");
    let table = out(&reorder(&["order", &bag, "--format", "csv"]));
    let poses = file(&folder, "poses.csv", &table);
    let old = file(&folder, "old.csv", "old\n");
    let new = folder.path().join("new.csv").display().to_string();
    let elsewhere = format!("{}/../{}/new.csv", folder.path().display(), folder.path().file_name().unwrap().display());
    let plan = ["plan", &poses, "--robot", "ur5e"];
    let twice = "already an input or another output of this command";
    for (outputs, sentence) in [
        (["-o", &poses, "--report", &new], twice),
        (["-o", &new, "--report", &poses], twice),
        (["-o", &new, "--report", &elsewhere], twice),
        (["-o", &old, "--report", "/no/such/folder/report.json"], "No such file or directory"),
        (["-o", &old, "--report", folder.path().to_str().unwrap()], "is a directory"),
    ] {
        let (code, said) = refusal(&[&plan[..], &outputs].concat());
        assert!(code == 2 && said.contains(sentence), "{outputs:?}: {said}");
        assert_eq!(std::fs::read_to_string(&old).unwrap(), "old\n");
        assert_eq!(std::fs::read_to_string(&poses).unwrap(), table);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "nothing half-written stays");
    }
}

#[test]
fn a_joint_name_with_a_comma_heads_no_csv() {
    let folder = tempfile::tempdir().unwrap();
    let named = |kind: &str| {
        let text = std::fs::read_to_string(format!("{ROBOT}.{kind}")).unwrap();
        let name = if kind == "yaml" { "\"elbow,left\"" } else { "elbow,left" };
        file(&folder, &format!("arm.{kind}"), &text.replace("elbow_joint", name))
    };
    let (urdf, limits) = (named("urdf"), named("yaml"));
    let plan = ["plan", &format!("{BAGS}/lasa_sine"), "--robot", &urdf, "--limits", &limits];
    let (code, said) = refusal(&plan);
    assert!(code == 2 && said.contains("\"elbow,left\" cannot head a column of a CSV file"), "{said}");
    let bag = folder.path().join("plan.mcap").display().to_string();
    out(&reorder(&[&plan[..], &["-o", &bag]].concat()));
}

/// A constant speed has no option of its own; the file that has it is the node's, less what only a node has.
#[test]
fn a_plan_is_configured_by_a_file_that_options_precede() {
    let folder = tempfile::tempdir().unwrap();
    let config = file(&folder, "plan.yaml", "timing: {constant_tool_speed_m_s: 0.03, rate_hz: 50.0}\n");
    let bag = format!("{BAGS}/lasa_sine");
    let rows = |more: &[&str]| {
        let arguments = [&["plan", &bag, "--robot", "ur5e", "--config", &config], more].concat();
        let table = out(&reorder(&arguments));
        table.lines().skip(1).map(|row| row.split(',').next().unwrap().parse::<f64>().unwrap()).collect::<Vec<f64>>()
    };
    let free = out(&reorder(&["plan", &bag, "--robot", "ur5e"])).lines().count();
    let (slow, fine) = (rows(&[]), rows(&["--rate", "200"]));
    // 50 and 200 points a second, the last point at the end.
    assert!((slow[1] - 0.02).abs() < 1e-9 && (fine[1] - 0.005).abs() < 1e-9);
    assert!((slow[slow.len() - 1] - fine[fine.len() - 1]).abs() < 0.1);
    assert!(slow[slow.len() - 1] > 2.0 * free as f64 / 100.0, "the speed is not kept low");
    let wrong = file(&folder, "wrong.yaml", "timing: {tool_speed: 1.0}\n");
    let (code, said) = refusal(&["plan", &bag, "--robot", "ur5e", "--config", &wrong]);
    assert!(code == 2 && said.contains("wrong.yaml") && said.contains("tool_speed"), "{said}");
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
