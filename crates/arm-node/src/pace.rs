//! The thread in which the arm's time passes.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};
use std::time::{Duration, Instant, SystemTime};

use r2r::builtin_interfaces::msg::Time;
use r2r::rosgraph_msgs::msg::Clock as ClockMessage;
use r2r::sensor_msgs::msg::JointState;
use r2r::{Node, Publisher, QosProfile};

use crate::error::NodeError;
use crate::log::Log;
use crate::message::{joint_state, stamp_ns, time};
use crate::{Pacing, SharedArm, lock};

/// So often it is looked whether the arm went on in time, and this part of the time is in time.
const LOOKS_BACK: Duration = Duration::from_secs(5);
const IN_TIME: f64 = 0.9;
/// On `/clock` time begins at 1 s: a stamp of zero means that there is none.
const CLOCK_BEGINS_NS: i64 = 1_000_000_000;

/// What the arm's time is in ROS time.
#[derive(Debug, Clone)]
pub(crate) struct Clock {
    /// Later whenever the arm has fallen behind the system's clock, and goes on later.
    began_ns: Arc<AtomicI64>,
    is_published: bool,
}

impl Clock {
    /// The clock that is published, or the system's.
    pub(crate) fn new(published: bool) -> Self {
        let since_epoch = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let began_ns = if published { CLOCK_BEGINS_NS } else { since_epoch.as_nanos() as i64 };
        Self { began_ns: Arc::new(AtomicI64::new(began_ns)), is_published: published }
    }

    /// The arm's time stood still for so long.
    fn slip(&self, by: Duration) {
        if !self.is_published {
            self.began_ns.fetch_add(by.as_nanos() as i64, Ordering::Relaxed);
        }
    }

    pub(crate) fn stamp_ns(&self, now_s: f64) -> i64 {
        self.began_ns.load(Ordering::Relaxed) + (now_s * 1e9).round() as i64
    }

    /// A stamp on the arm's clock; `None` where there is none.
    pub(crate) fn seconds(&self, stamp: &Time) -> Option<f64> {
        let stamp = Some(stamp_ns(stamp)).filter(|stamp| *stamp != 0)?;
        Some((stamp - self.began_ns.load(Ordering::Relaxed)) as f64 * 1e-9)
    }
}

/// How far the arm fell behind of late.
#[derive(Default)]
struct Lag {
    since: Option<Instant>,
    behind: Duration,
}

impl Lag {
    /// Once a while: which part of the time the arm went on in, where that is worth a word.
    fn told(&mut self, now: Instant) -> Option<f64> {
        let since = *self.since.get_or_insert(now);
        let while_s = now.duration_since(since).as_secs_f64();
        if while_s < LOOKS_BACK.as_secs_f64() {
            return None;
        }
        let part = 1.0 - self.behind.as_secs_f64() / while_s;
        *self = Self { since: Some(now), behind: Duration::ZERO };
        (part < IN_TIME).then_some(part)
    }
}

/// Lets the arm's time pass, and tells where the joints are.
pub(crate) struct Pace {
    arm: SharedArm,
    clock: Clock,
    states: Publisher<JointState>,
    clock_messages: Option<Publisher<ClockMessage>>,
    log: Log,
    speed: f64,
    /// Time between two joint states, in s of the arm's clock.
    period_s: f64,
    /// Behind by more than this, the arm goes on later, rather than to make up for it in a rush.
    most_behind: Duration,
    names: Vec<String>,
}

impl Pace {
    pub(crate) fn create(
        node: &mut Node,
        pacing: &Pacing,
        clock: Clock,
        arm: SharedArm,
        log: Log,
    ) -> Result<Self, NodeError> {
        let states = node.create_publisher("joint_states", QosProfile::default().reliable().keep_last(10))?;
        let clock_qos = QosProfile::default().best_effort().keep_last(1);
        let clock_messages = pacing.clock.then(|| node.create_publisher("/clock", clock_qos)).transpose()?;
        let (names, most_behind) = {
            let arm = lock(&arm);
            (arm.joint_names().to_vec(), Duration::from_secs_f64(arm.most_behind_s()))
        };
        let (speed, period_s) = (pacing.speed, 1.0 / pacing.rate_hz);
        Ok(Self { arm, clock, states, clock_messages, log, speed, period_s, most_behind, names })
    }

    /// Lets time pass until `stop` says so.
    pub(crate) fn run(self, stop: &AtomicBool) -> Result<(), NodeError> {
        let mut began = Instant::now();
        let (mut fault, mut is_heard) = (None, true);
        let mut lag = Lag::default();
        for tick in 0_u64.. {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            let until_s = tick as f64 * self.period_s;
            let due = began + Duration::from_secs_f64(until_s / self.speed);
            let now = Instant::now();
            // A pace, not a wait for an event.
            std::thread::sleep(due.saturating_duration_since(now));
            if now > due + self.most_behind {
                began += now - due;
                self.clock.slip(now - due);
                lag.behind += now - due;
            }
            if let Some(part) = lag.told(now) {
                let percent = 100.0 * part;
                self.log.warn(format_args!(
                    "the arm goes at {percent:.0} % of its planned speed: this computer is too busy to lead it in time"
                ));
            }
            let present = {
                let mut arm = lock(&self.arm);
                arm.run(until_s)?;
                arm.present()
            };
            if present.fault != fault {
                match &present.fault {
                    Some(why) => self.log.error(format_args!("the arm has stopped: {why}")),
                    None => self.log.info("the arm goes on"),
                }
                fault = present.fault;
            }
            let stamp_ns = self.clock.stamp_ns(present.now_s);
            let clock = self.clock_messages.as_ref();
            let told = clock.map_or(Ok(()), |clock| clock.publish(&ClockMessage { clock: time(stamp_ns) }));
            let state = joint_state(&self.names, present.position, present.velocity, stamp_ns);
            // An arm in motion must be led on whoever hears of it.
            match told.and_then(|()| self.states.publish(&state)) {
                Err(error) if is_heard => {
                    self.log.error(format_args!("joint states cannot be published: {error}"));
                    is_heard = false;
                }
                told => is_heard = told.is_ok(),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_that_falls_behind_is_told_of_once_a_while() {
        let begin = Instant::now();
        let mut lag = Lag::default();
        assert_eq!(lag.told(begin), None);
        lag.behind = Duration::from_secs(3);
        assert_eq!(lag.told(begin + LOOKS_BACK / 2), None, "not yet");
        let part = lag.told(begin + 2 * LOOKS_BACK).unwrap();
        assert!((part - 0.7).abs() < 1e-9, "{part}");
        assert_eq!(lag.told(begin + 4 * LOOKS_BACK), None, "it was in time again");
    }
}
