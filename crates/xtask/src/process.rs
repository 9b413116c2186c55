//! Child processes that work together.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use serde_json::Value;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};

/// Builds with cargo and returns the executables; cargo itself says where it put them, since a target directory may be
/// configured anywhere.
pub(crate) fn build_executables(layout: &Layout, arguments: &[&str]) -> Outcome<Vec<PathBuf>> {
    let mut cargo = layout.cargo();
    cargo.args(arguments).arg("--message-format=json-render-diagnostics");
    let output = cargo.stderr(Stdio::inherit()).output().map_err(Failure::io("run", "cargo"))?;
    if !output.status.success() {
        return Err(Failure::Command { what: format!("cargo {}", arguments.join(" ")), status: output.status });
    }
    let messages = String::from_utf8_lossy(&output.stdout);
    let executable = |line| serde_json::from_str::<Value>(line).ok()?["executable"].as_str().map(PathBuf::from);
    Ok(messages.lines().filter_map(executable).collect())
}

/// A child process that does not outlive this one's interest in it.
pub(crate) struct Running {
    name: &'static str,
    child: Child,
}

impl Running {
    pub(crate) fn start(name: &'static str, command: &mut Command) -> Outcome<Self> {
        let child = command.spawn().map_err(Failure::io("run", name))?;
        Ok(Self { name, child })
    }

    /// Reads its standard output up to a line; the rest is read and dropped on a thread, so that it never blocks.
    pub(crate) fn wait_for_line(&mut self, wanted: &str) -> Outcome {
        let ended = || Failure::step(self.name, format!("it ended before it printed {wanted}"));
        let mut output = BufReader::new(self.child.stdout.take().ok_or_else(ended)?);
        let mut line = String::new();
        while line.trim() != wanted {
            line.clear();
            if output.read_line(&mut line).map_err(Failure::io("read from", self.name))? == 0 {
                return Err(ended());
            }
        }
        std::thread::spawn(move || std::io::copy(&mut output, &mut std::io::sink()));
        Ok(())
    }

    /// Waits for it; both peers have a timeout of their own.
    pub(crate) fn finish(mut self) -> Outcome {
        let status = self.child.wait().map_err(Failure::io("wait for", self.name))?;
        if status.success() { Ok(()) } else { Err(Failure::Command { what: self.name.into(), status }) }
    }

    /// Itself while it runs, nothing once it has ended well.
    pub(crate) fn unless_ended(mut self) -> Outcome<Option<Self>> {
        match self.child.try_wait().map_err(Failure::io("wait for", self.name))? {
            None => Ok(Some(self)),
            Some(status) if status.success() => Ok(None),
            Some(status) => Err(Failure::Command { what: self.name.into(), status }),
        }
    }

    /// Asks it to end as Ctrl-C does.
    pub(crate) fn ask_to_end(&self) {
        // A process that is gone already needs no asking.
        let _ = Command::new("kill").args(["-INT", &self.id().to_string()]).stderr(Stdio::null()).status();
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Asks it to end as Ctrl-C does, and expects a clean exit.
    pub(crate) fn interrupt(self) -> Outcome {
        self.ask_to_end();
        self.finish()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Already ended in the ordinary case; nothing can be done about a child that cannot be killed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
