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
    let (jerk, plain) = (run(layout, &executables, "jerk")?, run(layout, &executables, "acceleration")?);
    Ok([("PoseArray(200) to JointTrajectory, p50", jerk), ("the same without jerk limits, p50", plain)]
        .map(|(name, (p50_ms, planning_ms))| Figure {
            name,
            unit: "ms",
            ours: p50_ms,
            peer: Some(Peer { name: "planning alone", value: planning_ms }),
            bound: Bound::Ours(planning_ms + OVERHEAD_MS),
        })
        .into())
}

/// The median of the whole way, and of planning alone, in ms.
fn run(layout: &Layout, executables: &[PathBuf], limits: &str) -> Outcome<(f64, f64)> {
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
    Ok((figure("p50 ms")?, figure("planning p50 ms")?))
}
