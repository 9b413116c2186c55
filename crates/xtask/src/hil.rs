//! The arm of Dynamixel servos that does not exist: recorded shapes through ROBOTIS's SDK, an emulated bus, and MuJoCo.

use std::fs;
use std::path::PathBuf;
use std::process::Stdio;

use serde_json::Value;

use crate::demo::{read_json, recordings, write_json};
use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;
use crate::setup;

/// What every drawing must show.
const DRAWING_BOUNDS: [(&str, f64); 2] = [("tracking_rms_rad", 0.02), ("pose_error_max_m", 0.005)];
/// Tracking on a bus that damages packets, as a multiple of that on one which does not.
const SOAK_RATIO: f64 = 2.0;
const PRIORITY: &str = "-15";

/// Draws every recorded shape, prints the table and writes `target/hil/summary.json`.
pub(crate) fn run(layout: &Layout) -> Outcome {
    let shapes = shapes(layout)?;
    let summary = command(layout, &["draw"], &shapes)?;
    let runs = summary["runs"].as_array().cloned().unwrap_or_default();
    print_table(&runs);
    let folder = layout.root().join("target/hil");
    fs::create_dir_all(&folder).map_err(Failure::io("create", &folder))?;
    let file = folder.join("summary.json");
    write_json(&file, &summary)?;
    println!("{}", file.display());
    let mut faults: Vec<_> = runs.iter().flat_map(faults).collect();
    if runs.len() != shapes.len() {
        faults.push(format!("{} of {} shapes were drawn", runs.len(), shapes.len()));
    }
    if faults.is_empty() { Ok(()) } else { Err(Failure::step("the hardware in the loop", faults.join("; "))) }
}

/// Draws the shapes for so many minutes on a bus that damages one packet in a hundred.
pub(crate) fn soak(layout: &Layout, minutes: u32) -> Outcome {
    let figures = command(layout, &["soak", "--minutes", &minutes.to_string()], &shapes(layout)?)?;
    println!("{figures:#}");
    let clean = figures["faults"].as_array().is_some_and(Vec::is_empty) && figures["jumps"] == 0;
    match figures["ratio"].as_f64() {
        Some(ratio) if clean && ratio <= SOAK_RATIO => Ok(()),
        ratio => {
            let why = format!(
                "faults {}, jumps {}, tracking {ratio:?} times that of a clean bus, allowed {SOAK_RATIO}",
                figures["faults"], figures["jumps"]
            );
            Err(Failure::step("the soak", why))
        }
    }
}

/// The recordings, without their `.truth.json`.
fn shapes(layout: &Layout) -> Outcome<Vec<PathBuf>> {
    let bag = |truth: PathBuf| -> Outcome<PathBuf> {
        let name = read_json(&truth)?["name"].as_str().unwrap_or_default().to_owned();
        Ok(truth.with_file_name(name))
    };
    recordings(layout)?.into_iter().map(bag).collect()
}

/// Builds the program, runs it on the shapes, and takes what it prints.
fn command(layout: &Layout, arguments: &[&str], shapes: &[PathBuf]) -> Outcome<Value> {
    setup::run(layout)?;
    println!("building the driver and the emulator (the first time takes some minutes) …");
    let built = build_executables(layout, &["build", "--package", "dynamixel-hil"])?;
    let program = built.iter().find(|path| path.file_name().is_some_and(|name| name == "dynamixel-hil"));
    let program =
        program.ok_or_else(|| Failure::step("cargo build", "no executable dynamixel-hil was built".to_owned()))?;
    println!("drawing {} shapes in real time …", shapes.len());
    // A control loop is to go before whatever else the machine does; where that is not permitted, `nice` says so and goes on.
    let mut command = layout.command("nice");
    command.args(["-n", PRIORITY]).arg(program).args(arguments).args(shapes).stderr(Stdio::inherit());
    let output = command.output().map_err(Failure::io("run", program))?;
    if !output.status.success() {
        return Err(Failure::Command { what: "dynamixel-hil".into(), status: output.status });
    }
    serde_json::from_slice(&output.stdout).map_err(|error| Failure::step("dynamixel-hil", error.to_string()))
}

/// What a drawing falls short of, in words.
fn faults(run: &Value) -> Vec<String> {
    let name = run["name"].as_str().unwrap_or("?");
    let over = |(key, bound): (&str, f64)| match run[key].as_f64() {
        Some(value) if value <= bound => None,
        value => Some(format!("{name}: {key} is {value:?}, allowed {bound}")),
    };
    DRAWING_BOUNDS.into_iter().filter_map(over).collect()
}

fn print_table(runs: &[Value]) {
    println!(
        "\n{:<16}{:>6}{:>11}{:>12}{:>12}{:>9}{:>10}{:>8}{:>11}{:>12}{:>9}{:>9}{:>8}",
        "shape",
        "poses",
        "duration/s",
        "rms/mrad",
        "max/mrad",
        "pose/mm",
        "pose/mrad",
        "rate/Hz",
        "jitter/ms",
        "longest/ms",
        "packets",
        "retries",
        "errors"
    );
    for run in runs {
        let number = |key: &str, scale: f64| run[key].as_f64().unwrap_or(f64::NAN) * scale;
        println!(
            "{:<16}{:>6}{:>11.2}{:>12.2}{:>12.2}{:>9.2}{:>10.2}{:>8.1}{:>11.2}{:>12.2}{:>9}{:>9}{:>8}",
            run["name"].as_str().unwrap_or("?"),
            run["n_poses"].to_string(),
            number("duration_s", 1.0),
            number("tracking_rms_rad", 1e3),
            number("tracking_max_rad", 1e3),
            number("pose_error_max_m", 1e3),
            number("pose_error_max_rad", 1e3),
            number("rate_hz", 1.0),
            number("jitter_rms_ms", 1.0),
            number("longest_step_ms", 1.0),
            run["packets"].to_string(),
            run["retries"].to_string(),
            run["errors"].to_string(),
        );
    }
    println!();
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_beyond_a_bound_or_missing_is_a_fault() {
        let run = |rms: f64| json!({ "name": "a", "tracking_rms_rad": rms, "pose_error_max_m": 0.004 });
        assert_eq!(faults(&run(0.01)), Vec::<String>::new());
        assert_eq!(faults(&run(0.03)), ["a: tracking_rms_rad is Some(0.03), allowed 0.02"]);
        assert_eq!(faults(&json!({})).len(), 2);
    }
}
