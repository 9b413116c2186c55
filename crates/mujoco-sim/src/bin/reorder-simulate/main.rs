//! Executes a trajectory CSV in MuJoCo and reports how it went.

mod bag;
mod due;
mod files;
mod picture;
mod summary;

use std::io::{ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use mujoco_sim::{ExecuteOptions, SimError, SimulatedArm, SweepOptions, TOOL_SITE, model_file, read_trajectory};

use crate::due::{DuePoses, PoseSource};
use crate::summary::Summary;

#[derive(Parser)]
#[command(
    version,
    about = "Executes a joint trajectory in MuJoCo: tracking, contacts, torques and distance from the poses."
)]
struct Arguments {
    /// CSV with the header t,JOINT.position…,JOINT.velocity…,JOINT.acceleration…; `-` reads standard input
    trajectory: PathBuf,
    /// A model by name (ur5e, vx300s, panda), or an MJCF file with position servos
    #[arg(long, value_name = "NAME|MODEL.xml")]
    robot: String,
    /// Site of the model that marks the tool
    #[arg(long, default_value = TOOL_SITE)]
    tool_site: String,
    #[command(flatten)]
    poses: PoseSource,
    /// How long the run goes on after the trajectory's end, in s
    #[arg(long, default_value_t = ExecuteOptions::default().settle_s, allow_negative_numbers = true)]
    settle: f64,
    /// Before the run, looks for bodies that touch, or come nearer to each other than this many metres, anywhere along the trajectory
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    clearance: Option<f64>,
    /// Writes trajectory, poses and executed tool path as a bag
    #[arg(short, long, value_name = "OUT.mcap")]
    output: Option<PathBuf>,
    /// Writes time, reference, position and velocity of every joint, and the tool pose
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    /// Draws poses, tool path, tracking error and velocities
    #[arg(long, value_name = "OUT.svg")]
    picture: Option<PathBuf>,
    #[arg(long, default_value = "text")]
    format: Format,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// One JSON object
    Json,
    /// Lines for people
    Text,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("reorder-simulate: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), SimError> {
    if let Some(path) = arguments.output.as_ref().filter(|path| path.extension().is_none_or(|e| e != "mcap")) {
        let reason = "the bag's name must end in .mcap".into();
        return Err(SimError::Write { file: path.display().to_string(), reason });
    }
    let trajectory = read_trajectory(&arguments.trajectory)?;
    let due = DuePoses::read(&arguments.poses)?;
    let mut arm = SimulatedArm::load(model_file(&arguments.robot)?, &arguments.tool_site)?;
    let options = ExecuteOptions { settle_s: arguments.settle, ..ExecuteOptions::default() };
    let sweep =
        arguments.clearance.map(|clearance_m| arm.sweep(&trajectory, &SweepOptions { clearance_m })).transpose()?;
    let execution = arm.execute(&trajectory, &options)?;
    let errors = due.times_s.as_deref().map(|times| execution.pose_errors(&due.poses, times)).transpose()?;
    let summary = Summary::of(&execution, errors, sweep.as_ref());

    if let Some(path) = &arguments.output {
        bag::write(path, &trajectory, &due, &execution)?;
    }
    if let Some(path) = &arguments.csv {
        files::write_whole(path, &files::execution_csv(&execution))?;
    }
    if let Some(path) = &arguments.picture {
        let drawing = picture::draw(&execution, &due.poses);
        let drawing = drawing.map_err(|reason| SimError::Write { file: path.display().to_string(), reason })?;
        files::write_whole(path, &drawing)?;
    }
    print(&match arguments.format {
        Format::Json => summary.to_json() + "\n",
        Format::Text => summary.to_text(),
    })
}

/// A reader that stops early, such as `head`, is no error.
fn print(text: &str) -> Result<(), SimError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(SimError::Write { file: "standard output".into(), reason: error.to_string() })
        }
        _ => Ok(()),
    }
}
