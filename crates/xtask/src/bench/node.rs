//! `reorder-node`: what the way through ROS 2 adds to planning, from one Python process to the node and back.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::bench::figure::{Bound, Figure, Peer};
use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::install;
use crate::process::Running;
use crate::setup;

/// What the middleware, two conversions and Python may take.
const OVERHEAD_MS: f64 = 3.0;

pub(crate) fn measure(layout: &Layout) -> Outcome<Vec<Figure>> {
    setup::run(layout)?;
    let executables = install::build(layout)?;
    let mut figures = Vec::new();
    for (limits, names) in LIMITS {
        let Medians { whole_ms, planning_ms, rclpy_ms } = run(layout, &executables, limits)?;
        figures.extend(names.into_iter().zip([whole_ms, whole_ms - rclpy_ms]).map(|(name, ours)| Figure {
            name,
            unit: "ms",
            ours,
            peer: Some(Peer { name: "planning alone", value: planning_ms }),
            bound: Bound::Ours(planning_ms + OVERHEAD_MS),
        }));
    }
    Ok(figures)
}

/// What is planned under, and what the whole way is called, with all of it and without what the Python peer itself takes to turn poses
/// into bytes and bytes into a trajectory (13 us a point).
const LIMITS: [(&str, [&str; 2]); 2] = [
    ("jerk", ["PoseArray(200) to JointTrajectory, p50", "the same less rclpy's own conversions"]),
    ("acceleration", ["without jerk limits, p50", "the same less rclpy's own conversions"]),
];

struct Medians {
    whole_ms: f64,
    planning_ms: f64,
    rclpy_ms: f64,
}

fn run(layout: &Layout, executables: &[PathBuf], limits: &str) -> Outcome<Medians> {
    // 1 … 100 are free for users on every platform; the tests have theirs above 60.
    let domain = (1 + std::process::id() % 60).to_string();
    let in_domain = |mut command: Command| {
        command.env("ROS_DOMAIN_ID", &domain).stdin(Stdio::null());
        command
    };
    let node = executables.first().ok_or_else(|| Failure::step("cargo build", "no node was built".to_owned()))?;
    let mut node = in_domain(layout.command(node));
    node.args(["--ros-args", "-p", &format!("timing.limits:={limits}"), "--log-level", "warn"]);
    let node = Running::start("reorder_node", &mut node)?;
    let mut peer = in_domain(layout.command(layout.ros_python()));
    let output = peer.args(["tests/peers/measure_node.py", "tests/data/lasa_sine"]).stderr(Stdio::inherit()).output();
    let output = output.map_err(Failure::io("run", "measure_node.py"))?;
    node.interrupt()?;
    let figures: Value =
        serde_json::from_slice(&output.stdout).map_err(|error| Failure::step("measure_node.py", error.to_string()))?;
    let figure = |name: &str| {
        let missing = || Failure::step("measure_node.py", format!("it did not print {name}"));
        figures[name].as_f64().ok_or_else(missing)
    };
    Ok(Medians {
        whole_ms: figure("p50 ms")?,
        planning_ms: figure("planning p50 ms")?,
        rclpy_ms: figure("rclpy p50 ms")?,
    })
}
