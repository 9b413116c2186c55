//! Contacts of a whole trajectory, without running it.

use planner::manipulator::JointTrajectory;

use crate::arm::SimulatedArm;
use crate::command::Command;
use crate::contact::{ContactEvent, ContactLog, touches};
use crate::error::{Result, SimError};
use crate::reach::reaches;

/// How a trajectory is swept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepOptions {
    /// Bodies that come nearer to each other than this are reported, in m, from 0.0005. It is also how far two bodies may move towards
    /// each other from one check to the next, so that a small one takes long.
    pub clearance_m: f64,
}

impl Default for SweepOptions {
    fn default() -> Self {
        Self { clearance_m: 0.005 }
    }
}

/// What a sweep found.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Which bodies touch, in the order in which they begin to.
    pub contacts: Vec<ContactEvent>,
    /// Which bodies come nearer than the clearance, in the order in which they do. Without any, no two shapes of the model touch at any
    /// moment of the trajectory, between checks either. Depths are negative where they stay apart.
    pub approaches: Vec<ContactEvent>,
    /// Configurations that were looked at.
    pub checks: usize,
}

/// More checks than this are a mistake of units.
const MOST_CHECKS: f64 = 1e7;
/// The derivative of a polynomial of degree five has control points five times the differences of its own.
const DEGREE: f64 = 5.0;

impl SimulatedArm {
    /// Looks for contacts, with itself and with everything else in the model, along the whole trajectory, kinematically: no servo, no
    /// dynamics, the joints are where the trajectory wants them.
    ///
    /// Between two checks no point of the arm moves by more than the clearance: with Rᵢ the distance from the axis of joint i to the
    /// farthest point that it carries, in any configuration, it moves by at most Σ Rᵢ∫|q̇ᵢ|dt, and |q̇ᵢ| is at most 5/h times the
    /// greatest difference of the Bézier points of its quintic. From the nearer check each of two bodies has moved by half of that at
    /// most. So shapes that are farther apart than the clearance at every check never touch.
    ///
    /// Links that a joint connects are not looked at, as MuJoCo does, nor pairs that the model excludes.
    ///
    /// # Errors
    /// As [`SimulatedArm::execute`], and [`SimError::NoShapes`] where the arm has nothing to collide with.
    pub fn sweep(&mut self, trajectory: &JointTrajectory, options: &SweepOptions) -> Result<Sweep> {
        let clearance_m = options.clearance_m;
        if !(5e-4..=1.0).contains(&clearance_m) {
            let must_be = "from 0.0005 to 1";
            return Err(SimError::InvalidOption { name: "clearance_m", value: clearance_m, must_be });
        }
        let command = Command::new(trajectory, self.servos())?;
        let reaches = reaches(self.model(), self.servos())?;
        let counts = checks(&command, &reaches, clearance_m);
        let total = counts.iter().sum::<f64>() + 1.0;
        if total > MOST_CHECKS {
            return Err(SimError::TooManyChecks { checks: total, limit: MOST_CHECKS, clearance_m });
        }
        let mut probe = self.kinematic_twin(clearance_m)?;
        let (mut contacts, mut approaches) = (ContactLog::default(), ContactLog::default());
        let mut look = |time_s: f64| {
            for (servo, &value) in self.servos().iter().zip(command.at(time_s)[0].iter()) {
                probe.qpos_mut()[servo.position] = value;
            }
            probe.fwd_position();
            let near = touches(probe.model(), probe.contact(), clearance_m);
            contacts.record(time_s, near.iter().filter(|(_, touch)| touch.depth_m >= 0.0).cloned().collect());
            approaches.record(time_s, near);
        };
        let points = &trajectory.points;
        look(points[0].time_s);
        for (pair, &count) in points.windows(2).zip(&counts) {
            let h = pair[1].time_s - pair[0].time_s;
            (1..=count as usize).for_each(|k| look(pair[0].time_s + h * k as f64 / count));
        }
        let [contacts, approaches] = [contacts, approaches].map(ContactLog::into_events);
        Ok(Sweep { contacts, approaches, checks: total as usize })
    }
}

/// How many checks each interval of a trajectory needs.
fn checks(command: &Command<'_>, reaches: &[f64], clearance_m: f64) -> Vec<f64> {
    let interval = |joints: Vec<[f64; 6]>| {
        let greatest = |points: &[f64; 6]| points.windows(2).map(|p| (p[1] - p[0]).abs()).fold(0.0, f64::max);
        let way_m: f64 = joints.iter().zip(reaches).map(|(points, reach)| DEGREE * greatest(points) * reach).sum();
        (way_m / clearance_m).ceil().max(1.0)
    };
    command.bezier_points().map(interval).collect()
}
