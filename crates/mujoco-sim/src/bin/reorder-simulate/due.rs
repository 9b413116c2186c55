//! Where the tool should be, and when.

use std::fs;
use std::path::Path;

use mujoco_sim::SimError;
use mujoco_sim::planner::pose_bag::read_poses;
use mujoco_sim::planner::se3_geom::Pose;
use serde::Deserialize;

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
    pub(crate) fn none() -> Self {
        Self { frame_id: String::new(), poses: Vec::new(), times_s: None }
    }

    pub(crate) fn read(poses: &Path, topic: Option<&str>, report: Option<&Path>) -> Result<Self, SimError> {
        let mut sets = read_poses(poses, topic)?;
        if sets.len() != 1 {
            let (file, reason) = (poses.display(), format!("it holds {} sets of poses instead of one", sets.len()));
            return Err(SimError::Report { file: file.to_string(), reason });
        }
        let set = sets.swap_remove(0);
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
