//! Why there is no trajectory.

use manipulator::{Audit, AuditRules, ManipulatorError};
use reorder::{OrderError, Ordering, Verdict};
use se3_geom::{InvalidPose, SplineError};

/// A named refusal. Poses are named by their 0-based index in the input, not in the recovered order.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// A setting is wrong.
    #[error("configuration: {0}")]
    Config(String),
    /// Poses in a frame that is not the robot's base.
    #[error("the poses are in frame '{given}', but the robot's base frame is '{base}'")]
    Frame {
        /// Frame of the message or file.
        given: String,
        /// Base frame of the robot.
        base: String,
    },
    /// Poses in a frame whose place to the robot's base is not known.
    #[error("the poses are in frame '{given}', and where the robot's base frame '{base}' is in it is not known: {why}")]
    Unplaced {
        /// Frame of the message.
        given: String,
        /// Base frame of the robot.
        base: String,
        /// What is missing.
        why: String,
    },
    /// A number that is no pose.
    #[error("pose {input_pose}: {reason}")]
    InvalidPose {
        /// Which.
        input_pose: usize,
        /// What is wrong with it.
        reason: InvalidPose,
    },
    /// More poses than are planned at a time.
    #[error("{given} poses are more than the {allowed} that are planned at a time (max_poses)")]
    TooManyPoses {
        /// How many came.
        given: usize,
        /// How many the configuration allows.
        allowed: usize,
    },
    /// The start state does not fit the robot.
    #[error("{0}")]
    StartState(ManipulatorError),
    /// Nothing says where the robot stands.
    #[error("no joint state with all joints of {robot} has arrived: where the robot stands is unknown")]
    NoJointState {
        /// Name of the robot.
        robot: String,
    },
    /// The planner itself failed.
    #[error("the planner failed: {0}; please report this")]
    Internal(String),
    /// The robot was not heard of for too long.
    #[error(
        "the last joint state is {age_s:.1} s old, more than the {allowed_s} s allowed: where the robot stands is unknown"
    )]
    StaleJointState {
        /// Age in s.
        age_s: f64,
        /// What the configuration allows, in s.
        allowed_s: f64,
    },
    /// The robot moves; a trajectory from rest would begin with a jump.
    #[error("{joint} is moving at {velocity:.3} rad/s (or m/s): plan again when the robot stands")]
    Moving {
        /// Name of the joint.
        joint: String,
        /// Its velocity in rad/s or m/s.
        velocity: f64,
    },
    /// The robot does not execute the trajectory from which the new one was to take over.
    #[error(
        "{joint} is {by:.4} rad (or m) off the trajectory under execution, more than the tolerance of {tolerance}: nothing can take over from it"
    )]
    OffTrajectory {
        /// Name of the joint.
        joint: String,
        /// How far off, in rad or m.
        by: f64,
        /// What the configuration allows, in rad or m.
        tolerance: f64,
    },
    /// The robot left the place from which its trajectory was planned.
    #[error("{joint} moved by {by:.4} rad (or m) while the trajectory was planned: plan again when the robot stands")]
    MovedMeanwhile {
        /// Name of the joint.
        joint: String,
        /// How far, in rad or m.
        by: f64,
    },
    /// The poses admit no order at all.
    #[error("ordering: {0}")]
    Order(#[from] OrderError),
    /// The order is not certain enough to be executed.
    #[error("the order is only {verdict:?}, and {minimum:?} is required: {doubts}")]
    Verdict {
        /// What the order is.
        verdict: Verdict,
        /// What the configuration asks for.
        minimum: Verdict,
        /// The first doubts in words.
        doubts: String,
        /// The order with all its doubts.
        ordering: Box<Ordering>,
    },
    /// No C² curve leads through the ordered poses.
    #[error("interpolation: {source} (counted along the recovered order; input poses {near:?})")]
    Spline {
        /// What went wrong, with places along the order.
        source: SplineError,
        /// Input indices of the poses concerned.
        near: Vec<usize>,
    },
    /// The arm cannot follow the curve, or not within its limits.
    #[error("{robot}: {source}{}", in_the_input(input_poses))]
    Manipulator {
        /// Name of the robot.
        robot: String,
        /// What went wrong, with places along the order.
        source: Box<ManipulatorError>,
        /// Input indices of the poses concerned, in the order in which `source` counts them.
        input_poses: Vec<usize>,
    },
    /// The robot stands elsewhere than the trajectory begins, and may not be led there.
    #[error("{joint} stands {away:.4} rad (or m) from the first pose, and approach is off")]
    NotAtFirstPose {
        /// Name of the joint.
        joint: String,
        /// How far it would have to jump, in rad or m.
        away: f64,
    },
    /// The planned tool path misses a pose by more than the tolerance.
    #[error(
        "the planned path passes input pose {input_pose} at {error_m:.2e} m and {error_rad:.2e} rad, more than the tolerance"
    )]
    Accuracy {
        /// Which pose.
        input_pose: usize,
        /// Distance of the tool's origin in m.
        error_m: f64,
        /// Angle between the orientations in rad.
        error_rad: f64,
    },
    /// Between the published points the executed tool leaves the path by more than the tolerance.
    #[error(
        "between points at {rate_hz} a second the executed tool would leave the path by {error_m:.2e} m and {error_rad:.2e} rad, more than the tolerance: raise rate_hz or the tolerance"
    )]
    Strays {
        /// In m.
        error_m: f64,
        /// In rad.
        error_rad: f64,
        /// Published points per second.
        rate_hz: f64,
    },
    /// The whole trajectory, approach included, does not pass its audit; it is withheld.
    #[error("the trajectory does not pass its audit and is withheld: {}", audit.faults(rules))]
    Limits {
        /// What was found of it.
        audit: Box<Audit>,
        /// What it was to keep.
        rules: AuditRules,
    },
}

/// Poses that are spelled out.
const SHOWN_POSES: usize = 12;

/// Which rows of the input a sentence speaks of that counts poses along the curve.
fn in_the_input(poses: &[usize]) -> String {
    let shown: Vec<_> = poses.iter().take(SHOWN_POSES).map(ToString::to_string).collect();
    let more = if poses.len() > SHOWN_POSES { ", …" } else { "" };
    match &shown[..] {
        [] => String::new(),
        [pose] => format!(" (input pose {pose})"),
        _ => format!(" (counted along the recovered order; input poses {}{more})", shown.join(", ")),
    }
}

impl Refusal {
    /// Whether the input is at fault (exit code 2) rather than the robot's abilities or a doubt (exit code 1).
    pub fn is_bad_input(&self) -> bool {
        matches!(
            self,
            Self::Config(_)
                | Self::Frame { .. }
                | Self::Unplaced { .. }
                | Self::InvalidPose { .. }
                | Self::TooManyPoses { .. }
                | Self::StartState(_)
                | Self::Order(_)
        )
    }

    /// The order, where it was found before the refusal.
    pub fn ordering(&self) -> Option<&Ordering> {
        match self {
            Self::Verdict { ordering, .. } => Some(ordering),
            _ => None,
        }
    }
}
