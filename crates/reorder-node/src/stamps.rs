//! Time: the session's clock, and what it shows in ROS time.

use std::time::{Instant, SystemTime};

use planner::Motion;

/// The session's clock, and what it shows in ROS time.
pub(crate) struct Stamps {
    started: Instant,
    /// ROS time when the session's clock was 0, in ns since the epoch.
    began_ns: i64,
}

/// The two clocks may drift apart by this much. Following them more closely would shift a trajectory against the one it takes over
/// from by the jitter of reading them.
const SAME_CLOCK_NS: i64 = 1_000_000;

impl Stamps {
    pub(crate) fn new() -> Self {
        Self { started: Instant::now(), began_ns: 0 }
    }

    pub(crate) fn now_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// ROS time, in ns since the epoch.
    pub(crate) fn now_ns() -> i64 {
        SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_nanos() as i64
    }

    /// When a motion begins, in ns since the epoch.
    pub(crate) fn of(&mut self, motion: &Motion) -> i64 {
        let began_ns = Self::now_ns() - self.started.elapsed().as_nanos() as i64;
        if (began_ns - self.began_ns).abs() > SAME_CLOCK_NS {
            self.began_ns = began_ns;
        }
        self.began_ns + (motion.starts_at_s * 1e9).round() as i64
    }
}
