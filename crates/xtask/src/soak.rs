//! Long runs of tests that CI runs a small sample of.

use clap::ValueEnum;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};

/// What can be run at length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Soak {
    /// Random curves, shuffled, planned and judged
    Plans,
    /// Random smooth curves, sampled, shuffled and ordered: success by density, wrong orders by verdict
    Orders,
}

pub(crate) fn run(layout: &Layout, name: Soak, cases: u32) -> Outcome {
    let (package, test) = match name {
        Soak::Plans => ("planner", "random_plans"),
        Soak::Orders => ("reorder", "random_orders"),
    };
    let mut cargo = layout.cargo();
    cargo.args(["test", "--release", "--package", package, "--test", test, "--", "--nocapture", "--test-threads=1"]);
    let status = cargo.env("REORDER_SOAK_CASES", cases.to_string()).status().map_err(Failure::io("run", "cargo"))?;
    if status.success() { Ok(()) } else { Err(Failure::Command { what: format!("soak {test}"), status }) }
}
