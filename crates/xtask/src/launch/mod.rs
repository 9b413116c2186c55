//! Starts what a launch file asks for, where there is no `ros2 launch`.

mod file;
mod substitution;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::install::{self, PACKAGE};
use crate::process::Running;
use crate::setup;
use file::{Process, Program};

/// How often the processes are looked at; nothing tells of the first of several to end.
const PERIOD: Duration = Duration::from_millis(100);
/// How long processes may take to end; the nodes give their middleware three seconds.
const GRACE: Duration = Duration::from_secs(8);

/// Runs the processes of a file until one of them ends badly, all have ended, or this one is asked to end: then they are asked, too.
pub(crate) fn run(layout: &Layout, file: &Path, arguments: &[String], build: bool) -> Outcome {
    let refuse = |why: String| Failure::step("the launch", why);
    let given = arguments.iter().map(|argument| {
        let pair = argument.split_once(":=").map(|(name, value)| (name.to_owned(), value.to_owned()));
        pair.ok_or_else(|| refuse(format!("{argument} is no argument: write name:=value")))
    });
    let processes = file::processes(file, &given.collect::<Outcome<Vec<_>>>()?).map_err(refuse)?;
    let executables = if build {
        setup::run(layout)?;
        install::build(layout)?
    } else {
        install::built_before()?
    };
    let asked_to_end = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        let registered = signal_hook::flag::register(signal, Arc::clone(&asked_to_end));
        registered.map_err(|error| refuse(format!("signals cannot be awaited: {error}")))?;
    }
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
            stop(left);
            return Err(failure);
        }
        if asked_to_end.load(Ordering::Relaxed) {
            stop(left);
            return Ok(());
        }
        running = left;
        std::thread::sleep(PERIOD);
    }
    Ok(())
}

/// Asks all of them to end, and ends those that do not.
fn stop(mut running: Vec<Running>) {
    running.iter().for_each(Running::ask_to_end);
    let deadline = Instant::now() + GRACE;
    while !running.is_empty() && Instant::now() < deadline {
        std::thread::sleep(PERIOD);
        // How they end is of no interest any more.
        running = running.into_iter().filter_map(|process| process.unless_ended().ok().flatten()).collect();
    }
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
