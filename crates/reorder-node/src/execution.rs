//! Trajectories to a controller as goals of its `FollowJointTrajectory` action: accepted or not, feedback, cancel, result.

use std::time::{Duration, Instant};

use futures::StreamExt;
use r2r::control_msgs::action::FollowJointTrajectory as Follow;
use r2r::trajectory_msgs::msg::JointTrajectory;
use r2r::{ActionClient, ActionClientGoal, GoalStatus, Node};
use tokio::sync::mpsc;

use crate::message::stamp_ns;
use crate::stamps::Stamps;

/// How long a controller may take to be found, and to answer.
pub(crate) const CONTROLLER_TIMEOUT: Duration = Duration::from_secs(2);
/// After so long without feedback it is asked whether there still is a controller.
const SILENCE: Duration = Duration::from_secs(2);
/// How long after its end a trajectory may stay without a result before somebody should look.
const OVERDUE: Duration = Duration::from_secs(10);

/// What becomes of a goal, with the number of the goal.
pub(crate) struct Event {
    pub(crate) goal: u64,
    pub(crate) what: What,
}

pub(crate) enum What {
    /// Nobody serves the action, or the middleware fails.
    NotSent(String),
    Rejected,
    Accepted(ActionClientGoal<Follow::Action>),
    /// The greatest distance of a joint from where it should be, in rad (or m).
    Feedback {
        error: f64,
    },
    /// It should have ended, and nothing is heard of it.
    Overdue,
    Ended(End),
}

/// How an accepted goal ended.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum End {
    Succeeded,
    Canceled,
    /// By the controller, with what it says.
    Aborted(String),
    /// It cannot be known.
    Lost(String),
}

/// The way to the controller.
pub(crate) struct Controller {
    client: ActionClient<Follow::Action>,
    events: mpsc::UnboundedSender<Event>,
    name: String,
    goals: u64,
}

impl Controller {
    pub(crate) fn create(node: &mut Node, name: &str, events: mpsc::UnboundedSender<Event>) -> r2r::Result<Self> {
        Ok(Self { client: node.create_action_client(name)?, events, name: name.to_owned(), goals: 0 })
    }

    /// Sends a trajectory, and tells what becomes of it. A goal is sent once: whoever finds a controller again must not move because of
    /// something older. Returns the goal's number.
    pub(crate) fn execute(&mut self, trajectory: JointTrajectory) -> u64 {
        self.goals += 1;
        let (goal, events, client, name) = (self.goals, self.events.clone(), self.client.clone(), self.name.clone());
        tokio::spawn(async move {
            // The receiver is gone only when the node shuts down.
            let tell = |what| drop(events.send(Event { goal, what }));
            if let Err(what) = follow(&client, &name, trajectory, &tell).await {
                tell(what);
            }
        });
        goal
    }
}

async fn follow(
    client: &ActionClient<Follow::Action>,
    name: &str,
    trajectory: JointTrajectory,
    tell: &impl Fn(What),
) -> Result<(), What> {
    let failed = |error: r2r::Error| What::NotSent(error.to_string());
    let due = Instant::now() + time_to_end(&trajectory) + OVERDUE;
    let nobody = |_| What::NotSent(format!("nobody serves the action {name}"));
    let available = Node::is_available(client).map_err(failed)?;
    tokio::time::timeout(CONTROLLER_TIMEOUT, available).await.map_err(nobody)?.map_err(failed)?;
    let request = client.send_goal_request(Follow::Goal { trajectory, ..Follow::Goal::default() }).map_err(failed)?;
    let silent = |_| What::NotSent(format!("the controller behind {name} does not answer"));
    let accepted = tokio::time::timeout(CONTROLLER_TIMEOUT, request).await.map_err(silent)?;
    let (goal, result, mut feedback) = accepted.map_err(|error| match error {
        r2r::Error::RCL_RET_ACTION_GOAL_REJECTED => What::Rejected,
        other => failed(other),
    })?;
    tell(What::Accepted(goal));
    tokio::pin!(result);
    let (mut watch, mut heard, mut told) = (tokio::time::interval(SILENCE), Instant::now(), false);
    loop {
        tokio::select! {
            // What was said on the way comes before the end.
            biased;
            Some(message) = feedback.next() => {
                let error = message.error.positions.iter().fold(0.0, |most, error| f64::max(most, error.abs()));
                heard = Instant::now();
                tell(What::Feedback { error });
            }
            ended = &mut result => {
                let lost = |error: r2r::Error| End::Lost(error.to_string());
                tell(What::Ended(ended.map_or_else(lost, |(status, result)| end(status, &result))));
                return Ok(());
            }
            // A controller that died does not say so.
            _ = watch.tick() => {
                if heard.elapsed() < SILENCE {
                    continue;
                }
                if !is_served(client).await {
                    tell(What::Ended(End::Lost(format!("nobody serves the action {name} any more"))));
                    return Ok(());
                }
                if Instant::now() > due && !std::mem::replace(&mut told, true) {
                    tell(What::Overdue);
                }
            }
        }
    }
}

async fn is_served(client: &ActionClient<Follow::Action>) -> bool {
    let Ok(available) = Node::is_available(client) else { return false };
    tokio::time::timeout(CONTROLLER_TIMEOUT, available).await.is_ok_and(|available| available.is_ok())
}

/// From now to the last point of a trajectory.
fn time_to_end(trajectory: &JointTrajectory) -> Duration {
    let stamp_ns = stamp_ns(&trajectory.header.stamp);
    let wait_ns = if stamp_ns == 0 { 0 } else { stamp_ns - Stamps::now_ns() };
    let takes_ns = trajectory.points.last().map_or(0, |last| {
        i64::from(last.time_from_start.sec) * 1_000_000_000 + i64::from(last.time_from_start.nanosec)
    });
    Duration::from_nanos((wait_ns + takes_ns).max(0) as u64)
}

fn end(status: GoalStatus, result: &Follow::Result) -> End {
    let said = match result.error_string.trim() {
        "" => code(result.error_code).to_owned(),
        words => format!("{}: {words}", code(result.error_code)),
    };
    match status {
        GoalStatus::Succeeded if result.error_code == 0 => End::Succeeded,
        GoalStatus::Canceled => End::Canceled,
        _ => End::Aborted(said),
    }
}

/// The result codes of the action in words.
fn code(code: i32) -> &'static str {
    match code {
        0 => "no error code",
        -1 => "invalid goal",
        -2 => "invalid joints",
        -3 => "old header timestamp",
        -4 => "path tolerance violated",
        -5 => "goal tolerance violated",
        _ => "unknown error code",
    }
}
