//! What a user may choose.

use manipulator::{PathOptions, TimingOptions};
use reorder::{Options, TopologyChoice, Verdict};
use serde::Deserialize;

use crate::refusal::Refusal;

/// Everything that shapes a plan, with defaults for each. Unknown keys are refused by name.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// A [`Session`](crate::Session) refuses more poses than this at a time, so that an answer does not take hours.
    pub max_poses: usize,
    /// How many metres count as much as one radian when poses are compared. Changes the order, so it is reported.
    pub metres_per_radian: f64,
    /// Whether the curve is open or closed, or to be decided from the poses.
    pub topology: TopologyChoice,
    /// Input index at which an open curve starts; overrides nearness to the robot's present pose.
    pub start: Option<usize>,
    /// An order below this verdict is refused rather than executed.
    pub minimum_verdict: Verdict,
    /// Whether a trajectory may begin with a straight joint move from the present state to the first pose.
    pub approach: bool,
    /// Whether a [`Session`](crate::Session) plans only when it knows where the robot stands. Otherwise a trajectory begins at the
    /// first pose, wherever the robot is.
    pub require_joint_state: bool,
    /// A joint state older than this, in s, no longer says where the robot stands.
    pub joint_state_max_age_s: f64,
    /// Whether new trajectories take over from one that is being executed, and refusals may stop it. The controller must heed the
    /// stamps of what it is sent, by the same clock; where this is off, a robot under way is refused.
    pub handover: bool,
    /// How far ahead, in s, a trajectory for new poses takes over from the one that is being executed. Planning that takes longer is
    /// done again with a longer lead.
    pub handover_lead_s: f64,
    /// How far a measured joint may be from where the trajectory under execution has it, in rad (or m). Farther away, the robot does
    /// not execute it.
    pub handover_tolerance_rad: f64,
    /// What becomes of the trajectory under execution when what is asked for next is refused.
    pub on_refusal: OnRefusal,
    /// Accuracy of the joint path.
    pub path: PathOptions,
    /// Publishing rate and scaling of limits.
    pub timing: TimingOptions,
}

/// What a robot under way does when new poses are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OnRefusal {
    /// Stop on the planned path as soon as the limits allow. New poses mean that the old ones are no longer wanted, also when
    /// nothing can be done with the new ones.
    Stop,
    /// Go on to the end of the present trajectory.
    Continue,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            max_poses: 10_000,
            metres_per_radian: 0.1,
            topology: TopologyChoice::Auto,
            start: None,
            minimum_verdict: Verdict::Plausible,
            approach: true,
            require_joint_state: true,
            joint_state_max_age_s: 1.0,
            handover: false,
            handover_lead_s: 1.0,
            handover_tolerance_rad: 0.05,
            on_refusal: OnRefusal::Stop,
            path: PathOptions::default(),
            timing: TimingOptions::default(),
        }
    }
}

impl Config {
    /// Reads YAML text; keys that are absent keep their defaults.
    ///
    /// # Errors
    /// [`Refusal::Config`] with the key and what is wrong with it.
    pub fn from_yaml(text: &str) -> Result<Self, Refusal> {
        let config: Self = serde_yaml::from_str(text).map_err(|e| Refusal::Config(e.to_string()))?;
        config.check()?;
        Ok(config)
    }

    /// Whether every value is in its range.
    ///
    /// # Errors
    /// [`Refusal::Config`] with the key and what is wrong with it.
    pub fn check(&self) -> Result<(), Refusal> {
        let length_m = self.metres_per_radian;
        if !(length_m > 0.0 && length_m.is_finite()) {
            return Err(Refusal::Config(format!("metres_per_radian must be a positive number, not {length_m}")));
        }
        let positive = [
            ("joint_state_max_age_s", self.joint_state_max_age_s),
            ("handover_lead_s", self.handover_lead_s),
            ("handover_tolerance_rad", self.handover_tolerance_rad),
        ];
        if let Some((name, value)) = positive.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0) {
            return Err(Refusal::Config(format!("{name} must be a positive number, not {value}")));
        }
        let of_robot = |error: manipulator::ManipulatorError| Refusal::Config(error.to_string());
        self.path.check().map_err(of_robot)?;
        self.timing.check().map_err(of_robot)
    }

    pub(crate) fn ordering(&self) -> Options {
        Options { topology: self.topology, start: self.start, ..Options::default() }
    }
}
