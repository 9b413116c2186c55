//! Where things are, and the environment that child processes need.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The checkout and what the set-up puts into its `.deps`.
pub(crate) struct Layout {
    root: PathBuf,
}

impl Layout {
    pub(crate) fn of_this_checkout() -> Self {
        // Cargo names the checkout it runs for: two checkouts may share one target directory, and so this binary.
        let manifest = env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
        let root = Path::new(&manifest).ancestors().nth(2).expect("crates/xtask is two levels deep");
        Self::at(root)
    }

    pub(crate) fn at(root: &Path) -> Self {
        Self { root: root.to_path_buf() }
    }

    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    pub(crate) fn deps(&self) -> PathBuf {
        self.root.join(".deps")
    }

    pub(crate) fn venv(&self) -> PathBuf {
        self.deps().join("venv")
    }

    pub(crate) fn venv_python(&self) -> PathBuf {
        self.venv().join("bin/python")
    }

    pub(crate) fn ros(&self) -> PathBuf {
        self.deps().join("ros")
    }

    pub(crate) fn interfaces(&self) -> PathBuf {
        self.deps().join("interfaces")
    }

    pub(crate) fn mujoco(&self) -> PathBuf {
        self.deps().join("mujoco")
    }

    pub(crate) fn browser(&self) -> PathBuf {
        self.deps().join("browser")
    }

    pub(crate) fn libclang(&self) -> PathBuf {
        self.deps().join("libclang")
    }

    /// The prefixes of a ROS 2 that the user sourced. `.cargo/config.toml` sets the variable to `.deps/ros` otherwise.
    pub(crate) fn sourced_ros(&self) -> Option<String> {
        let prefixes = env::var("AMENT_PREFIX_PATH").ok().filter(|prefixes| !prefixes.is_empty())?;
        (Path::new(&prefixes) != self.ros()).then_some(prefixes)
    }

    /// The interpreter that imports rclpy: the shell's for a sourced ROS 2, else the one of `.deps/venv`.
    pub(crate) fn ros_python(&self) -> PathBuf {
        if self.sourced_ros().is_some() { PathBuf::from("python3") } else { self.venv_python() }
    }

    /// A child process in the checkout whose ROS 2 traffic stays on this machine unless the user says otherwise.
    pub(crate) fn command(&self, program: impl AsRef<Path>) -> Command {
        let mut command = Command::new(program.as_ref());
        command.current_dir(&self.root);
        if env::var_os("ROS_AUTOMATIC_DISCOVERY_RANGE").is_none() {
            command.env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
        }
        command
    }

    /// The cargo that runs this chore.
    pub(crate) fn cargo(&self) -> Command {
        self.command(env::var_os("CARGO").map_or_else(|| PathBuf::from("cargo"), PathBuf::from))
    }
}
