//! One bag: its sets put in order, and the bag that is made of them.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use planner::pose_bag::msg::{
    Header, JointState, MarkerArray, Path as PathMessage, PoseArray, PoseStamped, Text, Time,
};
use planner::pose_bag::{BagError, BagReader, BagWriter, Compression, OfferedQos, PoseSet, msg, recover_poses};
use planner::reorder::{Ordering, order_weighted};
use planner::se3_geom::{Pose, Se3};
use planner::{Config, Drawn, Plan, Request, interpolate, path_along, plan, trajectory_message};
use serde::{Deserialize, Serialize};

use crate::inputs::{Input, InputFile};
use crate::score::Score;
use crate::summary::{BagSummary, SetSummary, Status, TrajectorySummary};
use crate::task::Task;

/// The topic on which an output says what it was made of and how.
const REPORT: &str = "/reorder/report";

/// What the header of every output says.
pub(crate) const LIBRARY: &str = "reorder replay";

/// What an output holds about itself.
#[derive(Serialize, Deserialize)]
struct Report {
    settings: String,
    /// Whether something was lost by an accident, a full disk or a share that was gone, so that another run may find it.
    may_pass: bool,
    input: Vec<InputFile>,
    summary: BagSummary,
}

/// A set in order, with what came of it.
struct Replayed {
    set: PoseSet,
    summary: SetSummary,
    ordering: Option<Ordering>,
    curve: Vec<Pose>,
    plan: Option<Plan>,
}

/// Replays a bag into `output`; one that an earlier run made of the same bag in the same way is left as it is. `advance` is told
/// which part of the work is done, from 0 to 1.
pub fn replay(input: &Input, output: Option<&Path>, task: &Task, advance: &dyn Fn(f64)) -> BagSummary {
    if let Some(kept) = output.and_then(|output| earlier(input, output, task)) {
        return kept;
    }
    let name = input.path.display().to_string();
    caught(&name, || replay_anew(input, output, task, advance)).unwrap_or_else(|error| BagSummary::broken(name, error))
}

/// A fault of ours ends the bag that it meets, not the others of a run.
fn caught<T>(name: &str, work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    let fault = || format!("{name}: the replay ended in an internal error, which is a bug: please report it");
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err(fault()))
}

/// What an earlier run found, where its output is whole and would be the same again.
fn earlier(input: &Input, output: &Path, task: &Task) -> Option<BagSummary> {
    let mut report: Option<Report> = None;
    let losses = BagReader::open(output).ok()?.for_each(&mut |message| {
        if message.topic() == REPORT {
            report = serde_json::from_str(&message.decode::<Text>()?.data).ok();
        }
        Ok(())
    });
    let report = report.filter(|_| losses.is_ok_and(|losses| losses.is_empty()))?;
    let is_same = report.settings == task.settings() && report.input == input.files && !report.may_pass;
    is_same.then(|| BagSummary {
        bag: input.path.display().to_string(),
        output: Some(output.display().to_string()),
        status: Status::Kept,
        ..report.summary
    })
}

fn replay_anew(input: &Input, output: Option<&Path>, task: &Task, advance: &dyn Fn(f64)) -> Result<BagSummary, String> {
    let mut lost: Vec<String> = Vec::new();
    let (mut sets, mut may_pass) = (Vec::new(), false);
    for selection in task.selections() {
        let (found, losses) = recover_poses(&input.path, &selection).map_err(|error| error.to_string())?;
        sets.extend(found);
        may_pass |= losses.iter().any(BagError::may_pass);
        // Every pass over a bag meets the same damage, but not the same accidents.
        for loss in losses.iter().map(ToString::to_string) {
            if !lost.contains(&loss) {
                lost.push(loss);
            }
        }
    }
    let count = sets.len() as f64;
    let replayed: Vec<Replayed> = (1..)
        .zip(sets)
        .map(|(done, set)| {
            let replayed = replay_set(set, task);
            advance(f64::from(done) / count);
            replayed
        })
        .collect();
    let summary = BagSummary {
        bag: input.path.display().to_string(),
        status: Status::Done,
        error: None,
        lost,
        output: output.map(|output| output.display().to_string()),
        sets: replayed.iter().map(|replayed| replayed.summary.clone()).collect(),
    };
    if let Some(output) = output {
        let report =
            Report { settings: task.settings(), may_pass, input: input.files.clone(), summary: summary.clone() };
        write(output, task, &replayed, &report).map_err(|error| error.to_string())?;
    }
    Ok(summary)
}

fn replay_set(set: PoseSet, task: &Task) -> Replayed {
    let mut summary = SetSummary {
        topic: set.origin.topic.clone().unwrap_or_default(),
        message: set.origin.message,
        n: set.poses.len(),
        error: None,
        order: Vec::new(),
        topology: None,
        verdict: None,
        doubts: 0,
        score: None,
        trajectory: None,
        refused: None,
        bad_input: false,
    };
    // Stamps play no part in it.
    let ordering = match order_weighted::<Se3>(&set.poses, task.weight, &task.options()) {
        Ok(ordering) => ordering,
        Err(error) => {
            summary.error = Some(error.to_string());
            summary.bad_input = true;
            return Replayed { set, summary, ordering: None, curve: Vec::new(), plan: None };
        }
    };
    summary.order.clone_from(&ordering.order);
    summary.topology = Some(ordering.topology);
    summary.verdict = Some(ordering.verdict);
    summary.doubts = ordering.doubts.len();
    summary.score = task.score.then(|| Score::of(&set.poses, set.stamps_ns.as_deref(), &ordering));
    let metres_per_radian = ordering.metres_per_radian.unwrap_or(Config::default().metres_per_radian);
    let plan = task.robot.as_ref().map(|robot| {
        let config = Config {
            metres_per_radian,
            topology: task.topology,
            minimum_verdict: task.minimum_verdict,
            ..Config::default()
        };
        let request = Request { frame_id: set.frame_id.clone(), poses: set.poses.clone(), ..Request::default() };
        plan(robot, &config, &request)
    });
    let (plan, curve) = match plan {
        Some(Ok(plan)) => {
            summary.trajectory = Some(TrajectorySummary::of(&plan));
            let curve = plan.path();
            (Some(plan), Ok(curve))
        }
        Some(Err(refusal)) => {
            summary.refused = Some(refusal.to_string());
            summary.bad_input = refusal.is_bad_input();
            (None, interpolate(&set.poses, &ordering, metres_per_radian).map(|spline| path_along(&spline)))
        }
        None => (None, interpolate(&set.poses, &ordering, metres_per_radian).map(|spline| path_along(&spline))),
    };
    let curve = curve.unwrap_or_else(|refusal| {
        summary.refused.get_or_insert(refusal.to_string());
        ordering.distinct().iter().map(|&row| set.poses[row]).collect()
    });
    Replayed { set, summary, ordering: Some(ordering), curve, plan }
}

fn write(output: &Path, task: &Task, replayed: &[Replayed], report: &Report) -> Result<(), BagError> {
    let mut bag = BagWriter::create_by(output, Compression::Zstd, Some(LIBRARY))?;
    let selections = task.selections().len();
    // Until when the arm moves, by topic.
    let mut moves_until_ns = BTreeMap::<&str, u64>::new();
    for one in replayed {
        // Several topics must not mingle; one has the names that the node gives.
        let of = if selections > 1 { one.summary.topic.as_str() } else { "" };
        let until_ns = moves_until_ns.entry(of).or_default();
        *until_ns = write_set(&mut bag, of, one, *until_ns)?;
    }
    let end_ns = moves_until_ns.into_values().max().unwrap_or_default();
    let data = serde_json::to_string(report).unwrap_or_default();
    bag.add_topic::<Text>(REPORT, OfferedQos::TransientLocal)?;
    bag.write(REPORT, end_ns, &Text { data })?;
    bag.finish()
}

/// The arm moves when the motion before is over, from `free_ns` on: one arm cannot play two trajectories at a time. Returns the time of the
/// last message, or `free_ns` where that is later.
fn write_set(bag: &mut BagWriter, of: &str, one: &Replayed, free_ns: u64) -> Result<u64, BagError> {
    let start_ns = one.set.log_time_ns;
    let begins_ns = start_ns.max(free_ns);
    let Some(ordering) = &one.ordering else { return Ok(begins_ns) };
    let header = |at_ns: u64| msg::Header {
        stamp: i64::try_from(at_ns).ok().and_then(Time::from_nanos).unwrap_or_default(),
        frame_id: one.set.frame_id.clone(),
    };
    let ordered = ordering.distinct().iter().map(|&row| (&one.set.poses[row]).into()).collect();
    let curve = one.curve.iter().map(|pose| PoseStamped { header: header(start_ns), pose: pose.into() }).collect();
    let topic = |name: &str| format!("/reorder{of}/{name}");
    bag.add_topic::<PoseArray>(&topic("ordered_poses"), OfferedQos::TransientLocal)?;
    bag.add_topic::<PathMessage>(&topic("path"), OfferedQos::TransientLocal)?;
    bag.add_topic::<MarkerArray>(&topic("markers"), OfferedQos::TransientLocal)?;
    bag.write(&topic("ordered_poses"), start_ns, &PoseArray { header: header(start_ns), poses: ordered })?;
    bag.write(&topic("path"), start_ns, &PathMessage { header: header(start_ns), poses: curve })?;
    let drawn = Drawn { poses: &one.set.poses, ordering: Some(ordering), curve: &one.curve, refusal: None };
    bag.write(&topic("markers"), start_ns, &drawn.markers(&header(start_ns)))?;
    let Some(plan) = &one.plan else { return Ok(begins_ns) };
    let joint_topic = |name: &str| format!("/{name}{of}");
    let stamped = |at_ns| Header { frame_id: String::new(), ..header(at_ns) };
    bag.write(&joint_topic("joint_trajectory"), begins_ns, &trajectory_message(&plan.trajectory, stamped(begins_ns)))?;
    let mut end_ns = begins_ns;
    for point in &plan.trajectory.points {
        end_ns = begins_ns.saturating_add((point.time_s * 1e9).round() as u64);
        let state = JointState {
            header: stamped(end_ns),
            name: plan.trajectory.joint_names.clone(),
            position: point.positions.clone(),
            velocity: point.velocities.clone(),
            effort: Vec::new(),
        };
        bag.write(&joint_topic("joint_states"), end_ns, &state)?;
    }
    Ok(end_ns)
}

#[cfg(test)]
mod tests {
    use super::caught;

    #[test]
    fn a_panic_is_an_error_of_the_bag() {
        assert_eq!(caught("x.mcap", || Ok(1)), Ok(1));
        assert_eq!(caught::<u8>("x.mcap", || Err("no bag".to_owned())), Err("no bag".to_owned()));
        let index = std::hint::black_box(3);
        assert!(caught("x.mcap", || Ok([1, 2][index])).unwrap_err().starts_with("x.mcap: the replay ended"));
    }
}
