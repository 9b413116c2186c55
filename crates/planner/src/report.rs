//! The report that is published beside a trajectory.

use manipulator::{Audit, PathReport};
use reorder::Ordering;
use serde::Serialize;

use crate::motion::Motion;
use crate::pipeline::Plan;
use crate::refusal::Refusal;

/// The order, and either the plan's audit or the refusal. Serialises to the JSON object of `reorder order` with further keys.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The stamp of the poses that it answers, in ns since the epoch, where they came with one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stamp_ns: Option<i64>,
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

/// A plan in figures. Times count from the start of the trajectory that is published (in ROS its `header.stamp`), which on a hand-over
/// begins with what is left of the motion before.
#[derive(Debug, Clone, Serialize)]
pub struct PlanReport {
    /// Name of the robot.
    pub robot: String,
    /// Duration of the whole published trajectory in s.
    pub duration_s: f64,
    /// When the plan takes over from the motion before; 0 from rest.
    pub takes_over_s: f64,
    /// Duration of the move from there to the first pose in s.
    pub approach_s: f64,
    /// Number of its points.
    pub points: usize,
    /// Greatest distance of the planned tool from an input pose in m.
    pub pose_error_max_m: f64,
    /// Greatest angle of the planned tool to an input pose in rad.
    pub pose_error_max_rad: f64,
    /// When each input pose is passed, by input index, in s.
    pub pose_times_s: Vec<f64>,
    /// The limits, of what was planned: on a hand-over from there on. What is executed before was audited with the plan before.
    pub audit: Audit,
    /// Least manipulability, least singular value and least margin to a position limit along the joint path, with their places along
    /// the recovered order.
    pub path: PathReport,
}

impl Report {
    /// The report of a plan or a refusal, and of the motion that is published for it; without one, of the plan's own trajectory.
    pub fn of(robot: &str, outcome: &Result<Plan, Refusal>, motion: Option<&Motion>) -> Self {
        match outcome {
            Ok(plan) => {
                let takes_over_s = motion.map_or(0.0, |motion| motion.takes_over_s);
                let published = motion.map_or(&plan.trajectory, |motion| &motion.trajectory);
                Self {
                    stamp_ns: None,
                    ordering: Some(plan.ordering.clone()),
                    plan: Some(PlanReport {
                        robot: robot.to_owned(),
                        duration_s: published.duration_s(),
                        takes_over_s,
                        approach_s: plan.approach_s,
                        points: published.points.len(),
                        pose_error_max_m: plan.pose_error_max_m,
                        pose_error_max_rad: plan.pose_error_max_rad,
                        pose_times_s: plan.pose_times_s.iter().map(|time_s| takes_over_s + time_s).collect(),
                        audit: plan.audit,
                        path: plan.path_report.clone(),
                    }),
                    refusal: None,
                }
            }
            Err(refusal) => {
                let (ordering, refusal) = (refusal.ordering().cloned(), Some(refusal.to_string()));
                Self { stamp_ns: None, ordering, plan: None, refusal }
            }
        }
    }

    /// The report as one JSON object.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| format!("{{\"refusal\":\"report: {error}\"}}"))
    }
}
