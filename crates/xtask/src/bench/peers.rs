//! `.deps/peers/AREA`: a Python environment with the libraries that an area is compared with.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::env::Layout;
use crate::failure::Outcome;
use crate::{python, setup};

/// The environment of one area.
pub(crate) struct Peers {
    folder: PathBuf,
}

impl Peers {
    /// Brings the environment up to date with the area's list of pinned packages.
    pub(crate) fn of(layout: &Layout, area: &str, requirements: &'static str) -> Outcome<Self> {
        let folder = layout.deps().join("peers").join(area);
        let packages = python::pinned(requirements).collect();
        let step = python::environment_step(layout, "libraries to compare with", folder.clone(), packages);
        setup::take(layout, vec![step])?;
        Ok(Self { folder })
    }

    /// A Python program, given as its text, on one thread as ours are.
    pub(crate) fn python(&self, layout: &Layout, program: &str) -> Command {
        let mut command = layout.command(self.folder.join("bin/python"));
        command.args(["-c", program]).env_remove("PYTHONPATH");
        command.envs([("OMP_NUM_THREADS", "1"), ("OPENBLAS_NUM_THREADS", "1")]);
        command
    }

    /// A C++ program against headers of the environment (`cmeel` wheels), optimised for the same processors as ours: any
    /// x86-64. None where there is no compiler.
    pub(crate) fn compile(&self, layout: &Layout, source: &Path, program: &Path) -> Outcome<Option<Command>> {
        if Command::new("c++").arg("--version").output().is_err() {
            println!(
                "no C++ compiler found as `c++` (Debian, Ubuntu: build-essential): {} is left out",
                source.display()
            );
            return Ok(None);
        }
        let prefix = python::site_packages(&self.folder)?.join("cmeel.prefix/include");
        let mut compiler = layout.command("c++");
        compiler.args(["-std=c++17", "-O3", "-DNDEBUG"]).arg(source).arg("-o").arg(program);
        compiler.arg("-isystem").arg(&prefix).arg("-isystem").arg(prefix.join("eigen3"));
        python::output("c++", &mut compiler)?;
        Ok(Some(layout.command(program)))
    }
}
