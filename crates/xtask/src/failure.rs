//! Why a chore stopped, and what to do about it.

use std::path::PathBuf;

/// Result of a chore.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

/// Each message is one sentence that says what is wrong and what to do.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("no Python {wanted} found (tried {tried}): install it, or name it as PYTHON=/path/to/python{wanted}")]
    NoPython { wanted: String, tried: String },
    #[error("{} has no {module} module: install the package that brings it (Debian, Ubuntu: python3-venv)", python.display())]
    NoVenv { python: PathBuf, module: &'static str },
    #[error("no C compiler found as `cc`: install one (Debian, Ubuntu: build-essential)")]
    NoCompiler,
    #[error("no C++ compiler found as `c++`: install one (Debian, Ubuntu: build-essential)")]
    NoCxxCompiler,
    #[error(
        "cannot reach the Python package index ({detail}): run again when the network is back; what was downloaded is kept"
    )]
    NoNetwork { detail: String },
    #[error("AMENT_PREFIX_PATH={prefixes} holds no ROS 2 (no lib/librcl.so): source a complete ROS 2 or unset it")]
    NoRosInPrefix { prefixes: String },
    #[error(
        "the sourced ROS 2 has no rclpy that `{python}` can import ({detail}): install it or unset AMENT_PREFIX_PATH"
    )]
    NoRclpy { python: String, detail: String },
    #[error("the sourced ROS 2 in {prefixes} has no {package}: install it (ros-$ROS_DISTRO-{}) or unset AMENT_PREFIX_PATH", package.replace('_', "-"))]
    NoPackage { prefixes: String, package: &'static str },
    #[error("there is no benchmark of {area}: choose one of {known}")]
    UnknownArea { area: String, known: String },
    #[error("{what} failed: {detail}")]
    Step { what: String, detail: String },
    #[error("{what} failed with {status}")]
    Command { what: String, status: std::process::ExitStatus },
    #[error("cannot {action} {}: {source}", path.display())]
    Io { action: &'static str, path: PathBuf, source: std::io::Error },
}

impl Failure {
    /// What failed, and why.
    pub(crate) fn step(what: &str, detail: String) -> Self {
        Self::Step { what: what.to_owned(), detail }
    }

    /// For `map_err` on a file operation.
    pub(crate) fn io(action: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { action, path, source }
    }
}
