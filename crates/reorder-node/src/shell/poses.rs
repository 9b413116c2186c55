//! Poses before the session sees them: sets that are not complete, frames that are not known yet.

use std::time::Instant;

use r2r::geometry_msgs::msg::{PoseArray, PoseStamped};

use super::Shell;
use crate::collecting::Taken;

impl Shell {
    /// When something that waits has waited long enough.
    pub(crate) fn deadline(&self) -> Option<Instant> {
        let transform = self.placing.deadline(self.parameters.transform_timeout_s);
        let quiet = self.collecting.deadline(self.parameters.quiet_s);
        transform.into_iter().chain(quiet).min()
    }

    /// Looks after what waits.
    pub(crate) fn tend(&mut self) {
        if self.collecting.deadline(self.parameters.quiet_s).is_some_and(|deadline| deadline <= Instant::now()) {
            self.finish_collecting();
        }
        self.place();
    }

    /// Takes one pose of a set.
    pub(super) fn collect(&mut self, at: Instant, message: PoseStamped) {
        let frame = message.header.frame_id.clone();
        match self.collecting.take(at, message) {
            // A source that never falls quiet would fill the memory: the set is refused as too large, and the next begins.
            Taken::Added if self.collecting.len() > self.parameters.config.max_poses => self.finish_collecting(),
            Taken::Added => {}
            Taken::Repeated => self.odd_poses.repeated += 1,
            Taken::Corrected => self.odd_poses.corrected += 1,
            Taken::OtherFrame => {
                self.odd_poses.refused += 1;
                self.log.warn(format!("a pose in frame {frame:?} is ignored: those before it are in another"));
            }
        }
    }

    /// The poses so far are all: they are asked for.
    pub(super) fn finish_collecting(&mut self) {
        if let Some((at, message)) = self.collecting.finish() {
            self.ask(at, message);
        }
    }

    /// A motion through these poses is wanted.
    pub(super) fn ask(&mut self, at: Instant, message: PoseArray) {
        self.asked = Some(at);
        self.placing.put(at, message);
        self.place();
    }

    /// Hands poses on whose place has become known, or will not any more.
    pub(super) fn place(&mut self) {
        let base = &self.session.robot().base_frame;
        if let Some(input) = self.placing.take(base, self.parameters.transform_timeout_s) {
            self.handle(input, None);
        }
    }

    pub(super) fn forget_waiting(&mut self) {
        self.placing.clear();
        self.collecting.finish();
    }
}
