//! The report that is published beside a trajectory.

use manipulator::{Audit, PathReport};
use reorder::Ordering;
use serde::Serialize;

use crate::pipeline::Plan;
use crate::refusal::Refusal;

/// The order, and either the plan's audit or the refusal. Serialises to the JSON object of `reorder order` with further keys.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The order, where there is one.
    #[serde(flatten)]
    pub ordering: Option<Ordering>,
    /// The plan in figures, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<PlanReport>,
    /// One sentence, where there is no plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refusal: Option<String>,
}

/// A plan in figures.
#[derive(Debug, Clone, Serialize)]
pub struct PlanReport {
    /// Name of the robot.
    pub robot: String,
    /// Duration of the whole trajectory in s.
    pub duration_s: f64,
    /// Duration of the move to the first pose in s.
    pub approach_s: f64,
    /// Number of trajectory points.
    pub points: usize,
    /// Greatest distance of the planned tool from an input pose in m.
    pub pose_error_max_m: f64,
    /// Greatest angle of the planned tool to an input pose in rad.
    pub pose_error_max_rad: f64,
    /// When each input pose is passed, by input index, in s.
    pub pose_times_s: Vec<f64>,
    /// The limits.
    pub audit: Audit,
    /// Least manipulability, least singular value and least margin to a position limit along the joint path, with their places along
    /// the recovered order.
    pub path: PathReport,
}

impl Report {
    /// The report of an outcome.
    pub fn of(robot: &str, outcome: &Result<Plan, Refusal>) -> Self {
        match outcome {
            Ok(plan) => Self {
                ordering: Some(plan.ordering.clone()),
                plan: Some(PlanReport {
                    robot: robot.to_owned(),
                    duration_s: plan.trajectory.duration_s(),
                    approach_s: plan.approach_s,
                    points: plan.trajectory.points.len(),
                    pose_error_max_m: plan.pose_error_max_m,
                    pose_error_max_rad: plan.pose_error_max_rad,
                    pose_times_s: plan.pose_times_s.clone(),
                    audit: plan.audit,
                    path: plan.path_report.clone(),
                }),
                refusal: None,
            },
            Err(refusal) => {
                Self { ordering: refusal.ordering().cloned(), plan: None, refusal: Some(refusal.to_string()) }
            }
        }
    }

    /// The report as one JSON object.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| format!("{{\"refusal\":\"report: {error}\"}}"))
    }
}
