//! Goals of the controller's action: what becomes of them, and how they are given up.

use r2r::control_msgs::action::FollowJointTrajectory;
use r2r::std_srvs::srv::Trigger;
use r2r::{ActionClientGoal, ServiceRequest};

use super::Shell;
use crate::diagnostics::{Level, Progress};
use crate::execution::{CONTROLLER_TIMEOUT, End, Event, What};

impl Shell {
    /// Takes up what becomes of a goal; an older one than the last is nobody's business any more.
    pub(crate) fn executed(&mut self, event: Event) {
        if event.goal != self.goal.0 {
            return;
        }
        let progress = self.health.execution.get_or_insert_with(|| Progress::new(""));
        match event.what {
            What::Feedback { error } => {
                progress.feedbacks += 1;
                progress.worst_error = progress.worst_error.max(error);
                return;
            }
            What::Accepted(goal) => {
                *progress = Progress::new("the controller executes the trajectory");
                self.goal.1 = Some(goal);
            }
            What::Overdue => {
                progress.level = Level::Warn;
                progress.message = "the trajectory should have ended, and the controller says nothing of it".into();
            }
            What::NotSent(why) => fail(progress, format!("the trajectory was not sent: {why}")),
            What::Rejected => fail(progress, "the controller rejected the trajectory".into()),
            What::Ended(end) => {
                (self.goal.1, progress.level) = (None, Level::Ok);
                match end {
                    End::Succeeded => progress.message = "the trajectory was executed".into(),
                    End::Canceled => progress.message = "the trajectory was cancelled".into(),
                    End::Aborted(why) => fail(progress, format!("the controller gave the trajectory up: {why}")),
                    End::Lost(why) => fail(progress, format!("how the trajectory ended is not known: {why}")),
                }
            }
        }
        match progress.level {
            Level::Ok => self.log.info(&progress.message),
            Level::Warn => self.log.warn(&progress.message),
            Level::Error | Level::Stale => self.log.error(&progress.message),
        }
        self.report();
    }

    /// Asks the controller to give up the goal under way, and passes its answer on.
    pub(super) fn cancel(&mut self, request: ServiceRequest<Trigger::Service>) {
        match (&self.controller, &self.goal.1) {
            (None, _) => {
                let why = "trajectories are published on a topic (parameter execution), which cannot be taken back";
                self.respond(request, false, why.into());
            }
            (_, None) => self.respond(request, false, "no trajectory is under way".into()),
            (_, Some(goal)) => {
                let (goal, log) = (goal.clone(), self.log.clone());
                tokio::spawn(async move {
                    let (success, message) = match cancelled(&goal).await {
                        Ok(()) => (true, "the controller gives the trajectory up".to_owned()),
                        Err(error) => (false, format!("the controller does not give the trajectory up: {error}")),
                    };
                    if let Err(error) = request.respond(Trigger::Response { success, message }) {
                        log.error(format!("answering a service failed: {error}"));
                    }
                });
            }
        }
    }
}

fn fail(progress: &mut Progress, message: String) {
    (progress.level, progress.message) = (Level::Error, message);
}

/// Asks the controller to give a goal up; why it does not.
pub(super) async fn cancelled(goal: &ActionClientGoal<FollowJointTrajectory::Action>) -> Result<(), String> {
    let answer = goal.cancel().map_err(|error| error.to_string())?;
    let answered = tokio::time::timeout(CONTROLLER_TIMEOUT, answer).await;
    answered.map_err(|_| "it does not answer".to_owned())?.map_err(|error| error.to_string())
}
