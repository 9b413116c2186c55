//! Checks and releases an arm of Dynamixel servos, real or emulated, and draws recorded shapes with the emulated one.

mod check;
mod drawing;
mod motion;
mod pacer;
mod shape;
mod soak;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use dynamixel_hil::Config;
use dynamixel_hil::emulator::Timing;

/// An arm of Dynamixel servos: check it, release it, draw recorded shapes with the emulated one.
#[derive(Parser)]
#[command(name = "dynamixel-hil")]
struct Arguments {
    /// The arm
    #[arg(long, default_value = "config/arms/vx300s.yaml")]
    config: PathBuf,
    /// Another port than the configuration's: sim, /dev/ttyUSB0, …
    #[arg(long)]
    port: Option<String>,
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Say whether the servos are those of the configuration, and how they are; nothing is written, nothing moves
    Check,
    /// Switch every torque off: the arm falls, unless somebody holds it
    Release,
    /// Draw each shape once; one JSON object on standard output
    Draw {
        /// By simulated time, which waits for the program: repeats itself, and says nothing of the rate and jitter in real time
        #[arg(long)]
        bus_time: bool,
        /// Recordings of poses
        #[arg(required = true)]
        bags: Vec<PathBuf>,
    },
    /// Draw the shapes again and again on a bus that damages packets; one JSON object on standard output
    Soak {
        /// For so long
        #[arg(long)]
        minutes: f64,
        /// Chance of a packet to arrive with flipped bits, each way
        #[arg(long, default_value_t = 0.01)]
        corrupted: f64,
        /// Recordings of poses
        #[arg(required = true)]
        bags: Vec<PathBuf>,
    },
}

fn main() -> ExitCode {
    let Arguments { config, port, task } = Arguments::parse();
    match run(&config, port, task) {
        Ok(json) => {
            println!("{json:#}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("dynamixel-hil: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(config: &Path, port: Option<String>, task: Task) -> Result<serde_json::Value, Box<dyn Error>> {
    let mut config = Config::read(config)?;
    config.port = port.unwrap_or(config.port);
    match task {
        Task::Check => check::check(&config),
        Task::Release => check::release(&config),
        Task::Draw { bus_time, bags } => {
            let timing = if bus_time { Timing::BusTime } else { Timing::WallClock };
            drawing::draw_all(&config, &bags, timing)
        }
        Task::Soak { minutes, corrupted, bags } => soak::run(&config, &bags, 60.0 * minutes, corrupted),
    }
}
