//! Where the tool should be, and when.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use mujoco_sim::SimError;
use mujoco_sim::planner::pose_bag::read_poses;
use mujoco_sim::planner::se3_geom::Pose;
use serde::Deserialize;

#[derive(Args)]
pub(crate) struct PoseSource {
    /// The poses the trajectory was planned for: CSV, TUM, MCAP file or the folder of a bag
    #[arg(long, value_name = "FILE|BAG")]
    poses: Option<PathBuf>,
    /// Topic of the poses, where the bag has several
    #[arg(long, requires = "poses")]
    topic: Option<String>,
    /// Which PoseArray message of the topic, counted from 0, where there are several
    #[arg(long, value_name = "INDEX", requires = "poses")]
    message: Option<usize>,
    /// The plan's report (JSON), which says when each pose is due
    #[arg(long, value_name = "REPORT.json", requires = "poses")]
    report: Option<PathBuf>,
}

/// The poses a trajectory was planned for.
pub(crate) struct DuePoses {
    /// Frame of the poses; empty where nobody says.
    pub(crate) frame_id: String,
    pub(crate) poses: Vec<Pose>,
    /// When each is due, where a report says so.
    pub(crate) times_s: Option<Vec<f64>>,
}

#[derive(Deserialize)]
struct Report {
    plan: Option<Plan>,
    refusal: Option<String>,
}

#[derive(Deserialize)]
struct Plan {
    pose_times_s: Vec<f64>,
}

impl DuePoses {
    /// None, where no source is given.
    pub(crate) fn read(source: &PoseSource) -> Result<Self, SimError> {
        let Some(poses) = &source.poses else {
            return Ok(Self { frame_id: String::new(), poses: Vec::new(), times_s: None });
        };
        let mut sets = read_poses(poses, source.topic.as_deref())?;
        let index = match source.message {
            Some(index) if index < sets.len() => index,
            None if sets.len() == 1 => 0,
            _ => return Err(SimError::PoseSets { file: poses.display().to_string(), sets: sets.len() }),
        };
        let set = sets.swap_remove(index);
        let report = source.report.as_deref();
        let times_s = report.map(read_times).transpose()?;
        Ok(Self { frame_id: set.frame_id, poses: set.poses, times_s })
    }
}

fn read_times(path: &Path) -> Result<Vec<f64>, SimError> {
    let file = path.display().to_string();
    let text = fs::read_to_string(path).map_err(|source| SimError::Read { file: file.clone(), source, hint: "" })?;
    let no_report = |reason: String| SimError::Report { file: file.clone(), reason };
    let report: Report = serde_json::from_str(&text).map_err(|error| no_report(error.to_string()))?;
    match report {
        Report { plan: Some(plan), .. } => Ok(plan.pose_times_s),
        Report { refusal: Some(refusal), .. } => Err(no_report(format!("planning was refused: {refusal}"))),
        Report { .. } => Err(no_report("it has no key plan.pose_times_s".into())),
    }
}
