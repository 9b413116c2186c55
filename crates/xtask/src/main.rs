//! Every chore of the project, as `cargo xtask CHORE`.

mod bench;
mod browser;
mod demo;
mod env;
mod failure;
mod hil;
mod install;
mod interfaces;
mod launch;
mod mujoco;
mod process;
mod python;
mod ros;
mod score;
mod setup;
mod soak;
mod test;
mod wheel;

use clap::Parser;
use std::path::PathBuf;
use std::process::ExitCode;

/// Chores of the reorder workspace.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Chore {
    /// Put ROS 2, MuJoCo, Python packages, three.js and a browser to test with into .deps (idempotent, resumable)
    Setup,
    /// Set up, build, and run the main job for real: recorded poses, ROS 2, the node, MuJoCo
    Demo,
    /// Set up, build, and draw recorded shapes with Dynamixel servos that do not exist: ROBOTIS's SDK, an emulated bus, MuJoCo
    Hil,
    /// Run a long test at full length and print its figures
    Soak {
        name: soak::Soak,
        /// How many random cases (else 1000), seconds (fuzz-*, else 1000; link, else 60), minutes (load and hil, else 10), or bags (fleet, else
        /// 200)
        amount: Option<u32>,
    },
    /// Shuffle recordings whose order is known, have `reorder order` put them right, and print how many it did
    Score {
        /// CSV files in true order, and a manifest.json that lists them as {"file", "kind"}; handwriting of ours if none is given
        folder: Option<PathBuf>,
        /// Rows that are kept of each, evenly thinned
        #[arg(long, default_value_t = 1000)]
        max_n: usize,
        #[arg(long, default_value_t = 7)]
        seed: u64,
    },
    /// Measure an area (bags, geometry, ordering, manipulator, node, python) beside the libraries that others would use, and print the table
    Bench { area: String },
    /// Set up, build, and put the ROS package into an ament prefix, for `ros2 run` and `ros2 launch`
    Install {
        #[arg(long)]
        prefix: PathBuf,
    },
    /// Set up, build, and start what a launch file asks for, where there is no `ros2 launch`
    Launch {
        file: PathBuf,
        /// name:=value
        arguments: Vec<String>,
        /// Start what was built before, without the set-up and a build
        #[arg(long)]
        no_build: bool,
    },
    /// Set up, then run clippy and rustdoc over the workspace with warnings as errors
    Lint,
    /// Set up, then run every test there is
    Test,
    /// Build the wheel of the Python package
    Wheel {
        /// Where it goes; what is in the folder is removed
        #[arg(long, default_value = "target/wheel/release")]
        out: PathBuf,
        /// Build it as for tests, install it into an empty environment without Rust, and run its tests there
        #[arg(long, conflicts_with = "out")]
        test: bool,
    },
}

fn main() -> ExitCode {
    let layout = env::Layout::of_this_checkout();
    let outcome = match Chore::parse() {
        Chore::Setup => setup::run_for_tests(&layout),
        Chore::Demo => demo::run(&layout),
        Chore::Hil => hil::run(&layout),
        Chore::Soak { name, amount } => soak::run(&layout, name, amount),
        Chore::Score { folder, max_n, seed } => score::run(&layout, folder.as_deref(), max_n, seed),
        Chore::Bench { area } => bench::run(&layout, &area),
        Chore::Install { prefix } => install::run(&layout, &prefix),
        Chore::Launch { file, arguments, no_build } => launch::run(&layout, &file, &arguments, !no_build),
        Chore::Lint => test::lint(&layout),
        Chore::Test => test::test(&layout),
        Chore::Wheel { test: true, .. } => test::python_package(&layout),
        Chore::Wheel { out, .. } => wheel::run(&layout, &out),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}
