//! The main job for real: recorded, shuffled poses through rclpy, the node, rclpy again and MuJoCo.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde_json::{Value, json};

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::{Running, build_executables};
use crate::setup;

const PEER_TIMEOUT_S: &str = "60";

/// What every run of the demo must show.
const BOUNDS: [(&str, f64); 7] = [
    ("/max_ratio/velocity", 1.0),
    ("/max_ratio/acceleration", 1.0),
    ("/max_ratio/jerk", 1.0),
    ("/tracking_max_rad", 0.01),
    ("/pose_error_max_m", 0.002),
    ("/pose_error_max_rad", 0.02),
    ("/contacts", 0.0),
];

/// Runs every recorded shape and writes `target/demo`.
pub(crate) fn run(layout: &Layout) -> Outcome {
    setup::run(layout)?;
    let binaries = build(layout)?;
    let out = layout.root().join("target/demo");
    fs::create_dir_all(&out).map_err(Failure::io("create", &out))?;
    let mut runs = Vec::new();
    for truth in recordings(layout)? {
        runs.push(run_shape(layout, &binaries, &truth, &out)?);
    }
    print_table(&runs);
    let faults: Vec<_> = runs.iter().flat_map(faults).collect();
    write_json(&out.join("summary.json"), &json!({ "runs": runs }))?;
    println!("{}", out.join("summary.json").display());
    if faults.is_empty() { Ok(()) } else { Err(Failure::step("the demo", faults.join("; "))) }
}

struct Binaries {
    node: PathBuf,
    simulate: PathBuf,
}

fn build(layout: &Layout) -> Outcome<Binaries> {
    println!("building the node and the simulation (the first time takes some minutes) …");
    let executables = build_executables(layout, &["build", "--package", "reorder-node", "--package", "mujoco-sim"])?;
    let find = |name: &str| {
        let found = executables.iter().find(|path| path.file_name().is_some_and(|file| file == name));
        found.cloned().ok_or_else(|| Failure::step("cargo build", format!("no executable {name} was built")))
    };
    Ok(Binaries { node: find("reorder_node")?, simulate: find("reorder-simulate")? })
}

/// The `*.truth.json` beside every recorded bag, by name.
pub(crate) fn recordings(layout: &Layout) -> Outcome<Vec<PathBuf>> {
    let folder = layout.root().join("tests/data");
    let entries = fs::read_dir(&folder).map_err(Failure::io("read", &folder))?;
    let mut truths: Vec<_> = entries
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| path.to_string_lossy().ends_with(".truth.json"))
        .collect();
    truths.sort();
    if truths.is_empty() {
        Err(Failure::step("the demo", format!("no recording in {}", folder.display())))
    } else {
        Ok(truths)
    }
}

fn run_shape(layout: &Layout, binaries: &Binaries, truth_file: &Path, out: &Path) -> Outcome<Value> {
    let truth = read_json(truth_file)?;
    let name = text(&truth, "name", truth_file)?;
    let robot = text(&truth, "robot", truth_file)?;
    let bag = truth_file.with_file_name(&name);
    let folder = out.join(&name);
    crate::setup::replace_folder(&folder, |_| Ok(()))?;
    println!("{name} …");

    exchange(layout, binaries, &robot, &bag, &folder)?;
    let report = read_json(&folder.join("report.json"))?;
    let check = read_json(&folder.join("check.json"))?;
    write_trajectory_csv(&read_json(&folder.join("trajectory.json"))?, &folder.join("trajectory.csv"))?;
    let simulated = simulate(layout, binaries, &robot, &bag, &folder)?;

    let (order_exact, adjacency) = compare_orders(&truth["order"], &report["order"]);
    let ratio = |kind: &str| {
        let pointer = format!("/max_ratio/{kind}");
        let ours = report["plan"]["audit"].pointer(&pointer).and_then(Value::as_f64).unwrap_or(f64::INFINITY);
        let theirs = check.pointer(&pointer).and_then(Value::as_f64).unwrap_or(f64::INFINITY);
        ours.max(theirs)
    };
    let run = json!({
        "name": name,
        "robot": robot,
        "n_poses": report["n"],
        "order_exact": order_exact,
        "adjacency": adjacency,
        "verdict": report["verdict"],
        "duration_s": report["plan"]["duration_s"],
        "limits_ok": report["plan"]["audit"]["limits_ok"] == json!(true) && check["ok"] == json!(true),
        "max_ratio": { "velocity": ratio("velocity"), "acceleration": ratio("acceleration"), "jerk": ratio("jerk") },
        "tracking_rms_rad": simulated["tracking_rms_rad"],
        "tracking_max_rad": simulated["tracking_max_rad"],
        "pose_error_max_m": simulated["pose_error_max_m"],
        "pose_error_max_rad": simulated["pose_error_max_rad"],
        "contacts": simulated["contacts"],
    });
    Ok(run)
}

/// Node, receiver and publisher as three processes in a ROS domain of their own.
fn exchange(layout: &Layout, binaries: &Binaries, robot: &str, bag: &Path, folder: &Path) -> Outcome {
    // 1 … 100 are free for users on every platform; the tests have theirs above 60.
    let domain = (1 + std::process::id() % 60).to_string();
    let ros = |program: &Path| {
        let mut command = layout.command(program);
        command.env("ROS_DOMAIN_ID", &domain).stdin(Stdio::null());
        command
    };
    let peer = |script: &str| {
        let mut command = ros(&layout.ros_python());
        command.arg(layout.root().join("tests/peers").join(script));
        command
    };
    let mut node = ros(&binaries.node);
    node.args(["--ros-args", "--params-file", "config/reorder.yaml"]);
    let node = Running::start("reorder_node", &mut node)?;

    let mut receiver = peer("receive_trajectory.py");
    receiver.args([
        "--limits",
        &format!("config/robots/{robot}.yaml"),
        "--urdf",
        &format!("config/robots/{robot}.urdf"),
    ]);
    receiver.args(["--timeout", PEER_TIMEOUT_S]).arg("--bag").arg(bag).arg("--out").arg(folder);
    let mut receiver = Running::start("receive_trajectory.py", receiver.stdout(Stdio::piped()))?;
    receiver.wait_for_line("MATCHED")?;

    let mut publisher = peer("publish_bag.py");
    publisher.arg(bag).args(["--joint-state", "home", "--timeout", PEER_TIMEOUT_S]).stdout(Stdio::null());
    Running::start("publish_bag.py", &mut publisher)?.finish()?;
    receiver.finish()?;
    node.interrupt()
}

fn simulate(layout: &Layout, binaries: &Binaries, robot: &str, bag: &Path, folder: &Path) -> Outcome<Value> {
    let mut command = layout.command(&binaries.simulate);
    command.arg(folder.join("trajectory.csv")).args(["--robot", robot]);
    command.arg("--poses").arg(bag).arg("--report").arg(folder.join("report.json"));
    command
        .args(["--format", "json"])
        .arg("-o")
        .arg(folder.join("execution.mcap"))
        .arg("--picture")
        .arg(folder.join("execution.svg"));
    let output = command.stderr(Stdio::inherit()).output().map_err(Failure::io("run", &binaries.simulate))?;
    if !output.status.success() {
        return Err(Failure::Command { what: "reorder-simulate".into(), status: output.status });
    }
    serde_json::from_slice(&output.stdout).map_err(|error| Failure::step("reorder-simulate", error.to_string()))
}

/// The trajectory as it was received, in the form of `reorder plan`.
fn write_trajectory_csv(trajectory: &Value, file: &Path) -> Outcome {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let names: Vec<_> = list(&trajectory["names"]).iter().filter_map(|n| n.as_str().map(str::to_owned)).collect();
    let mut header = vec!["t".to_owned()];
    for kind in ["position", "velocity", "acceleration"] {
        header.extend(names.iter().map(|name| format!("{name}.{kind}")));
    }
    let mut csv = header.join(",") + "\n";
    for (row, time) in list(&trajectory["times"]).iter().enumerate() {
        let values = ["q", "v", "a"].iter().flat_map(|key| list(&trajectory[*key][row]));
        let fields: Vec<_> = std::iter::once(time.clone()).chain(values).map(|v| v.to_string()).collect();
        csv += &(fields.join(",") + "\n");
    }
    fs::write(file, csv).map_err(Failure::io("write", file))
}

/// Whether two orders are the same up to direction (nothing in unordered poses says which end came first), and the share of
/// true neighbours that are neighbours in the recovered order.
fn compare_orders(truth: &Value, recovered: &Value) -> (bool, f64) {
    let list = |value: &Value| -> Vec<u64> {
        value.as_array().map(|a| a.iter().filter_map(Value::as_u64).collect()).unwrap_or_default()
    };
    let (truth, recovered) = (list(truth), list(recovered));
    let mut backward = recovered.clone();
    backward.reverse();
    let exact = !truth.is_empty() && (truth == recovered || truth == backward);
    let pairs = |order: &[u64]| -> std::collections::BTreeSet<(u64, u64)> {
        order.windows(2).map(|p| (p[0].min(p[1]), p[0].max(p[1]))).collect()
    };
    let (true_pairs, found) = (pairs(&truth), pairs(&recovered));
    let adjacency = true_pairs.intersection(&found).count() as f64 / true_pairs.len().max(1) as f64;
    (exact, adjacency)
}

/// What a run falls short of, in words.
fn faults(run: &Value) -> Vec<String> {
    let name = run["name"].as_str().unwrap_or("?");
    let mut faults = Vec::new();
    for key in ["order_exact", "limits_ok"] {
        if run[key] != json!(true) {
            faults.push(format!("{name}: {key} is {}", run[key]));
        }
    }
    for (pointer, bound) in BOUNDS {
        match run.pointer(pointer).and_then(Value::as_f64) {
            Some(value) if value <= bound => {}
            value => faults.push(format!("{name}: {} is {value:?}, allowed {bound}", &pointer[1..])),
        }
    }
    faults
}

fn print_table(runs: &[Value]) {
    println!(
        "\n{:<16}{:>6}{:>7}{:>11}{:>11}{:>7}{:>7}{:>7}{:>12}{:>11}{:>12}{:>10}",
        "shape",
        "poses",
        "exact",
        "verdict",
        "duration/s",
        "v/lim",
        "a/lim",
        "j/lim",
        "track/µrad",
        "pose/µm",
        "pose/µrad",
        "contacts"
    );
    for run in runs {
        let number =
            |pointer: &str, scale: f64| run.pointer(pointer).and_then(Value::as_f64).unwrap_or(f64::NAN) * scale;
        println!(
            "{:<16}{:>6}{:>7}{:>11}{:>11.2}{:>7.3}{:>7.3}{:>7.3}{:>12.2}{:>11.3}{:>12.2}{:>10}",
            run["name"].as_str().unwrap_or("?"),
            run["n_poses"].to_string(),
            if run["order_exact"] == json!(true) { "yes" } else { "NO" },
            run["verdict"].as_str().unwrap_or("?"),
            number("/duration_s", 1.0),
            number("/max_ratio/velocity", 1.0),
            number("/max_ratio/acceleration", 1.0),
            number("/max_ratio/jerk", 1.0),
            number("/tracking_max_rad", 1e6),
            number("/pose_error_max_m", 1e6),
            number("/pose_error_max_rad", 1e6),
            run["contacts"].to_string(),
        );
    }
    println!();
}

fn text(value: &Value, key: &str, file: &Path) -> Outcome<String> {
    let missing = || Failure::step("the demo", format!("{} has no {key}", file.display()));
    value[key].as_str().map(str::to_owned).ok_or_else(missing)
}

pub(crate) fn read_json(path: &Path) -> Outcome<Value> {
    let text = fs::read_to_string(path).map_err(Failure::io("read", path))?;
    serde_json::from_str(&text).map_err(|error| Failure::step("the demo", format!("{}: {error}", path.display())))
}

pub(crate) fn write_json(path: &Path, value: &Value) -> Outcome {
    fs::write(path, format!("{value:#}\n")).map_err(Failure::io("write", path))
}
