//! `reorder simulate`: hands over to `reorder-simulate`, so that this command itself needs no MuJoCo.

use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::Command;

use clap::Args;

use crate::failure::Failure;

const PROGRAM: &str = "reorder-simulate";

#[derive(Args)]
pub(crate) struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Becomes the program beside this one, or the one on the PATH; returns only where there is none.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let beside = std::env::current_exe().map(|own| own.with_file_name(PROGRAM)).ok().filter(|path| path.exists());
    let program = beside.unwrap_or_else(|| PathBuf::from(PROGRAM));
    let error = Command::new(&program).args(&arguments.arguments).exec();
    Err(Failure::BadInput(format!(
        "{}: {error}; it is built by `cargo xtask setup` and `cargo build -p mujoco-sim`",
        program.display()
    )))
}
