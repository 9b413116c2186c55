//! The motion that the robot was last told to make, and how another takes over from it.

use std::sync::Arc;

use manipulator::{JointPoint, JointTrajectory, ManipulatorError, Robot, TimingOptions, slow_to_stop};

/// How long a trajectory may take to reach the controller, in s: what takes over earlier than that would come too late.
pub(crate) const PUBLISHING_S: f64 = 0.05;

/// A trajectory and when it is executed.
///
/// One that takes over from another begins with what is left of that one until the hand-over, and so in the past: a ROS 2
/// `joint_trajectory_controller` forgets the old trajectory when the new one arrives, and would connect the state it is in with a
/// first point in the future by a quintic of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// What is executed.
    pub trajectory: Arc<JointTrajectory>,
    /// When its time is 0, in s on the clock of [`Session::handle`](crate::Session::handle); a whole number of nanoseconds.
    pub starts_at_s: f64,
    /// When what was planned begins, in s from the trajectory's start: there it takes over from the motion before. 0 from rest.
    pub takes_over_s: f64,
}

/// Where a new trajectory takes over from a running one.
#[derive(Debug, Clone, PartialEq)]
pub struct Handover {
    /// What the robot executes until then.
    pub trajectory: Arc<JointTrajectory>,
    /// Time of the hand-over, in s from the running trajectory's start.
    pub at_s: f64,
}

impl Handover {
    /// Position, velocity and acceleration that the new trajectory begins with.
    pub fn state(&self) -> JointPoint {
        self.trajectory.state_at(self.at_s)
    }

    /// Whether the robot rests by then.
    pub fn is_at_rest(&self) -> bool {
        self.at_s >= self.trajectory.duration_s()
    }
}

impl Motion {
    /// The motion along a trajectory from rest, from `now_s` on.
    pub(crate) fn from_rest(trajectory: JointTrajectory, now_s: f64) -> Self {
        Self { trajectory: Arc::new(trajectory), starts_at_s: (now_s * 1e9).round() * 1e-9, takes_over_s: 0.0 }
    }

    pub(crate) fn ends_at_s(&self) -> f64 {
        self.starts_at_s + self.trajectory.duration_s()
    }

    /// The hand-over at the first point that is reached no earlier than `at_s`; at the end where there is none.
    pub(crate) fn handover(&self, at_s: f64) -> Handover {
        let points = &self.trajectory.points;
        let next = points.iter().find(|point| self.starts_at_s + point.time_s >= at_s).or(points.last());
        Handover { trajectory: Arc::clone(&self.trajectory), at_s: next.map_or(0.0, |point| point.time_s) }
    }

    /// What is published at `now_s` so that `next` takes over at `at_s` of this motion's trajectory.
    pub(crate) fn taken_over(&self, now_s: f64, at_s: f64, next: &JointTrajectory) -> Self {
        let passed = |point: &&JointPoint| point.time_s <= at_s && self.starts_at_s + point.time_s <= now_s;
        let from_s = self.trajectory.points.iter().rfind(passed).map_or(0.0, |point| point.time_s);
        // Both are times of points, whole nanoseconds; so is their difference but for rounding.
        let takes_over_s = ((at_s - from_s) * 1e9).round() * 1e-9;
        let trajectory = self.trajectory.after(from_s).switched(takes_over_s, next);
        Self { trajectory: Arc::new(trajectory), starts_at_s: self.starts_at_s + from_s, takes_over_s }
    }

    /// The smooth stop of this motion, as soon as a controller can hear of it. `None` where it ends as soon by itself.
    pub(crate) fn stopped(
        &self,
        robot: &Robot,
        now_s: f64,
        timing: &TimingOptions,
    ) -> Result<Option<Self>, ManipulatorError> {
        let handover = self.handover(now_s + PUBLISHING_S);
        if handover.is_at_rest() {
            return Ok(None);
        }
        let stop = slow_to_stop(robot, &self.trajectory, handover.at_s, timing)?;
        Ok(Some(self.taken_over(now_s, handover.at_s, &stop)))
    }
}
