//! Lints and tests over the whole workspace.

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::setup;
use std::process::Command;

pub(crate) fn lint(layout: &Layout) -> Outcome {
    setup::run(layout)?;
    run(layout.cargo().args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    run(layout.cargo().args(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}

pub(crate) fn test(layout: &Layout) -> Outcome {
    setup::run_for_tests(layout)?;
    // Examples are linted, and tests call what they do.
    let tested = ["--workspace", "--lib", "--bins", "--tests"];
    let runner: &[&str] = if has_nextest(layout) { &["nextest", "run"] } else { &["test"] };
    run(layout.cargo().args(runner).args(tested))?;
    run(layout.cargo().args(["test", "--workspace", "--doc"]))
}

fn has_nextest(layout: &Layout) -> bool {
    layout.cargo().args(["nextest", "--version"]).output().is_ok_and(|run| run.status.success())
}

fn run(command: &mut Command) -> Outcome {
    let arguments: Vec<_> = command.get_args().map(|argument| argument.to_string_lossy()).collect();
    let what = format!("cargo {}", arguments.join(" "));
    let status = command.status().map_err(Failure::io("run", "cargo"))?;
    if status.success() { Ok(()) } else { Err(Failure::Command { what, status }) }
}
