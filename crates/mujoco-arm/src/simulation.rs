//! The thread in which simulated time passes.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime};

use r2r::builtin_interfaces::msg::Time;
use r2r::rosgraph_msgs::msg::Clock as ClockMessage;
use r2r::sensor_msgs::msg::JointState;
use r2r::{Node, Publisher, QosProfile};

use crate::ArmError;
use crate::message::{joint_state, stamp_ns, time};
use crate::settings::Settings;
use crate::world::{World, lock};

/// Behind by more than this, the arm goes on more slowly, rather than to make up for it in a rush.
const MOST_BEHIND: Duration = Duration::from_millis(100);
/// On `/clock` time begins at 1 s: a stamp of zero means that there is none.
const CLOCK_BEGINS_NS: i64 = 1_000_000_000;

/// What the arm's time is in ROS time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clock {
    began_ns: i64,
}

impl Clock {
    /// The clock that is published, or the system's.
    pub(crate) fn new(published: bool) -> Self {
        let since_epoch = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        Self { began_ns: if published { CLOCK_BEGINS_NS } else { since_epoch.as_nanos() as i64 } }
    }

    pub(crate) fn stamp_ns(self, now_s: f64) -> i64 {
        self.began_ns + (now_s * 1e9).round() as i64
    }

    /// A stamp on the arm's clock; `None` where there is none.
    pub(crate) fn seconds(self, stamp: &Time) -> Option<f64> {
        let stamp = Some(stamp_ns(stamp)).filter(|stamp| *stamp != 0)?;
        Some((stamp - self.began_ns) as f64 * 1e-9)
    }
}

pub(crate) struct Simulation {
    world: Arc<Mutex<World>>,
    clock: Clock,
    states: Publisher<JointState>,
    clock_messages: Option<Publisher<ClockMessage>>,
    speed: f64,
    /// Simulated time between two joint states, in s.
    period_s: f64,
    names: Vec<String>,
}

impl Simulation {
    pub(crate) fn create(
        node: &mut Node,
        settings: &Settings,
        clock: Clock,
        world: Arc<Mutex<World>>,
    ) -> Result<Self, ArmError> {
        let states = node.create_publisher("joint_states", QosProfile::default().reliable().keep_last(10))?;
        let clock_qos = QosProfile::default().best_effort().keep_last(1);
        let clock_messages = settings.clock.then(|| node.create_publisher("/clock", clock_qos)).transpose()?;
        let names = lock(&world).joint_names.clone();
        let (speed, period_s) = (settings.speed, 1.0 / settings.rate_hz);
        Ok(Self { world, clock, states, clock_messages, speed, period_s, names })
    }

    /// Lets time pass until `stop` says so.
    pub(crate) fn run(self, stop: &AtomicBool) -> Result<(), ArmError> {
        let mut began = Instant::now();
        for tick in 0_u64.. {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            let until_s = tick as f64 * self.period_s;
            let due = began + Duration::from_secs_f64(until_s / self.speed);
            let now = Instant::now();
            // A pace, not a wait for an event.
            std::thread::sleep(due.saturating_duration_since(now));
            if now > due + MOST_BEHIND {
                began += now - due;
            }
            let present = {
                let mut world = lock(&self.world);
                world.run(until_s)?;
                world.present()
            };
            let stamp_ns = self.clock.stamp_ns(present.now_s);
            if let Some(clock) = &self.clock_messages {
                clock.publish(&ClockMessage { clock: time(stamp_ns) })?;
            }
            self.states.publish(&joint_state(&self.names, present.position, present.velocity, stamp_ns))?;
        }
        Ok(())
    }
}
