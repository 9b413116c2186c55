//! When health is told of, and from what.

use super::Shell;
use crate::diagnostics::{Level, Situation, Status};
use crate::message::diagnostics_message;
use crate::stamps::Stamps;

impl Shell {
    /// Tells at once when something begins or ceases to be wrong; otherwise the next periodic report does.
    pub(super) fn report_if_changed(&mut self) {
        if worst(&self.health.statuses(&self.situation())) != self.told {
            self.report();
        }
    }

    /// Publishes the state of health.
    pub(crate) fn report(&mut self) {
        let situation = self.situation();
        let statuses = self.health.statuses(&situation);
        let (told, lost) = (worst(&statuses), situation.lost());
        let message = diagnostics_message(statuses, &self.session.robot().name, Stamps::now_ns());
        let published = self.publishers.tell(&message);
        self.check("publishing diagnostics", published);
        self.told = told;
        self.health.told_of(lost);
    }

    fn situation(&self) -> Situation<'_> {
        let (robot, config) = (self.session.robot(), &self.parameters.config);
        Situation {
            node: self.name.trim_start_matches('/'),
            robot: &robot.name,
            joints: robot.chain.dof(),
            state: self.life.state().1,
            joint_state_age_s: self.session.joint_state_age_s(self.stamps.now_s()),
            joint_state_max_age_s: config.joint_state_max_age_s,
            joint_state_required: config.require_joint_state,
            counters: self.session.counters(),
            replaced: self.placing.replaced(),
            odd_poses: self.odd_poses,
            collected: self.collecting.len(),
            poses_dropped: self.services.poses.dropped() + self.services.single_poses.dropped(),
            joint_states_dropped: self.services.joint_states.dropped(),
        }
    }
}

fn worst(statuses: &[Status]) -> Level {
    statuses.iter().map(|status| status.level).max().unwrap_or(Level::Ok)
}
