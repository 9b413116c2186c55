//! Poses that wait for the transform from their frame to the robot's base.

use std::time::{Duration, Instant};

use planner::Input;
use r2r::geometry_msgs::msg::PoseArray;
use r2r::tf2_msgs::msg::TFMessage;

use crate::frames::Frames;
use crate::message::{frame_name, poses_input, stamp_ns, transform, transformed};

/// All that is known of frames, and the newest poses that wait for more.
#[derive(Default)]
pub(crate) struct Placing {
    frames: Frames,
    waiting: Option<(Instant, PoseArray)>,
    replaced: u64,
}

impl Placing {
    /// Takes transforms up; how many of them are none.
    pub(crate) fn learn(&mut self, message: &TFMessage, fixed: bool) -> usize {
        let mut bad = 0;
        for stamped in &message.transforms {
            match transform(stamped) {
                Some((parent, child, stamp_ns, pose)) => self.frames.insert(parent, child, stamp_ns, pose, fixed),
                None => bad += 1,
            }
        }
        bad
    }

    /// Poses that arrived at a time; they take the place of others that wait.
    pub(crate) fn put(&mut self, at: Instant, message: PoseArray) {
        self.replaced += u64::from(self.waiting.replace((at, message)).is_some());
    }

    /// How many waited in vain, because newer ones came, or all were cleared.
    pub(crate) fn replaced(&self) -> u64 {
        self.replaced
    }

    /// Nothing waits any more.
    pub(crate) fn clear(&mut self) {
        self.replaced += u64::from(self.waiting.take().is_some());
    }

    /// When the waiting poses have waited long enough.
    pub(crate) fn deadline(&self, timeout_s: f64) -> Option<Instant> {
        self.waiting.as_ref().map(|(at, _)| *at + Duration::from_secs_f64(timeout_s))
    }

    /// What the waiting poses come to now: poses in the robot's base frame, or, where nothing is to be hoped for or the time is over, that
    /// their place is not known.
    pub(crate) fn take(&mut self, base: &str, timeout_s: f64) -> Option<Input> {
        let over = self.deadline(timeout_s)? <= Instant::now();
        let (at, message) = self.waiting.take()?;
        let header = &message.header;
        let frame = frame_name(&header.frame_id);
        if frame.is_empty() || frame == base {
            return Some(poses_input(message));
        }
        match self.frames.lookup(base, frame, stamp_ns(&header.stamp)) {
            Ok(base_from_frame) => Some(transformed(&message, base, &base_from_frame)),
            Err(why) if why.may_come() && !over => {
                tracing::debug!(%why, "poses wait");
                self.waiting = Some((at, message));
                None
            }
            Err(why) => Some(Input::Unplaced {
                frame_id: frame.to_owned(),
                stamp_ns: stamp_ns(&header.stamp),
                why: why.to_string(),
            }),
        }
    }
}
