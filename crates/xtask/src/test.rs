//! Lints and tests over the whole workspace.

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;
use crate::{setup, wheel};
use std::process::Command;

pub(crate) fn lint(layout: &Layout) -> Outcome {
    setup::run(layout)?;
    run(layout.cargo().args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    run(layout.cargo().args(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}

pub(crate) fn test(layout: &Layout) -> Outcome {
    setup::run_for_tests(layout)?;
    // Libraries, programs and tests, but not what has no tests in Rust: examples, of which tests call what they do, and the Python package.
    let tested = ["--workspace", "--tests"];
    let runner: &[&str] = if has_nextest(layout) { &["nextest", "run"] } else { &["test"] };
    run(layout.cargo().args(runner).args(tested))?;
    run(layout.cargo().args(["test", "--workspace", "--doc"]))?;
    of_python(layout)
}

/// The tests of the Python package alone.
pub(crate) fn python_package(layout: &Layout) -> Outcome {
    setup::take(layout, vec![wheel::step(layout)])?;
    of_python(layout)
}

/// They compare with the command `reorder`, which the tests of its crate have built.
fn of_python(layout: &Layout) -> Outcome {
    let built = build_executables(layout, &["test", "--no-run", "--workspace", "--test", "cli"])?;
    let reorder = built.iter().find(|path| path.file_stem().is_some_and(|name| name == "reorder"));
    let reorder = reorder.ok_or_else(|| Failure::step("cargo test", "it built no reorder".to_owned()))?;
    wheel::test(layout, reorder)
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
