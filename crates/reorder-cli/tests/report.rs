//! `reorder report` as users call it. The library that draws is stood in for by a file that has its marks: what it does is for a
//! browser to say, in the tests that have one.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const BAGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data");

fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("three.cjs"), "// Three.js Authors\nexports.WebGLRenderer = class {};\n").unwrap();
    folder
}

fn report(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_reorder"));
    command.current_dir(folder).arg("report").args(arguments);
    command.args(["-o", "page.html", "--drawing-library", "three.cjs"]).output().unwrap()
}

/// The JSON object of the page that is written.
fn data(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let output = report(folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = fs::read_to_string(folder.join("page.html")).unwrap();
    let (_, rest) = page.split_once(r#"id="data">"#).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// The one sentence of a command that fails and writes nothing.
fn complaint(folder: &Path, arguments: &[&str]) -> String {
    let output = report(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    assert!(!folder.join("page.html").exists());
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.trim_end().lines().count(), 1, "more than a sentence: {text}");
    text
}

#[test]
fn a_recording_with_a_robot_gets_order_plan_and_arm() {
    let folder = folder("plan");
    let bag = format!("{BAGS}/lasa_gshape");
    let page = data(&folder, &[&bag, "--robot", "ur5e"]);
    assert_eq!((&page["name"], &page["arm"]["name"]), (&"lasa_gshape".into(), &"ur5e".into()));
    assert_eq!(page["plan"]["motion"]["joints"].as_array().unwrap().len(), 6);
    assert_eq!(page["refusal"], serde_json::Value::Null);
    let first = fs::read(folder.join("page.html")).unwrap();
    data(&folder, &[&bag, "--robot", "ur5e"]);
    assert!(first == fs::read(folder.join("page.html")).unwrap(), "the same input gave another page");
}

#[test]
fn points_of_every_space_are_shown_in_order() {
    let folder = folder("spaces");
    let rows = |row: fn(f64) -> String| (0..20).map(|k| row(0.05 * f64::from((7 * k) % 20)) + "\n").collect::<String>();
    let spaces: [(&str, String); 7] = [
        ("x,y", rows(|t| format!("{t},{}", t * t))),
        ("x,y,z", rows(|t| format!("{t},{},0.1", t * t))),
        ("lat,lon", rows(|t| format!("{},{}", 40.0 * t, 80.0 * t))),
        ("qx,qy,qz,qw", rows(|t| format!("0,0,{},{}", t.sin(), t.cos()))),
        ("x,y,theta", rows(|t| format!("{t},{},{t}", t * t))),
        ("x,y,theta,scale", rows(|t| format!("{t},{},{t},{}", t * t, 1.0 + t))),
        ("x,y,z,qx,qy,qz,qw", rows(|t| format!("{t},{},0.1,0,0,{},{}", t * t, t.sin(), t.cos()))),
    ];
    for (columns, text) in spaces {
        fs::write(folder.join("points.csv"), format!("{columns}\n{text}")).unwrap();
        let page = data(&folder, &["points.csv"]);
        assert_eq!(page["shape"], "20 points on an open curve", "{columns}");
        assert_eq!(page["spline"].is_object(), columns.len() > 16, "{columns}");
    }
}

#[test]
fn a_refused_plan_is_on_the_page_and_in_a_warning() {
    let folder = folder("refused");
    let far = (0..20).map(|k| format!("{},9,0,0,0,0,1\n", 0.05 * f64::from((7 * k) % 20))).collect::<String>();
    fs::write(folder.join("far.csv"), format!("x,y,z,qx,qy,qz,qw\n{far}")).unwrap();
    let arguments = ["far.csv", "--robot", "ur5e", "--minimum-verdict", "ambiguous"];
    let page = data(&folder, &arguments);
    let refusal = page["refusal"].as_str().unwrap();
    assert!(page["plan"].is_null() && page["spline"].is_object());
    let warning = String::from_utf8(report(&folder, &arguments).stderr).unwrap();
    assert!(warning.contains(refusal) && warning.starts_with("reorder: warning: far.csv: "), "{warning}");
}

#[test]
fn what_is_wrong_is_said_in_a_sentence_and_nothing_is_written() {
    let folder = folder("wrong");
    let bag = format!("{BAGS}/lasa_gshape");
    fs::write(folder.join("other.json"), "{}").unwrap();
    let sentence = complaint(&folder, &[&bag, "--robot", "ur5e", "--simulation", "other.json"]);
    assert!(sentence.contains("other.json") && sentence.contains("duration_s"), "{sentence}");
    let sentence = complaint(&folder, &["missing.csv"]);
    assert!(sentence.contains("missing.csv"), "{sentence}");
    let sentence = complaint(&folder, &[&bag, "--robot", "ur5e", "--metres-per-radian", "auto"]);
    assert!(sentence.contains("--metres-per-radian"), "{sentence}");
    fs::write(folder.join("three.cjs"), "module.exports = require('./three.module.js')").unwrap();
    let sentence = complaint(&folder, &[&bag]);
    assert!(sentence.contains("three.cjs") && sentence.contains("three.js"), "{sentence}");
}
