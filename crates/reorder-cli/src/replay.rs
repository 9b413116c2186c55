//! `reorder replay`: recordings put in order, one bag or many.

use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use ::report::counted;
use bag_replay::{BagSummary, Input, Status, Task, find, load_robot, outputs, replay, table};
use clap::{Args, ValueEnum};
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use planner::pose_bag::Grouping;
use planner::reorder::Weight;
use rayon::prelude::*;

use crate::failure::Failure;
use crate::order::{Topology, weight};
use crate::output::print;
use crate::plan::MinimumVerdict;
use crate::source::frame_pair;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Bags (rosbag2 folders, MCAP or .db3 files), and folders that are searched for them
    #[arg(required = true, value_name = "BAG|FOLDER")]
    bags: Vec<PathBuf>,
    /// Topic with poses, several times for several; the only one of a bag where it is not given
    #[arg(long)]
    topic: Vec<String>,
    /// The frames whose transforms are meant, where the topic is of type TFMessage
    #[arg(long, value_name = "PARENT:CHILD", value_parser = frame_pair)]
    frames: Option<(String, String)>,
    /// Of messages with one pose each, take together those recorded within so many seconds [default: all]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, conflicts_with = "gap")]
    window: Option<u64>,
    /// Of messages with one pose each, take together those between silences longer than so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    gap: Option<u64>,
    /// Where the ordered poses, path, markers and trajectory go: an MCAP file, or a folder for a file a bag
    #[arg(short, long, value_name = "OUT.mcap|FOLDER")]
    output: Option<PathBuf>,
    /// Compare the order with the recorded one
    #[arg(long)]
    score: bool,
    /// Plan a trajectory too: a shipped robot by name, or a URDF file, which needs --limits
    #[arg(long, value_name = "NAME|FILE.urdf")]
    robot: Option<String>,
    /// Frames and limits of every joint, in the form of config/robots/ur5e.yaml
    #[arg(long, value_name = "FILE.yaml", requires = "robot")]
    limits: Option<PathBuf>,
    /// Least certain order that is still planned
    #[arg(long, default_value = "plausible", requires = "robot")]
    minimum_verdict: MinimumVerdict,
    /// How many metres count as much as one radian: a number, or `auto` to tell it from the poses of each set
    #[arg(long, value_name = "L", default_value = "auto", value_parser = weight)]
    metres_per_radian: Weight,
    /// Open curve, closed curve, or told from the poses
    #[arg(long, default_value = "auto")]
    topology: Topology,
    /// What to print: a line a bag and topic, or an object with everything
    #[arg(long, default_value = "table")]
    format: Format,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Table,
    Json,
}

fn seconds(text: &str) -> Result<u64, String> {
    let seconds: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if seconds > 0.0 && seconds < 1e9 { Ok((seconds * 1e9) as u64) } else { Err("not a positive time".to_owned()) }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let inputs = find(&arguments.bags).map_err(Failure::bad_input)?;
    let outputs: Vec<Option<PathBuf>> = match &arguments.output {
        Some(output) => {
            let outputs = outputs(&arguments.bags, &inputs, output).map_err(Failure::bad_input)?;
            outputs.into_iter().map(Some).collect()
        }
        None => vec![None; inputs.len()],
    };
    let task = task(arguments)?;
    let bar = progress(&inputs);
    let done = AtomicUsize::new(0);
    let one = |(input, output): (&Input, &Option<PathBuf>)| {
        let (bytes, told) = (input.bytes(), std::cell::Cell::new(0));
        let advance = |part: f64| {
            let now = (part * bytes as f64) as u64;
            bar.inc(now.saturating_sub(told.replace(now)));
        };
        let summary = replay(input, output.as_deref(), &task, &advance);
        advance(1.0);
        bar.set_message(format!("{} of {}, ", 1 + done.fetch_add(1, Relaxed), counted(inputs.len(), "bag")));
        say(&bar, &summary, inputs.len());
        summary
    };
    let bags: Vec<BagSummary> = inputs.par_iter().zip(&outputs).map(one).collect();
    bar.finish_and_clear();
    print(&match arguments.format {
        Format::Table => table(&bags),
        Format::Json => serde_json::to_string(&serde_json::json!({ "bags": bags })).map_err(Failure::bad_input)? + "\n",
    })?;
    verdict(&bags, arguments.robot.is_some())
}

fn task(arguments: &Arguments) -> Result<Task, Failure> {
    let robot = arguments.robot.as_deref().map(|name| load_robot(name, arguments.limits.as_deref()));
    Ok(Task {
        topics: arguments.topic.clone(),
        frames: arguments.frames.clone(),
        grouping: match (arguments.window, arguments.gap) {
            (Some(length_ns), _) => Grouping::Window { length_ns },
            (None, Some(longest_ns)) => Grouping::Gap { longest_ns },
            (None, None) => Grouping::Whole,
        },
        topology: arguments.topology.into(),
        weight: arguments.metres_per_radian,
        score: arguments.score,
        robot: robot.transpose().map_err(Failure::bad_input)?,
        minimum_verdict: arguments.minimum_verdict.into(),
    })
}

/// Bytes of the bags that are done, on a terminal only.
fn progress(inputs: &[Input]) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(inputs.iter().map(Input::bytes).sum());
    let left = |state: &ProgressState, out: &mut dyn std::fmt::Write| {
        // Nothing is known before a part is done.
        let _ = if state.pos() > 0 { write!(out, "{}", HumanDuration(state.eta())) } else { write!(out, "some time") };
    };
    let template = "{spinner} [{bar:24}] {msg}{bytes} of {total_bytes}, {bytes_per_sec}, {left} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.with_key("left", left));
    }
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    bar
}

/// What is wrong with a bag, as soon as it is known.
fn say(bar: &ProgressBar, bag: &BagSummary, bags: usize) {
    bar.suspend(|| {
        for lost in &bag.lost {
            eprintln!("reorder: warning: {lost}; what is whole was taken");
        }
        // Of a single bag it is the last word.
        if let Some(error) = bag.error.as_ref().filter(|_| bags > 1) {
            eprintln!("reorder: {error}");
        }
        for set in &bag.sets {
            let place = set.message.map_or_else(String::new, |message| format!(", message {message}"));
            for why in set.error.iter().chain(&set.refused) {
                eprintln!("reorder: warning: {}, topic {}{place}: {why}", bag.bag, set.topic);
            }
        }
    });
}

fn verdict(bags: &[BagSummary], planned: bool) -> Result<(), Failure> {
    let broken: Vec<&BagSummary> = bags.iter().filter(|bag| bag.status == Status::Broken).collect();
    let damaged = bags.iter().filter(|bag| !bag.lost.is_empty()).count();
    let still: Vec<_> = bags.iter().flat_map(|bag| &bag.sets).filter(|set| set.trajectory.is_none()).collect();
    match (broken.as_slice(), bags) {
        ([BagSummary { error: Some(error), .. }], [_]) => Err(Failure::BadInput(error.clone())),
        ([], _) if damaged > 0 => Err(Failure::BadInput(format!("{} damaged", counted(damaged, "bag")))),
        ([], _) if planned && !still.is_empty() => {
            let sentence = format!("{} without trajectory", counted(still.len(), "set"));
            let is_bad_input = still.iter().any(|set| set.bad_input);
            Err(if is_bad_input { Failure::BadInput(sentence) } else { Failure::Refused(sentence) })
        }
        ([], _) => Ok(()),
        (broken, _) => {
            Err(Failure::BadInput(format!("{} of {} could not be replayed", broken.len(), counted(bags.len(), "bag"))))
        }
    }
}
