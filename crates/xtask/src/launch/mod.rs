//! Starts what a launch file asks for, where there is no `ros2 launch`.

mod file;
mod substitution;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::install::{self, PACKAGE};
use crate::process::Running;
use crate::setup;
use file::{Process, Program};

/// How often the processes are looked at; nothing tells of the first of several to end.
const PERIOD: Duration = Duration::from_millis(100);

/// Runs the processes of a file until one of them ends badly, all have ended, or Ctrl-C, which reaches them all.
pub(crate) fn run(layout: &Layout, file: &Path, arguments: &[String]) -> Outcome {
    let refuse = |why: String| Failure::step("the launch", why);
    let given = arguments.iter().map(|argument| {
        let pair = argument.split_once(":=").map(|(name, value)| (name.to_owned(), value.to_owned()));
        pair.ok_or_else(|| refuse(format!("{argument} is no argument: write name:=value")))
    });
    let processes = file::processes(file, &given.collect::<Outcome<Vec<_>>>()?).map_err(refuse)?;
    setup::run(layout)?;
    let executables = install::build(layout)?;
    let mut running = Vec::new();
    for process in processes {
        let mut command = command(layout, &executables, &process)?;
        command.args(&process.arguments).envs(process.environment).stdin(Stdio::null());
        running.push(Running::start("a process of the launch", &mut command)?);
    }
    while !running.is_empty() {
        let mut left = Vec::new();
        let mut failed = None;
        for process in running {
            match process.unless_ended() {
                Ok(still) => left.extend(still),
                Err(failure) => failed = Some(failure),
            }
        }
        if let Some(failure) = failed {
            // The others are of no use without it; they are asked to leave, so that an arm comes to rest.
            left.into_iter().for_each(|process| drop(process.interrupt()));
            return Err(failure);
        }
        running = left;
        std::thread::sleep(PERIOD);
    }
    Ok(())
}

fn command(layout: &Layout, executables: &[PathBuf], process: &Process) -> Outcome<Command> {
    Ok(match &process.program {
        Program::Node { package, executable } if package == PACKAGE => {
            let found =
                executables.iter().find(|path| path.file_name().is_some_and(|name| name == executable.as_str()));
            let missing = || Failure::step("the launch", format!("{PACKAGE} has no executable {executable}"));
            layout.command(found.ok_or_else(missing)?)
        }
        Program::Node { package, .. } => {
            return Err(Failure::step("the launch", format!("the package {package} is not here: only {PACKAGE} is")));
        }
        // The interpreter that has rclpy.
        Program::Command(program) if program == "python3" => layout.command(layout.ros_python()),
        Program::Command(program) => layout.command(program),
    })
}
