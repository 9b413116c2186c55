//! What the model of the arm does not know (friction, a tool in the gripper, gains of servos that differ), learnt slowly from the errors.

/// The part of an error that is made good in a second. Servos follow at some 15 rad/s; a third of that is far from swinging.
const RATE_PER_S: f64 = 5.0;
/// More than this is no small thing that was forgotten, in rad.
const MOST_RAD: f64 = 0.05;
/// A pulse, in rad: errors within one are not seen, and trying to mend them would hunt against the friction.
const UNSEEN_RAD: f64 = std::f64::consts::TAU / 4096.0;

/// Shifts of the joints' goals, in rad.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trim(Vec<f64>);

impl Trim {
    pub(crate) fn new(joints: usize) -> Self {
        Self(vec![0.0; joints])
    }

    /// Takes in how far the joints were from where they were to be, for so long.
    pub(crate) fn learn(&mut self, desired: &[f64], measured: &[f64], for_s: f64) {
        for (shift, (wanted, is)) in self.0.iter_mut().zip(desired.iter().zip(measured)) {
            let error = wanted - is;
            let seen = error.signum() * (error.abs() - UNSEEN_RAD).max(0.0);
            *shift = (*shift + RATE_PER_S * for_s * seen).clamp(-MOST_RAD, MOST_RAD);
        }
    }

    /// Where goals are to be, by joint.
    pub(crate) fn shifted(&self, position: &[f64]) -> Vec<f64> {
        position.iter().zip(&self.0).map(|(q, shift)| q + shift).collect()
    }

    pub(crate) fn forget(&mut self) {
        self.0.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lasting_error_is_made_good_within_bounds() {
        let mut trim = Trim::new(3);
        // The second joint follows what it is told, less 0.01 rad; the third is stuck; the first is off by less than can be seen.
        let mut stands = [0.001, -0.01, -1.0];
        for _ in 0..400 {
            trim.learn(&[0.0; 3], &stands, 0.005);
            stands[1] = trim.shifted(&[0.0; 3])[1] - 0.01;
        }
        let shifts = trim.shifted(&[0.0; 3]);
        assert!(
            shifts[0] == 0.0 && (shifts[1] - 0.01).abs() < 1.01 * UNSEEN_RAD && shifts[2] == MOST_RAD,
            "{shifts:?}"
        );
    }
}
