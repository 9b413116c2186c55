//! `reorder plan`.

use std::fs;
use std::path::{Path, PathBuf};

use bag_replay::{load_robot, spare};
use clap::{Args, ValueEnum};
use planner::reorder::Verdict;
use planner::{Config, Report, Request, plan};

use crate::failure::Failure;
use crate::order::Topology;
use crate::output::{Pending, print, trajectory_csv, write_bag};
use crate::source::Source;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// A shipped robot by name (ur5e, vx300s, panda), or a URDF file, which needs --limits
    #[arg(long, value_name = "NAME|FILE.urdf")]
    robot: String,
    /// Frames and limits of every joint, in the form of config/robots/ur5e.yaml
    #[arg(long, value_name = "FILE.yaml")]
    limits: Option<PathBuf>,
    /// Trajectory points a second, from 10 to 10000 [default: 100]
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Where the trajectory goes: a CSV or an MCAP file; CSV on standard output where it is not given
    #[arg(short, long, value_name = "OUT.csv|OUT.mcap")]
    output: Option<PathBuf>,
    /// Where the report goes: the JSON object of `order` with the plan's audit and the time of every pose
    #[arg(long, value_name = "REPORT.json")]
    report: Option<PathBuf>,
    /// How many metres count as much as one radian when poses are compared [default: 0.1]
    #[arg(long, value_name = "L")]
    metres_per_radian: Option<f64>,
    /// Open curve, closed curve, or told from the poses
    #[arg(long)]
    topology: Option<Topology>,
    /// Pose (counted from 0) at which the trajectory starts: one of the two ends, unless the curve is closed
    #[arg(long, value_name = "INDEX")]
    start: Option<usize>,
    /// Joint positions the robot stands at, in rad, from base to tool, separated by commas; the trajectory then starts there
    #[arg(long, value_name = "Q1,Q2,…", value_delimiter = ',', allow_hyphen_values = true)]
    from: Option<Vec<f64>>,
    /// Least certain order that is still planned
    #[arg(long)]
    minimum_verdict: Option<MinimumVerdict>,
    /// What else shapes a plan, as `timing: {constant_tool_speed_m_s: 0.05}` in YAML: the keys of config/reorder.yaml that are the
    /// planner's; what the command line says precedes it
    #[arg(long, value_name = "FILE.yaml")]
    config: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum MinimumVerdict {
    Ambiguous,
    Plausible,
    Certified,
}

impl From<MinimumVerdict> for Verdict {
    fn from(verdict: MinimumVerdict) -> Self {
        match verdict {
            MinimumVerdict::Ambiguous => Self::Ambiguous,
            MinimumVerdict::Plausible => Self::Plausible,
            MinimumVerdict::Certified => Self::Certified,
        }
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let as_bag = match arguments.output.as_deref().map(Path::extension) {
        None => false,
        Some(Some(extension)) if extension == "csv" => false,
        Some(Some(extension)) if extension == "mcap" => true,
        Some(_) => return Err(Failure::BadInput("the output must end in .csv or .mcap".into())),
    };
    let urdf = arguments.robot.ends_with(".urdf").then(|| Path::new(&arguments.robot));
    let inputs = [&arguments.limits, &arguments.config].into_iter().filter_map(|path| path.as_deref());
    let outputs = [&arguments.output, &arguments.report].into_iter().filter_map(|path| path.as_deref());
    spare(inputs.chain(urdf).chain([arguments.source.input.as_path()]), outputs).map_err(Failure::bad_input)?;
    let robot = load_robot(&arguments.robot, arguments.limits.as_deref()).map_err(Failure::bad_input)?;
    let config = configure(arguments)?;
    let set = arguments.source.poses()?;
    let request =
        Request { frame_id: set.frame_id, poses: set.poses, start: arguments.from.clone(), ..Request::default() };
    let name = arguments.source.input.display();
    let plan = plan(&robot, &config, &request).map_err(|refusal| {
        let sentence = format!("{name}: {refusal}");
        if refusal.is_bad_input() { Failure::BadInput(sentence) } else { Failure::Refused(sentence) }
    })?;
    let report = || Report::of(&robot.name, &Ok(plan.clone()), None).to_json() + "\n";
    // The report appears after the trajectory that it is about, and nothing is replaced where it cannot be written.
    let report = arguments.report.as_deref().map(|path| Pending::write(path, &report())).transpose()?;
    match &arguments.output {
        None => print(&trajectory_csv(&plan.trajectory)?),
        Some(path) if as_bag => write_bag(path, &plan, &robot.base_frame, &request),
        Some(path) => Pending::write(path, &trajectory_csv(&plan.trajectory)?)?.appear(),
    }?;
    report.map_or(Ok(()), Pending::appear)?;
    let ratio = &plan.audit.max_ratio;
    eprintln!(
        "{} poses, order {:?}; {} points in {:.3} s; peaks at {:.1} % of the velocity, {:.1} % of the acceleration and {:.1} % of the \
         jerk limits",
        request.poses.len(),
        plan.ordering.verdict,
        plan.trajectory.points.len(),
        plan.trajectory.duration_s(),
        100.0 * ratio.velocity,
        100.0 * ratio.acceleration,
        100.0 * ratio.jerk
    );
    Ok(())
}

fn configure(arguments: &Arguments) -> Result<Config, Failure> {
    let mut config = match &arguments.config {
        Some(path) => {
            let named = |error: &dyn std::fmt::Display| Failure::BadInput(format!("{}: {error}", path.display()));
            Config::from_yaml(&fs::read_to_string(path).map_err(|error| named(&error))?)
                .map_err(|error| named(&error))?
        }
        None => Config::default(),
    };
    config.topology = arguments.topology.map_or(config.topology, Into::into);
    config.start = arguments.start.or(config.start);
    config.minimum_verdict = arguments.minimum_verdict.map_or(config.minimum_verdict, Into::into);
    config.metres_per_radian = arguments.metres_per_radian.unwrap_or(config.metres_per_radian);
    config.timing.rate_hz = arguments.rate.unwrap_or(config.timing.rate_hz);
    Ok(config)
}
