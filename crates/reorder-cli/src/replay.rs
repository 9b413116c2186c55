//! `reorder replay`: recordings put in order, one bag or many.

mod bag;
mod inputs;
mod score;
mod summary;

use std::collections::HashSet;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use clap::{Args, ValueEnum};
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use planner::pose_bag::{Grouping, Selection, remove_abandoned};
use planner::reorder::{Options, Weight};
use rayon::prelude::*;

use crate::failure::Failure;
use crate::order::{Topology, weight};
use crate::output::{print, spare};
use crate::plan::{MinimumVerdict, load_robot};
use crate::source::frame_pair;
use ::report::counted;
use bag::{Task, replay};
use inputs::Input;
use summary::{BagSummary, Status, table};

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
    let inputs = inputs::find(&arguments.bags)?;
    let outputs = outputs(arguments, &inputs)?;
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

/// The file for every bag.
fn outputs(arguments: &Arguments, inputs: &[Input]) -> Result<Vec<Option<PathBuf>>, Failure> {
    let Some(output) = &arguments.output else { return Ok(vec![None; inputs.len()]) };
    let is_file = output.extension().is_some_and(|extension| extension == "mcap") && !output.is_dir();
    if is_file && inputs.len() > 1 {
        let (output, bags) = (output.display(), inputs.len());
        return Err(Failure::BadInput(format!("{output} is one file for {bags} bags: name a folder")));
    }
    let folder =
        if is_file { output.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")) } else { output };
    let named = |error: std::io::Error| Failure::BadInput(format!("{}: {error}", folder.display()));
    if !is_file {
        // The next run would find the outputs of this one among its bags.
        let within = |searched: &&PathBuf| {
            let searched = fs::canonicalize(searched).ok().filter(|path| path.is_dir());
            let from = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
            let place = from.ancestors().find_map(|path| fs::canonicalize(path).ok());
            place.zip(searched).is_some_and(|(place, searched)| place.starts_with(searched))
        };
        if let Some(searched) = arguments.bags.iter().find(within) {
            let (folder, searched) = (folder.display(), searched.display());
            return Err(Failure::BadInput(format!(
                "{folder} lies in {searched}: outputs go where no bags are looked for"
            )));
        }
        fs::create_dir_all(folder).map_err(named)?;
    }
    remove_abandoned(folder).map_err(Failure::bad_input)?;
    let file = |input: &Input| if is_file { output.clone() } else { folder.join(format!("{}.mcap", input.name)) };
    let outputs: Vec<PathBuf> = inputs.iter().map(file).collect();
    let taken = inputs.iter().flat_map(|input| input.files.iter().map(|file| &file.path).chain([&input.path]));
    spare(taken.map(PathBuf::as_path), outputs.iter().map(PathBuf::as_path))?;
    Ok(outputs.into_iter().map(Some).collect())
}

fn task(arguments: &Arguments) -> Result<Task, Failure> {
    let grouping = match (arguments.window, arguments.gap) {
        (Some(length_ns), _) => Grouping::Window { length_ns },
        (None, Some(longest_ns)) => Grouping::Gap { longest_ns },
        (None, None) => Grouping::Whole,
    };
    let selection =
        |topic: Option<&String>| Selection { topic: topic.cloned(), frames: arguments.frames.clone(), grouping };
    let selections: Vec<Selection> = match arguments.topic.as_slice() {
        [] => vec![selection(None)],
        topics => {
            let mut seen = HashSet::new();
            topics.iter().filter(|topic| seen.insert(*topic)).map(|topic| selection(Some(topic))).collect()
        }
    };
    let robot = arguments.robot.as_deref().map(|name| load_robot(name, arguments.limits.as_deref())).transpose()?;
    let options = Options { topology: arguments.topology.into(), ..Options::default() };
    let (weight, score, minimum_verdict) =
        (arguments.metres_per_radian, arguments.score, arguments.minimum_verdict.into());
    let version = env!("CARGO_PKG_VERSION");
    let of_robot = robot.as_ref().map(|robot| {
        let mut hasher = DefaultHasher::new();
        format!("{robot:?}").hash(&mut hasher);
        format!("{} {:016x}", robot.name, hasher.finish())
    });
    let settings = format!("{version} {selections:?} {options:?} {weight:?} {score} {minimum_verdict:?} {of_robot:?}");
    Ok(Task { selections, options, weight, score, robot, minimum_verdict, settings })
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
    let refused = bags.iter().flat_map(|bag| &bag.sets).filter(|set| set.refused.is_some()).count();
    match (broken.as_slice(), bags) {
        ([BagSummary { error: Some(error), .. }], [_]) => Err(Failure::BadInput(error.clone())),
        ([], _) if damaged > 0 => Err(Failure::BadInput(format!("{} damaged", counted(damaged, "bag")))),
        ([], _) if planned && refused > 0 => {
            Err(Failure::Refused(format!("{} without trajectory", counted(refused, "set"))))
        }
        ([], _) => Ok(()),
        (broken, _) => {
            Err(Failure::BadInput(format!("{} of {} could not be replayed", broken.len(), counted(bags.len(), "bag"))))
        }
    }
}
