//! Looks at what the servos tell, and says when something is wrong.

use crate::config::{Config, Watch};
use crate::error::HilError;
use crate::joints::Joints;
use crate::servo_state::ServoState;

/// After a stop a joint that is still off by this part of the bound presses against something.
const PRESSES: f64 = 0.5;

/// What was seen so far. Times are in s of the arm's clock.
pub(crate) struct Watchman {
    bounds: Watch,
    heard_at_s: f64,
    /// The joint that is too far off, and since when.
    off: Option<(usize, f64)>,
}

impl Watchman {
    pub(crate) fn new(bounds: Watch, now_s: f64) -> Self {
        Self { bounds, heard_at_s: now_s, off: None }
    }

    /// All servos have answered.
    pub(crate) fn heard(&mut self, now_s: f64) {
        self.heard_at_s = now_s;
    }

    /// The first fault, where there is one; [`HilError::GroupMissed`] where some do not answer, and it is to be found out which.
    pub(crate) fn look(
        &mut self,
        now_s: f64,
        config: &Config,
        joints: &Joints,
        states: &[ServoState],
        [position, desired]: [&[f64]; 2],
    ) -> Option<HilError> {
        if now_s - self.heard_at_s > self.bounds.silence_s {
            return Some(HilError::GroupMissed);
        }
        for (state, servo) in states.iter().zip(&config.servos) {
            if state.errors.0 != 0 {
                return Some(HilError::Hardware { servo: servo.label(), errors: state.errors });
            }
            if !state.torque {
                return Some(HilError::Limp { servo: servo.label() });
            }
        }
        let off_by = |joint: usize| (position[joint] - desired[joint]).abs();
        let worst = (0..position.len()).max_by(|&a, &b| off_by(a).total_cmp(&off_by(b)))?;
        if off_by(worst) <= self.bounds.following_rad {
            self.off = None;
            return None;
        }
        let (joint, since_s) = *self.off.get_or_insert((worst, now_s));
        (now_s - since_s > self.bounds.following_s).then(|| HilError::Following {
            joint: config.servos[joints.servo_of(joint)].joint.clone().unwrap_or_default(),
            by_rad: off_by(joint),
            servo: config.servos[joints.servo_of(joint)].label(),
        })
    }

    /// Whether a joint presses against something after a stop.
    pub(crate) fn presses(&self, position: &[f64], desired: &[f64]) -> bool {
        position.iter().zip(desired).any(|(is, wanted)| (is - wanted).abs() > PRESSES * self.bounds.following_rad)
    }
}
