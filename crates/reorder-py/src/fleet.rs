//! The engine of `reorder replay`, a bag at a time, for workers anywhere.

use std::path::PathBuf;

use bag_replay::planner::pose_bag;
use bag_replay::planner::reorder::{TopologyChoice, Verdict};
use bag_replay::{BagSummary, Input, Task, find, load_robot, outputs, replay, table};
use pyo3::prelude::*;

use crate::bags::grouping;
use crate::choice::{WeightChoice, choice};
use crate::error::{BagError, ReorderError, raised};

/// Keywords of a task, as Python hands them on.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings {
    topics: Vec<String>,
    frames: Option<(String, String)>,
    window_s: Option<f64>,
    gap_s: Option<f64>,
    topology: String,
    metres_per_radian: WeightChoice,
    score: bool,
    robot: Option<String>,
    limits: Option<PathBuf>,
    minimum_verdict: String,
}

impl Settings {
    fn task(self) -> PyResult<Task> {
        let robot = self.robot.as_deref().map(|name| load_robot(name, self.limits.as_deref()));
        Ok(Task {
            topics: self.topics,
            frames: self.frames,
            grouping: grouping(self.window_s, self.gap_s)?,
            topology: choice::<TopologyChoice>("topology", &self.topology)?,
            weight: self.metres_per_radian.weight()?,
            score: self.score,
            robot: robot.transpose().map_err(raised::<ReorderError>)?,
            minimum_verdict: choice::<Verdict>("minimum_verdict", &self.minimum_verdict)?,
        })
    }
}

/// Refuses what no bag can be replayed by.
#[pyfunction]
pub(crate) fn check_task(settings: Settings) -> PyResult<()> {
    settings.task().map(drop)
}

/// Path, name and size of every bag.
#[pyfunction]
pub(crate) fn find_bags(paths: Vec<PathBuf>) -> PyResult<Vec<(PathBuf, String, u64)>> {
    let found = find(&paths).map_err(raised::<BagError>)?;
    Ok(found.into_iter().map(|input| (input.path.clone(), input.name.clone(), input.bytes())).collect())
}

/// The output of every bag, in the order of [`find_bags`].
#[pyfunction]
pub(crate) fn bag_outputs(paths: Vec<PathBuf>, output: PathBuf) -> PyResult<Vec<PathBuf>> {
    let inputs = find(&paths).map_err(raised::<BagError>)?;
    outputs(&paths, &inputs, &output).map_err(raised::<BagError>)
}

/// Removes what workers that were killed left half written.
#[pyfunction]
pub(crate) fn remove_abandoned(folder: PathBuf) -> PyResult<()> {
    pose_bag::remove_abandoned(folder).map_err(raised::<BagError>)
}

/// Replays a bag, and returns its summary as JSON.
#[pyfunction]
pub(crate) fn replay_bag(
    py: Python<'_>,
    path: PathBuf,
    name: String,
    output: Option<PathBuf>,
    settings: Settings,
) -> PyResult<String> {
    let task = settings.task()?;
    py.detach(|| {
        let summary = replay(&Input::new(path, name), output.as_deref(), &task, &|_| ());
        serde_json::to_string(&summary).map_err(raised::<ReorderError>)
    })
}

/// The table of `reorder replay`, from summaries in JSON.
#[pyfunction]
pub(crate) fn replay_table(summaries: Vec<String>) -> PyResult<String> {
    let read = |text: &String| serde_json::from_str::<BagSummary>(text).map_err(raised::<ReorderError>);
    Ok(table(&summaries.iter().map(read).collect::<PyResult<Vec<_>>>()?))
}
