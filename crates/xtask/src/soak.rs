//! Long runs of tests that CI runs a small sample of.

mod ros;

use std::fs;

use clap::ValueEnum;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::hil;
use crate::wheel;

/// What can be run at length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Soak {
    /// Random pose sets all over the workspace of each arm: planned, or refused for a reason that holds
    Plans,
    /// Random curves that arrive while the arm executes others: so many hand-overs on each arm
    Handovers,
    /// The same pose sets, executed in MuJoCo: so many without a contact on each arm, and their tracking, poses and torques
    Executions,
    /// Random curves, shuffled, planned and judged
    Shuffled,
    /// Random smooth curves, sampled, shuffled and ordered: success by density, wrong orders by verdict
    Orders,
    /// Dense samples of random curves until so many orders are certified: every one must be right
    Certified,
    /// Random coordinates, ordered: the number is how many seconds
    FuzzOrders,
    /// Runs of `reorder replay`, so many, each stopped at a random moment and resumed
    Replay,
    /// Random bytes, read as a table: the number is how many seconds
    FuzzTables,
    /// The same as TUM or KITTI
    FuzzTracks,
    /// Random bytes, decoded as messages of every type
    FuzzMessages,
    /// Random bytes, read as an MCAP file
    FuzzMcap,
    /// Random bytes, read as an SQLite file or as the metadata of a bag
    FuzzBags,
    /// Random bytes and packets on a bus of emulated servos
    FuzzServos,
    /// Random bytes as answers of servos, to the Dynamixel driver: the number is how many seconds
    FuzzDriver,
    /// The node under ten arrays a second, while subscribers come and go: memory, lost answers, latency; the number is how many minutes
    Load,
    /// An emulated ViperX on a bus that damages one packet in a hundred: faults, jumps, tracking; the number is how many minutes
    Hil,
    /// So many bags (else 200) on a Ray cluster of two nodes on this machine, while ten workers are killed: every result is there, none twice
    Fleet,
    /// The node behind a link of 200 ms and 5 % loss each way, steady for so many seconds, then cut twice
    Link,
}

const CASES: u32 = 1000;

pub(crate) fn run(layout: &Layout, name: Soak, amount: Option<u32>) -> Outcome {
    let cases = amount.unwrap_or(CASES);
    match name {
        Soak::Load => ros::load(layout, amount.unwrap_or(10)),
        Soak::Hil => hil::soak(layout, amount.unwrap_or(10)),
        Soak::Fleet => wheel::soak(layout, amount.unwrap_or(200)),
        Soak::Link => ros::link(layout, amount.unwrap_or(60)),
        Soak::Plans => run_test(layout, "planner", "random_plans", cases),
        Soak::Handovers => run_test(layout, "planner", "handover", cases),
        Soak::Executions => run_test(layout, "mujoco-sim", "random_executions", cases),
        Soak::Shuffled => run_test(layout, "planner", "shuffled_plans", cases),
        Soak::Orders => run_test(layout, "reorder", "suite random_orders::", cases),
        Soak::Certified => run_test(layout, "reorder", "suite certified_orders::", cases),
        Soak::FuzzOrders => fuzz(layout, "orders", cases),
        Soak::FuzzTables => fuzz(layout, "tables", cases),
        Soak::Replay => run_test(layout, "reorder-cli", "replay", cases),
        Soak::FuzzTracks => fuzz(layout, "tracks", cases),
        Soak::FuzzMessages => fuzz(layout, "messages", cases),
        Soak::FuzzMcap => fuzz(layout, "mcap", cases),
        Soak::FuzzDriver => run_test(layout, "dynamixel-hil", "garbage", cases),
        Soak::FuzzBags => fuzz(layout, "bags", cases),
        Soak::FuzzServos => fuzz(layout, "servos", cases),
    }
}

/// Runs a test program, or of one what begins with a name after a space.
fn run_test(layout: &Layout, package: &str, test: &str, cases: u32) -> Outcome {
    let mut cargo = layout.cargo();
    let (program, part) = test.split_once(' ').unwrap_or((test, ""));
    cargo.args(["test", "--release", "--package", package, "--test", program, "--", part]);
    cargo.args(["--nocapture", "--test-threads=1"]);
    let status = cargo.env("REORDER_SOAK_CASES", cases.to_string()).status().map_err(Failure::io("run", "cargo"))?;
    if status.success() { Ok(()) } else { Err(Failure::Command { what: format!("soak {test}"), status }) }
}

/// What cargo-fuzz asks of the compiler, without the sanitizers that only a nightly one has: safe Rust has no use for them.
const COVERAGE: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing";

/// libFuzzer for so many seconds. What it learns stays in `target/fuzz/TARGET`, and so does an input that crashed.
fn fuzz(layout: &Layout, target: &str, seconds: u32) -> Outcome {
    let folder = layout.root().join("target/fuzz").join(target);
    fs::create_dir_all(&folder).map_err(Failure::io("create", &folder))?;
    let package = layout.root().join("tests/fuzz");
    let mut cargo = layout.cargo();
    // Build scripts run on this machine and take no counters: flags go to the target only where one is named.
    cargo.args(["run", "--release", "--target", "x86_64-unknown-linux-gnu", "--target-dir"]);
    cargo.arg(layout.root().join("target/fuzz/build")).arg("--manifest-path").arg(package.join("Cargo.toml"));
    cargo.args(["--bin", target, "--", "-max_len=4096", &format!("-max_total_time={seconds}")]);
    cargo.arg(format!("-artifact_prefix={}/crash-", folder.display()));
    cargo.arg(&folder).arg(package.join("seeds").join(target)).env("RUSTFLAGS", COVERAGE);
    let status = cargo.status().map_err(Failure::io("run", "cargo"))?;
    if status.success() { Ok(()) } else { Err(Failure::Command { what: format!("fuzz {target}"), status }) }
}
