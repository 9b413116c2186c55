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
    /// Since when a joint is too far off.
    off_since_s: Option<f64>,
    /// The joints that gave way after a stop.
    gave_way: Vec<bool>,
}

impl Watchman {
    pub(crate) fn new(bounds: Watch, now_s: f64) -> Self {
        Self { bounds, heard_at_s: now_s, off_since_s: None, gave_way: Vec::new() }
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
        if let Some(apart) = disagreement(config, joints, states) {
            return Some(apart);
        }
        let off_by = |joint: usize| (position[joint] - desired[joint]).abs();
        let worst = (0..position.len()).max_by(|&a, &b| off_by(a).total_cmp(&off_by(b)))?;
        if off_by(worst) <= self.bounds.following_rad {
            self.off_since_s = None;
            return None;
        }
        let since_s = *self.off_since_s.get_or_insert(now_s);
        (now_s - since_s > self.bounds.following_s).then(|| HilError::Following {
            joint: config.servos[joints.servo_of(worst)].joint.clone().unwrap_or_default(),
            by_rad: off_by(worst),
            servo: config.servos[joints.servo_of(worst)].label(),
        })
    }

    /// Where the joints are to stand after a stop, if some press against something: these where they are, once each. One that goes on
    /// sinking must not take its goal with it.
    pub(crate) fn give_way(&mut self, position: &[f64], desired: &[f64]) -> Option<Vec<f64>> {
        self.gave_way.resize(position.len(), false);
        let mut stand = desired.to_vec();
        let mut gives_way = false;
        for (joint, gave_way) in self.gave_way.iter_mut().enumerate() {
            if !*gave_way && (position[joint] - desired[joint]).abs() > PRESSES * self.bounds.following_rad {
                (stand[joint], *gave_way, gives_way) = (position[joint], true, true);
            }
        }
        gives_way.then_some(stand)
    }
}

/// That two servos of one joint do not agree where it is.
pub(crate) fn disagreement(config: &Config, joints: &Joints, states: &[ServoState]) -> Option<HilError> {
    let ([servo, other], by_rad) = joints.apart(states)?;
    let [servo, other] = [servo, other].map(|index| config.servos[index].label());
    Some(HilError::Apart { servo, other, by_rad })
}
