//! The node at length: under load, and behind a long link.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::install;
use crate::process::Running;
use crate::setup;

/// What memory may grow by after the warm-up, in MiB.
const GROWTH_MIB: f64 = 5.0;
/// Without jerk limits 200 poses are planned in a tenth of a second; with them newer ones would replace most before they are.
const QUICK: [&str; 2] = ["-p", "timing.limits:=acceleration"];
/// Long enough for every buffer to have had its largest content.
const WARM_UP_S: u32 = 60;
/// How long the link is cut: within the lease of a DDS participant (20 s), and beyond.
const CUTS_S: [&str; 2] = ["8", "25"];

/// So many minutes of ten arrays a second.
pub(crate) fn load(layout: &Layout, minutes: u32) -> Outcome {
    let node = node(layout)?;
    // 1 … 100 are free for users on every platform; the tests have theirs above 60.
    let domain = (1 + std::process::id() % 60).to_string();
    let in_domain = |program: &Path| {
        let mut command = layout.command(program);
        command.env("ROS_DOMAIN_ID", &domain).stdin(Stdio::null());
        command
    };
    let node =
        Running::start("reorder_node", in_domain(&node).args(["--ros-args", "--log-level", "error"]).args(QUICK))?;
    let mut peer = in_domain(&layout.ros_python());
    peer.args(["tests/peers/load_node.py", "tests/data/lasa_sine", "--pid", &node.id().to_string()]);
    peer.args(["--seconds", &(60 * minutes).to_string(), "--warm-up", &WARM_UP_S.to_string()]);
    println!("{minutes} min of ten arrays a second, after {WARM_UP_S} s to warm up …");
    let figures = printed("load_node.py", &mut peer)?;
    node.interrupt()?;
    let [warm, end] = ["memory_mib_warm", "memory_mib_end"].map(|name| figures[name].as_f64().unwrap_or(f64::NAN));
    println!("memory grew by {:.1} MiB (at most {GROWTH_MIB})", end - warm);
    if end - warm <= GROWTH_MIB {
        Ok(())
    } else {
        Err(Failure::step("soak load", format!("memory grew from {warm} to {end} MiB")))
    }
}

/// So many seconds of a steady link, and then cuts; with the shipped profile, and, without cuts, with the defaults of Fast DDS.
pub(crate) fn link(layout: &Layout, seconds: u32) -> Outcome {
    let unshare = namespace().ok_or_else(|| {
        let why = "this needs network namespaces: root, or a kernel that gives them to users (unshare --user --net), and iproute2";
        Failure::step("soak link", why.to_owned())
    })?;
    let node = node(layout)?;
    let run = |profile: &str, cuts: &[&str]| {
        let mut hosts = layout.command(unshare[0]);
        hosts.args(&unshare[1..]).arg(layout.ros_python()).arg("tests/peers/two_hosts.py").arg(&node);
        hosts.args(["tests/data/lasa_sine", "--profile", profile, "--seconds", &seconds.to_string(), "--cuts"]);
        hosts.args(cuts).stdin(Stdio::null());
        println!("\n200 ms there and back, 5 % loss each way, profile {profile}, cut for {cuts:?} s …");
        printed("two_hosts.py", &mut hosts)
    };
    run("config/dds/wan.xml", &CUTS_S)?;
    run("none", &[]).map(drop)
}

fn node(layout: &Layout) -> Outcome<PathBuf> {
    setup::run(layout)?;
    let executables = install::build(layout)?;
    executables.into_iter().next().ok_or_else(|| Failure::step("cargo build", "no node was built".to_owned()))
}

/// The words that give a command a network of its own, where that is allowed.
fn namespace() -> Option<&'static [&'static str]> {
    const WAYS: [&[&str]; 2] = [&["unshare", "--net"], &["unshare", "--user", "--map-root-user", "--net"]];
    let works = |way: &&&[&str]| {
        let mut command = Command::new(way[0]);
        command.args(&way[1..]).args(["ip", "link", "set", "lo", "up"]).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    WAYS.iter().find(works).copied()
}

/// Runs a peer, and prints the figures of the JSON object that it prints; they are there where it fails, too.
fn printed(name: &'static str, peer: &mut Command) -> Outcome<Value> {
    let output = peer.stderr(Stdio::inherit()).output().map_err(Failure::io("run", name))?;
    let figures: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    for (name, value) in figures.as_object().into_iter().flatten() {
        println!("{:<28}{value}", name.replace('_', " "));
    }
    if output.status.success() {
        Ok(figures)
    } else {
        Err(Failure::Command { what: name.to_owned(), status: output.status })
    }
}
