//! Goals of FollowJointTrajectory: taken up or rejected, watched, cancelled with a smooth stop.

use std::time::Duration;

use futures::StreamExt;
use planner::{Present, Refused};
use r2r::control_msgs::action::FollowJointTrajectory as Follow;
use r2r::control_msgs::msg::JointTolerance;
use r2r::{ActionServerGoal, ActionServerGoalRequest};

use crate::log::Log;
use crate::message::{header, point, trajectory};
use crate::pace::Clock;
use crate::{SharedArm, lock};

/// How often a goal is looked at, and feedback given.
const PERIOD: Duration = Duration::from_millis(20);
/// A joint this far from the end is there, in rad (m for slides), where the goal does not say.
const GOAL_TOLERANCE: f64 = 0.01;
/// It may come there so much later, in s of the arm's clock.
const GOAL_TIME_S: f64 = 1.0;

/// Plays what is asked for, or rejects it, and sees to its end on a task of its own.
pub(crate) fn serve(request: ActionServerGoalRequest<Follow::Action>, arm: SharedArm, clock: Clock, log: &Log) {
    let wanted = &request.goal.trajectory;
    let starts_at_s = clock.seconds(&wanted.header.stamp);
    let played = lock(&arm).play(starts_at_s, trajectory(wanted));
    let log = log.clone();
    match played {
        Err(why) => {
            log.error(format_args!("a goal is rejected ({}): {why}", code(&why)));
            if let Err(error) = request.reject() {
                log.error(format_args!("rejecting failed: {error}"));
            }
        }
        Ok(number) => match request.accept() {
            Err(error) => log.error(format_args!("accepting failed: {error}")),
            Ok((goal, cancels)) => {
                tokio::spawn(async move {
                    if let Err(error) = watch(goal, cancels, number, arm, clock).await {
                        log.error(format_args!("a goal is lost: {error}"));
                    }
                });
            }
        },
    }
}

/// How a goal ends.
enum End {
    Succeeded,
    Canceled,
    Aborted(i32, String),
}

async fn watch(
    mut goal: ActionServerGoal<Follow::Action>,
    mut cancels: impl futures::Stream<Item = r2r::ActionServerCancelRequest> + Unpin,
    number: u64,
    arm: SharedArm,
    clock: Clock,
) -> r2r::Result<()> {
    let mut pace = tokio::time::interval(PERIOD);
    let mut stopping = None;
    let end = loop {
        tokio::select! {
            Some(cancel) = cancels.next() => {
                cancel.accept();
                lock(&arm).stop();
                stopping.get_or_insert(End::Canceled);
            }
            _ = pace.tick() => {
                let present = lock(&arm).present();
                let names = lock(&arm).joint_names().to_vec();
                goal.publish_feedback(feedback(&goal.goal.trajectory.joint_names, &names, &present, &clock))?;
                if present.number != number {
                    break End::Aborted(Follow::Result::SUCCESSFUL as i32, "a newer trajectory took over".into());
                }
                let rests = present.now_s >= present.ends_at_s;
                if let Some(why) = &present.fault {
                    // The arm stops by itself.
                    stopping = Some(End::Aborted(Follow::Result::PATH_TOLERANCE_VIOLATED as i32, why.clone()));
                }
                if stopping.is_some() && rests {
                    break stopping.unwrap_or(End::Canceled);
                }
                if stopping.is_none() && let Some(why) = off(&present.desired[0], &present.position, &names, &goal.goal.path_tolerance, None) {
                    lock(&arm).stop();
                    stopping = Some(End::Aborted(Follow::Result::PATH_TOLERANCE_VIOLATED as i32, why));
                } else if rests {
                    match off(&present.goal, &present.position, &names, &goal.goal.goal_tolerance, Some(GOAL_TOLERANCE)) {
                        None => break End::Succeeded,
                        Some(why) if present.now_s > present.ends_at_s + GOAL_TIME_S => {
                            break End::Aborted(Follow::Result::GOAL_TOLERANCE_VIOLATED as i32, why);
                        }
                        Some(_) => {}
                    }
                }
            }
        }
    };
    let result = |error_code, error_string| Follow::Result { error_code, error_string };
    match end {
        End::Succeeded => goal.succeed(result(0, String::new())),
        End::Canceled => goal.cancel(result(0, "stopped on the path".into())),
        End::Aborted(code, why) => goal.abort(result(code, why)),
    }
}

/// The first joint that is farther from where it should be than is tolerated: by the goal, else by `otherwise`, else everything is.
fn off(
    wanted: &[f64],
    is: &[f64],
    names: &[String],
    tolerances: &[JointTolerance],
    otherwise: Option<f64>,
) -> Option<String> {
    names.iter().enumerate().find_map(|(joint, name)| {
        let given = tolerances.iter().find(|tolerance| tolerance.name == *name).map(|tolerance| tolerance.position);
        // 0 leaves it to the controller, a negative number allows anything.
        let tolerance = given.filter(|position| *position != 0.0).or(otherwise).filter(|position| *position > 0.0)?;
        let by = (wanted[joint] - is[joint]).abs();
        (by > tolerance).then(|| format!("{name} is {by:.4} off, and {tolerance} is tolerated"))
    })
}

/// In the joint order of the goal.
fn feedback(names: &[String], own: &[String], present: &Present, clock: &Clock) -> Follow::Feedback {
    let places: Vec<usize> = names.iter().filter_map(|name| own.iter().position(|other| other == name)).collect();
    let pick = |values: &[f64]| places.iter().map(|&place| values[place]).collect::<Vec<_>>();
    let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>();
    let [q, v, a] = [0, 1, 2].map(|order| pick(&present.desired[order]));
    let (position, velocity) = (pick(&present.position), pick(&present.velocity));
    Follow::Feedback {
        header: header(clock.stamp_ns(present.now_s)),
        joint_names: names.to_vec(),
        error: point(differ(&q, &position), differ(&v, &velocity), Vec::new()),
        desired: point(q, v, a),
        actual: point(position, velocity, Vec::new()),
        ..Follow::Feedback::default()
    }
}

/// The result code that the action has for it: a rejection cannot carry one, so the log does.
fn code(why: &Refused) -> i64 {
    match why {
        Refused::Goal(_) | Refused::Faulty(_) => Follow::Result::INVALID_GOAL as i64,
        Refused::Joints(_) => Follow::Result::INVALID_JOINTS as i64,
        Refused::Old { .. } => Follow::Result::OLD_HEADER_TIMESTAMP as i64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_those_of_the_goal() {
        let names = ["a".to_owned(), "b".to_owned()];
        let tolerance = |position| vec![JointTolerance { name: "b".into(), position, ..Default::default() }];
        let off = |position, otherwise| off(&[0.0, 1.0], &[0.0, 1.1], &names, &tolerance(position), otherwise);
        assert_eq!(off(0.05, None).unwrap(), "b is 0.1000 off, and 0.05 is tolerated");
        assert_eq!((off(0.2, None), off(0.0, None), off(-1.0, Some(0.01))), (None, None, None));
        assert!(off(0.0, Some(0.01)).is_some());
    }
}
