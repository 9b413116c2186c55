//! `reorder report`.

use std::fs;
use std::path::{Path, PathBuf};

use ::report::{DrawingLibrary, Points, Report, ReportError, Simulation, page};
use bag_replay::{load_robot, spare};
use clap::Args;
use planner::manipulator::Robot;
use planner::reorder::{EdgeFigures, Options, Ordering, Weight, order_poses};
use planner::se3_geom::{Pose, PoseSpline, Se3};
use planner::{Config, Plan, Refusal, Request, interpolate, plan};

use crate::ask::Ask;
use crate::failure::Failure;
use crate::order::{Topology, weight};
use crate::output::Pending;
use crate::plan::MinimumVerdict;
use crate::source::{Manifold, Source};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Where the page goes
    #[arg(short, long, value_name = "REPORT.html")]
    output: PathBuf,
    /// Plan for this arm too, and show it moving: ur5e, vx300s, panda, or a URDF file, which needs --limits. Else points and order only
    #[arg(long, value_name = "NAME|FILE.urdf")]
    robot: Option<String>,
    /// Frames and limits of every joint, in the form of config/robots/ur5e.yaml
    #[arg(long, value_name = "FILE.yaml", requires = "robot")]
    limits: Option<PathBuf>,
    /// A run of the plan: what `reorder simulate --format json` printed
    #[arg(long, value_name = "FILE.json", requires = "robot")]
    simulation: Option<PathBuf>,
    /// The space the points live in; told from the columns where it is not given
    #[arg(long, conflicts_with = "robot")]
    manifold: Option<Manifold>,
    /// How many metres count as much as one radian when poses are compared [default: auto; 0.1 with --robot]
    #[arg(long, value_name = "L", value_parser = weight)]
    metres_per_radian: Option<Weight>,
    /// Open curve, closed curve, or told from the points
    #[arg(long, default_value = "auto")]
    topology: Topology,
    /// Row (counted from 0) at which the order starts
    #[arg(long, value_name = "INDEX")]
    start: Option<usize>,
    /// Joint positions the robot stands at, in rad, from base to tool, separated by commas; the trajectory then starts there
    #[arg(long, value_name = "Q1,Q2,…", value_delimiter = ',', allow_hyphen_values = true, requires = "robot")]
    from: Option<Vec<f64>>,
    /// Least certain order that is still planned
    #[arg(long, default_value = "plausible")]
    minimum_verdict: MinimumVerdict,
    /// three.js, which draws the picture: build/three.cjs of its npm package, up to 0.184. Not needed after `cargo xtask setup`
    #[arg(long, value_name = "FILE.cjs")]
    drawing_library: Option<PathBuf>,
}

/// Points in order, and what came of planning where that was asked for.
struct Found {
    points: Points,
    ordering: Ordering,
    edges: Vec<EdgeFigures>,
    spline: Option<PoseSpline>,
    planned: Option<(Robot, Result<Plan, Refusal>)>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let files = [&arguments.limits, &arguments.simulation, &arguments.drawing_library].into_iter();
    let urdf = arguments.robot.as_deref().map(Path::new);
    let inputs = files.filter_map(|path| path.as_deref()).chain(urdf).chain([arguments.source.input.as_path()]);
    spare(inputs, [arguments.output.as_path()].into_iter()).map_err(Failure::bad_input)?;
    let library = library(arguments.drawing_library.as_deref())?;
    let simulation = arguments.simulation.as_deref().map(simulation).transpose()?;
    let found = match &arguments.robot {
        Some(robot) => {
            let robot = load_robot(robot, arguments.limits.as_deref()).map_err(Failure::bad_input)?;
            planned(arguments, robot)?
        }
        None => ordered(arguments)?,
    };
    let outcome = found.planned.as_ref().map(|(_, outcome)| outcome.as_ref());
    let name = arguments.source.name();
    if let Some(Err(refusal)) = outcome {
        // The page is what was asked for, and it says so too: this is no failure of the command.
        eprintln!("reorder: warning: {name}: the plan was refused: {refusal}");
    }
    let report = Report {
        name: short_name(&arguments.source.input, &name),
        points: &found.points,
        ordering: &found.ordering,
        edges: &found.edges,
        spline: found.spline.as_ref(),
        robot: found.planned.as_ref().map(|(robot, _)| robot),
        outcome,
        simulation: simulation.as_ref(),
    };
    let html = page(&report, &library).map_err(|error| in_file(arguments.simulation.as_deref(), error))?;
    Pending::write(&arguments.output, &html)?.appear()
}

/// The last part of a path; what the page is called must not tell where on a machine it was made.
fn short_name<'a>(input: &'a Path, name: &'a str) -> &'a str {
    match input.file_name().and_then(|last| last.to_str()) {
        Some(last) if last != "-" => last,
        _ => name,
    }
}

fn in_file(path: Option<&Path>, error: ReportError) -> Failure {
    Failure::BadInput(path.map_or_else(|| error.to_string(), |path| format!("{}: {error}", path.display())))
}

fn read(path: &Path) -> Result<String, Failure> {
    fs::read_to_string(path).map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))
}

fn library(given: Option<&Path>) -> Result<DrawingLibrary, Failure> {
    let Some(path) = given.map(Path::to_path_buf).or_else(DrawingLibrary::set_up) else {
        return Err(Failure::BadInput(
            "the page draws with three.js, which is not part of this program: run `cargo xtask setup` once in the checkout, or `npm pack \
             three@0.184.0`, unpack it and give its build/three.cjs as --drawing-library"
                .to_owned(),
        ));
    };
    DrawingLibrary::new(&read(&path)?).map_err(|error| in_file(Some(&path), error))
}

fn simulation(path: &Path) -> Result<Simulation, Failure> {
    Simulation::from_json(&read(path)?).map_err(|error| in_file(Some(path), error))
}

fn ordered(arguments: &Arguments) -> Result<Found, Failure> {
    let rows = arguments.source.rows(arguments.manifold)?;
    let options = Options { topology: arguments.topology.into(), start: arguments.start, ..Options::default() };
    let ask =
        Ask { options, weight: arguments.metres_per_radian.unwrap_or(Weight::Auto), from: None, with_edges: true };
    let named = |why| Failure::BadInput(format!("{}: {why}", arguments.source.name()));
    let (ordering, edges) = ask.order(&rows).map_err(named)?;
    let points = rows.points.drawn();
    // A spline that cannot be had is not missed here; planning would say why.
    let spline = rows.points.poses().and_then(|poses| {
        let length = ordering.metres_per_radian.filter(|_| ordering.parts.is_empty())?;
        interpolate(poses, &ordering, length).ok()
    });
    Ok(Found { points, ordering, edges, spline, planned: None })
}

fn planned(arguments: &Arguments, robot: Robot) -> Result<Found, Failure> {
    let mut config = Config {
        topology: arguments.topology.into(),
        start: arguments.start,
        minimum_verdict: arguments.minimum_verdict.into(),
        ..Config::default()
    };
    match arguments.metres_per_radian {
        Some(Weight::MetresPerRadian(length)) => config.metres_per_radian = length,
        Some(Weight::Auto) => {
            return Err(Failure::BadInput("with --robot, --metres-per-radian needs a number".to_owned()));
        }
        None => {}
    }
    let set = arguments.source.poses()?;
    let request =
        Request { frame_id: set.frame_id, poses: set.poses, start: arguments.from.clone(), ..Request::default() };
    let outcome = plan(&robot, &config, &request);
    let poses = &request.poses;
    let ordering = match &outcome {
        Ok(plan) => plan.ordering.clone(),
        Err(refusal) if refusal.is_bad_input() => {
            return Err(Failure::BadInput(format!("{}: {refusal}", arguments.source.name())));
        }
        Err(refusal) => refusal.ordering().cloned().map_or_else(|| order_anew(poses, &config), Ok)?,
    };
    let metric = Se3::with_metres_per_radian(config.metres_per_radian).unwrap_or_default();
    let edges = ordering.edges(&metric, poses);
    let spline = match &outcome {
        Ok(plan) => Some(plan.spline.clone()),
        Err(_) => interpolate(poses, &ordering, config.metres_per_radian).ok(),
    };
    Ok(Found { points: Points::of_poses(poses), ordering, edges, spline, planned: Some((robot, outcome)) })
}

/// As before the refusal, which did not keep it.
fn order_anew(poses: &[Pose], config: &Config) -> Result<Ordering, Failure> {
    let options = Options { topology: config.topology, start: config.start, ..Options::default() };
    order_poses(poses, config.metres_per_radian, &options).map_err(Failure::bad_input)
}
