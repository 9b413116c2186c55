//! What the node says of its health, for `/diagnostics`: a level that means something, and the figures behind it.

use std::collections::VecDeque;

use planner::{Counters, Refusal};

/// So many poses in a row without an answer are a source that is faster than planning, not a person who thought better of it.
const IN_VAIN: u64 = 5;

/// As in `diagnostic_msgs/DiagnosticStatus`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    /// Works as it should.
    Ok = 0,
    /// Works, and somebody should look: something was refused or lost.
    Warn = 1,
    /// Does not work.
    Error = 2,
    /// Nothing has been heard of it lately.
    Stale = 3,
}

/// One line of the report.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Status {
    pub(crate) name: String,
    pub(crate) level: Level,
    /// One sentence.
    pub(crate) message: String,
    pub(crate) values: Vec<(&'static str, String)>,
}

/// Everything that is watched between reports.
#[derive(Debug, Default)]
pub(crate) struct Health {
    /// The last answer: how it went.
    pub(crate) last: Option<Answer>,
    /// Seconds from a message of poses to its answer.
    pub(crate) latency: Latencies,
    /// Seconds that planning alone took, whatever came of it.
    pub(crate) planning: Latencies,
    /// How the last goal of the controller's action goes; `None` where trajectories are published on a topic.
    pub(crate) execution: Option<Progress>,
    /// A description of the robot that could not be taken up.
    pub(crate) robot_fault: Option<String>,
    /// What was lost on the way in up to the last report.
    pub(crate) reported_lost: u64,
}

/// How the last poses were answered.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Answer {
    pub(crate) level: Level,
    pub(crate) message: String,
}

/// How far a goal has come.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Progress {
    pub(crate) level: Level,
    pub(crate) message: String,
    pub(crate) feedbacks: u64,
    /// The greatest distance of a joint from where it should be, in rad (or m).
    pub(crate) worst_error: f64,
}

impl Progress {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { level: Level::Ok, message: message.into(), feedbacks: 0, worst_error: 0.0 }
    }
}

/// Single poses that were not simply added to their set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct OddPoses {
    /// The same again.
    pub(crate) repeated: u64,
    /// Another with the same stamp, which took the place of the earlier.
    pub(crate) corrected: u64,
    /// In another frame than its set.
    pub(crate) refused: u64,
}

/// What is told of the state outside.
pub(crate) struct Situation<'a> {
    /// Name of the node, before the colon.
    pub(crate) node: &'a str,
    pub(crate) robot: &'a str,
    pub(crate) joints: usize,
    /// State of its life cycle.
    pub(crate) state: &'a str,
    pub(crate) joint_state_age_s: Option<f64>,
    pub(crate) joint_state_max_age_s: f64,
    pub(crate) joint_state_required: bool,
    pub(crate) counters: Counters,
    /// Poses that waited for a transform until newer ones came.
    pub(crate) replaced: u64,
    pub(crate) odd_poses: OddPoses,
    /// Single poses that are in a set which is not complete.
    pub(crate) collected: usize,
    /// Messages that came in faster than they could be taken up.
    pub(crate) poses_dropped: u64,
    pub(crate) joint_states_dropped: u64,
}

impl Answer {
    pub(crate) fn planned(message: String) -> Self {
        Self { level: Level::Ok, message }
    }

    /// A refusal is the node at work, and a person's business; only a fault of the planner is its failure.
    pub(crate) fn refused(refusal: &Refusal) -> Self {
        let level = if matches!(refusal, Refusal::Internal(_)) { Level::Error } else { Level::Warn };
        Self { level, message: format!("the last poses were refused: {refusal}") }
    }
}

impl Health {
    pub(crate) fn statuses(&self, now: &Situation<'_>) -> Vec<Status> {
        let mut statuses = vec![self.planning(now), joint_states(now), self.robot(now), self.inputs(now)];
        statuses.extend(self.execution.as_ref().map(|progress| Status {
            name: format!("{}: execution", now.node),
            level: progress.level,
            message: progress.message.clone(),
            values: vec![
                ("feedbacks", progress.feedbacks.to_string()),
                ("worst_error_rad", format!("{:.6}", progress.worst_error)),
            ],
        }));
        statuses
    }

    /// So many lost messages have been told of: only more of them are worth another warning.
    pub(crate) fn told_of(&mut self, lost: u64) {
        self.reported_lost = lost;
    }

    fn planning(&self, now: &Situation<'_>) -> Status {
        let (level, message) = match &self.last {
            None => (Level::Ok, "no poses have arrived yet".to_owned()),
            Some(answer) => (answer.level, answer.message.clone()),
        };
        let count = |key, number: u64| (key, number.to_string());
        let seconds = |key, value: Option<f64>| (key, value.map_or_else(|| "-".into(), |s| format!("{s:.4}")));
        let values = vec![
            ("state", now.state.to_owned()),
            count("planned", now.counters.planned),
            count("refused", now.counters.refused),
            count("discarded", now.counters.discarded),
            count("late", now.counters.late),
            seconds("latency_last_s", self.latency.last()),
            seconds("latency_p50_s", self.latency.quantile(0.5)),
            seconds("latency_p99_s", self.latency.quantile(0.99)),
            seconds("planning_p50_s", self.planning.quantile(0.5)),
        ];
        Status { name: format!("{}: planning", now.node), level, message, values }
    }

    fn robot(&self, now: &Situation<'_>) -> Status {
        let (level, message) = match &self.robot_fault {
            Some(why) => {
                (Level::Error, format!("robot_description is ignored, and {} is planned for: {why}", now.robot))
            }
            None => (Level::Ok, format!("planning for {}", now.robot)),
        };
        let values = vec![("robot", now.robot.to_owned()), ("joints", now.joints.to_string())];
        Status { name: format!("{}: robot", now.node), level, message, values }
    }

    fn inputs(&self, now: &Situation<'_>) -> Status {
        let lost = now.lost() - self.reported_lost;
        let (level, message) = match lost {
            0 if now.counters.in_vain >= IN_VAIN => (
                Level::Warn,
                format!(
                    "the last {} poses were replaced by newer ones before they were planned: that takes {} s",
                    now.counters.in_vain,
                    self.planning.quantile(0.5).map_or_else(|| "more".into(), |s| format!("{s:.2}"))
                ),
            ),
            0 => (Level::Ok, "every message was taken up".to_owned()),
            lost => (Level::Warn, format!("{lost} messages came faster than they could be taken up, and were dropped")),
        };
        let values = vec![
            ("poses_received", (now.counters.received + now.replaced + now.poses_dropped).to_string()),
            ("poses_answered", now.counters.answered.to_string()),
            ("poses_superseded", (now.counters.superseded + now.replaced).to_string()),
            ("poses_dropped", now.poses_dropped.to_string()),
            ("single_poses_waiting", now.collected.to_string()),
            ("single_poses_repeated", now.odd_poses.repeated.to_string()),
            ("single_poses_corrected", now.odd_poses.corrected.to_string()),
            ("single_poses_refused", now.odd_poses.refused.to_string()),
            ("joint_states_dropped", now.joint_states_dropped.to_string()),
        ];
        Status { name: format!("{}: input", now.node), level, message, values }
    }
}

impl Situation<'_> {
    /// Messages that nobody will look at any more.
    pub(crate) fn lost(&self) -> u64 {
        self.poses_dropped + self.joint_states_dropped
    }
}

fn joint_states(now: &Situation<'_>) -> Status {
    let (level, message) = match now.joint_state_age_s {
        None if now.joint_state_required => {
            (Level::Stale, format!("no joint state with all joints of {} has arrived: nothing is planned", now.robot))
        }
        None => (Level::Ok, "no joint state has arrived, and none is required".to_owned()),
        Some(age_s) if age_s > now.joint_state_max_age_s => (
            Level::Stale,
            format!("the last joint state is {age_s:.1} s old: nothing is planned until a new one arrives"),
        ),
        Some(_) => (Level::Ok, "the robot is heard of".to_owned()),
    };
    let age = now.joint_state_age_s.map_or_else(|| "-".into(), |age_s| format!("{age_s:.3}"));
    Status { name: format!("{}: joint states", now.node), level, message, values: vec![("age_s", age)] }
}

/// The last durations, and how they are spread.
#[derive(Debug, Default)]
pub(crate) struct Latencies(VecDeque<f64>);

impl Latencies {
    /// How many are remembered.
    const WINDOW: usize = 1000;

    pub(crate) fn add(&mut self, seconds: f64) {
        if self.0.len() == Self::WINDOW {
            self.0.pop_front();
        }
        self.0.push_back(seconds);
    }

    fn last(&self) -> Option<f64> {
        self.0.back().copied()
    }

    /// The duration that a part of them (0 to 1) does not exceed.
    fn quantile(&self, part: f64) -> Option<f64> {
        let mut sorted: Vec<f64> = self.0.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let rank = (part * sorted.len() as f64).ceil() as usize;
        sorted.get(rank.saturating_sub(1)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn situation(age_s: Option<f64>, required: bool, dropped: u64) -> Situation<'static> {
        Situation {
            node: "reorder",
            robot: "ur5e",
            joints: 6,
            state: "active",
            joint_state_age_s: age_s,
            joint_state_max_age_s: 1.0,
            joint_state_required: required,
            counters: Counters::default(),
            replaced: 0,
            odd_poses: OddPoses::default(),
            collected: 0,
            poses_dropped: dropped,
            joint_states_dropped: 0,
        }
    }

    fn levels(health: &mut Health, now: &Situation<'_>) -> Vec<Level> {
        let levels = health.statuses(now).iter().map(|status| status.level).collect();
        health.told_of(now.lost());
        levels
    }

    #[test]
    fn levels_say_what_is_wrong() {
        use Level::{Error, Ok, Stale, Warn};
        let mut health = Health::default();
        assert_eq!(levels(&mut health, &situation(Some(0.1), true, 0)), [Ok, Ok, Ok, Ok]);
        assert_eq!(levels(&mut health, &situation(None, true, 0)), [Ok, Stale, Ok, Ok]);
        assert_eq!(levels(&mut health, &situation(None, false, 0)), [Ok, Ok, Ok, Ok]);
        assert_eq!(levels(&mut health, &situation(Some(1.5), true, 0)), [Ok, Stale, Ok, Ok]);
        // What was lost is reported once.
        assert_eq!(levels(&mut health, &situation(Some(0.1), true, 3)), [Ok, Ok, Ok, Warn]);
        assert_eq!(levels(&mut health, &situation(Some(0.1), true, 3)), [Ok, Ok, Ok, Ok]);
        let mut hurried = situation(Some(0.1), true, 3);
        hurried.counters.in_vain = IN_VAIN;
        assert_eq!(levels(&mut health, &hurried), [Ok, Ok, Ok, Warn]);
        health.last = Some(Answer::refused(&Refusal::StaleJointState { age_s: 2.0, allowed_s: 1.0 }));
        health.robot_fault = Some("no joints".into());
        assert_eq!(levels(&mut health, &situation(Some(0.1), true, 3)), [Warn, Ok, Error, Ok]);
        health.last = Some(Answer::refused(&Refusal::Internal("a bug".into())));
        assert_eq!(health.statuses(&situation(Some(0.1), true, 3))[0].level, Error);
    }

    #[test]
    fn latencies_are_those_of_the_last_thousand() {
        let mut latencies = Latencies::default();
        assert_eq!(latencies.quantile(0.5), None);
        (0..2000).for_each(|ms| latencies.add(f64::from(ms) * 1e-3));
        assert_eq!((latencies.quantile(0.5), latencies.quantile(0.99)), (Some(1.499), Some(1.989)));
        assert_eq!(latencies.last(), Some(1.999));
    }
}
