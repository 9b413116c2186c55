//! What came of each bag, as JSON and as a table.

use planner::Plan;
use planner::reorder::{Topology, Verdict};
use serde::{Deserialize, Serialize};

use crate::score::Score;

/// What came of a bag.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BagSummary {
    /// The bag, as it was named or found.
    pub bag: String,
    /// Whether it was replayed, and when.
    pub status: Status,
    /// Why nothing came of it.
    pub error: Option<String>,
    /// What of it could not be read.
    pub lost: Vec<String>,
    /// Where its output lies, where there is one.
    pub output: Option<String>,
    /// What came of every set of poses in it.
    pub sets: Vec<SetSummary>,
}

/// Whether a bag was replayed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Replayed now.
    Done,
    /// Replayed by an earlier run.
    Kept,
    /// It could not be read or written.
    Broken,
}

/// What came of a set of poses.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SetSummary {
    /// Topic of the set.
    pub topic: String,
    /// Message on the topic, from 0, where the set is one.
    pub message: Option<usize>,
    /// How many poses it has.
    pub n: usize,
    /// Why it has no order.
    pub error: Option<String>,
    /// Rows of the set in recovered order.
    pub order: Vec<usize>,
    /// Open or closed.
    pub topology: Option<Topology>,
    /// How far the order may be trusted.
    pub verdict: Option<Verdict>,
    /// How many reasons there are not to trust it.
    pub doubts: usize,
    /// How near it comes to the recorded order, where that was asked for.
    pub score: Option<Score>,
    /// The planned trajectory in figures.
    pub trajectory: Option<TrajectorySummary>,
    /// Why there is no trajectory, or no curve.
    pub refused: Option<String>,
    /// Whether `error` or `refused` says that the input is at fault, and not the robot's abilities or a doubt.
    pub bad_input: bool,
}

/// A planned trajectory in figures.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TrajectorySummary {
    /// Number of its points.
    pub points: usize,
    /// Duration in s.
    pub duration_s: f64,
    /// Peak over limit, the greatest of all joints: velocity, acceleration and jerk.
    pub max_ratio: [f64; 3],
    /// Least distance of any joint to a position limit, in rad (m for prismatic joints).
    pub position_margin: f64,
    /// Greatest distance of the planned tool from a pose, in m.
    pub pose_error_max_m: f64,
    /// The same as an angle, in rad.
    pub pose_error_max_rad: f64,
}

impl TrajectorySummary {
    pub(crate) fn of(plan: &Plan) -> Self {
        let ratio = &plan.audit.max_ratio;
        Self {
            points: plan.trajectory.points.len(),
            duration_s: plan.trajectory.duration_s(),
            max_ratio: [ratio.velocity, ratio.acceleration, ratio.jerk],
            position_margin: plan.audit.position_margin,
            pose_error_max_m: plan.pose_error_max_m,
            pose_error_max_rad: plan.pose_error_max_rad,
        }
    }
}

impl BagSummary {
    /// Nothing came of it, for this reason.
    pub fn broken(bag: String, error: String) -> Self {
        Self { bag, status: Status::Broken, error: Some(error), lost: Vec::new(), output: None, sets: Vec::new() }
    }
}

/// A line for every topic of every bag.
pub fn table(bags: &[BagSummary]) -> String {
    let mut rows = vec![HEADER.map(str::to_owned)];
    for bag in bags {
        if bag.sets.is_empty() {
            let cells = [&bag.bag, "broken", "-", "-", "-", "-", "-", "-", "-", "-"];
            rows.push(cells.map(str::to_owned));
        }
        for sets in bag.sets.chunk_by(|a, b| a.topic == b.topic) {
            rows.push(row(bag, sets));
        }
    }
    let widths: Vec<usize> =
        (0..HEADER.len()).map(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0)).collect();
    rows.iter()
        .map(|row| {
            let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
            cells.join("  ").trim_end().to_owned() + "\n"
        })
        .collect()
}

const HEADER: [&str; 10] =
    ["bag", "status", "topic", "sets", "poses", "verdict", "adjacency", "tau", "differs at", "trajectory"];

fn row(bag: &BagSummary, sets: &[SetSummary]) -> [String; 10] {
    let least = |of: fn(&Score) -> f64| {
        let scores = sets.iter().filter_map(|set| set.score.as_ref()).map(of);
        scores.reduce(f64::min).map_or("-".to_owned(), |least| format!("{least:.4}"))
    };
    let durations: Vec<f64> = sets.iter().filter_map(|set| Some(set.trajectory.as_ref()?.duration_s)).collect();
    let refused = sets.iter().filter(|set| set.refused.is_some()).count();
    let trajectory = match (durations.len(), refused) {
        (0, 0) => "-".to_owned(),
        (0, refused) => format!("{refused} refused"),
        (_, 0) => format!("{:.2} s", durations.iter().sum::<f64>()),
        (_, refused) => format!("{:.2} s, {refused} refused", durations.iter().sum::<f64>()),
    };
    let status = match bag.status {
        Status::Done => "done",
        Status::Kept => "kept",
        Status::Broken => "broken",
    };
    let status = if bag.lost.is_empty() { status.to_owned() } else { format!("{status}, damaged") };
    let poses: usize = sets.iter().map(|set| set.n).sum();
    let topic = sets.first().map_or_else(String::new, |set| set.topic.clone());
    [
        bag.bag.clone(),
        status,
        topic,
        sets.len().to_string(),
        poses.to_string(),
        verdicts(sets),
        least(|score| score.adjacency),
        least(|score| score.kendall_tau),
        first_difference(sets).unwrap_or_else(|| "-".to_owned()),
        trajectory,
    ]
}

/// The rows of the first recorded pair that an order does not follow, and of several sets which one it is.
fn first_difference(sets: &[SetSummary]) -> Option<String> {
    let (set, [a, b]) =
        sets.iter().enumerate().find_map(|(set, of)| Some((set, of.score.as_ref()?.first_difference?)))?;
    Some(if sets.len() > 1 { format!("set {set}: {a}–{b}") } else { format!("{a}–{b}") })
}

fn verdicts(sets: &[SetSummary]) -> String {
    let kinds = [
        ("certified", Some(Verdict::Certified)),
        ("plausible", Some(Verdict::Plausible)),
        ("ambiguous", Some(Verdict::Ambiguous)),
        ("without order", None),
    ];
    let counts = kinds.map(|(name, verdict)| (name, sets.iter().filter(|set| set.verdict == verdict).count()));
    let some: Vec<_> = counts.iter().filter(|(_, count)| *count > 0).collect();
    match some[..] {
        [(name, _)] => (*name).to_owned(),
        _ => some.iter().map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", "),
    }
}
