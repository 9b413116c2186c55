//! The thread in which the arm's time passes.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};
use std::time::{Duration, Instant, SystemTime};

use r2r::builtin_interfaces::msg::Time;
use r2r::rosgraph_msgs::msg::Clock as ClockMessage;
use r2r::sensor_msgs::msg::JointState;
use r2r::{Node, Publisher, QosProfile};

use crate::error::NodeError;
use crate::message::{joint_state, stamp_ns, time};
use crate::{Pacing, SharedArm, lock};

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

/// Lets the arm's time pass, and tells where the joints are.
pub(crate) struct Pace {
    arm: SharedArm,
    clock: Clock,
    states: Publisher<JointState>,
    clock_messages: Option<Publisher<ClockMessage>>,
    logger: String,
    speed: f64,
    /// Time between two joint states, in s of the arm's clock.
    period_s: f64,
    /// Behind by more than this, the arm goes on later, rather than to make up for it in a rush.
    most_behind: Duration,
    names: Vec<String>,
}

impl Pace {
    pub(crate) fn create(node: &mut Node, pacing: &Pacing, clock: Clock, arm: SharedArm) -> Result<Self, NodeError> {
        let states = node.create_publisher("joint_states", QosProfile::default().reliable().keep_last(10))?;
        let clock_qos = QosProfile::default().best_effort().keep_last(1);
        let clock_messages = pacing.clock.then(|| node.create_publisher("/clock", clock_qos)).transpose()?;
        let (names, most_behind) = {
            let arm = lock(&arm);
            (arm.joint_names().to_vec(), Duration::from_secs_f64(arm.most_behind_s()))
        };
        let (speed, period_s) = (pacing.speed, 1.0 / pacing.rate_hz);
        let logger = node.logger().to_owned();
        Ok(Self { arm, clock, states, clock_messages, logger, speed, period_s, most_behind, names })
    }

    /// Lets time pass until `stop` says so.
    pub(crate) fn run(self, stop: &AtomicBool) -> Result<(), NodeError> {
        let mut began = Instant::now();
        let (mut fault, mut is_heard) = (None, true);
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
            }
            let present = {
                let mut arm = lock(&self.arm);
                arm.run(until_s)?;
                arm.present()
            };
            if present.fault != fault {
                match &present.fault {
                    Some(why) => r2r::log_error!(&self.logger, "the arm has stopped: {why}"),
                    None => r2r::log_info!(&self.logger, "the arm goes on"),
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
                    r2r::log_error!(&self.logger, "joint states cannot be published: {error}");
                    is_heard = false;
                }
                told => is_heard = told.is_ok(),
            }
        }
        Ok(())
    }
}
