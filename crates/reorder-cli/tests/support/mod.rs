//! The command run, and files for it.
#![allow(dead_code, reason = "every test binary uses its own part of it")]

use std::fs;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

pub(crate) const BAGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data");

pub(crate) fn reorder(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reorder")).args(arguments).stdin(Stdio::null()).output().unwrap()
}

pub(crate) fn out(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Exit code and the sentence on standard error; there is exactly one line, and nothing on standard output.
pub(crate) fn refusal(arguments: &[&str]) -> (i32, String) {
    let output = reorder(arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(output.stdout.is_empty());
    (output.status.code().unwrap(), said.trim_end().to_owned())
}

pub(crate) fn file(folder: &TempDir, name: &str, content: &str) -> String {
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    path.display().to_string()
}

/// Points on a quarter circle, written in the order 0 3 6 9 2 5 8 1 4 7.
pub(crate) fn arc(columns: &str, row: impl Fn(f64) -> String) -> String {
    let rows: Vec<String> = (0..10).map(|i| row(f64::from((i * 3) % 10) * 0.15)).collect();
    format!("{columns}\n{}\n", rows.join("\n"))
}
