//! Points of a trajectory from a path and its speed.

use crate::error::{ManipulatorError, Result};
use crate::joint_path::JointPath;
use crate::speed_profile::Smoothed;
use crate::trajectory::{JointPoint, JointTrajectory};

pub(crate) struct Sampling<'a> {
    pub(crate) rate_hz: f64,
    pub(crate) joint_names: &'a [String],
}

/// Most points of a trajectory: five hours at 100 a second. More is a mistake, and would exhaust the memory.
const MOST_POINTS: usize = 2_000_000;

impl Sampling<'_> {
    /// How many equal steps of whole nanoseconds, none longer than a period, make up at least `duration`; and their length in ns.
    pub(crate) fn steps(&self, duration: f64) -> Result<(usize, u64)> {
        // Written so that NaN is too long.
        let few_enough = duration * self.rate_hz < MOST_POINTS as f64;
        if !few_enough {
            let (duration_s, rate_hz) = (duration, self.rate_hz);
            return Err(ManipulatorError::TooLong { duration_s, rate_hz, most: MOST_POINTS });
        }
        // A duration of whole periods must not gain a step by rounding.
        let steps = ((duration * self.rate_hz - 1e-9).ceil() as usize).max(1);
        let step_ns = (duration * 1e9 / steps as f64 - 1e-6).ceil().max(1.0) as u64;
        Ok((steps, step_ns))
    }

    /// Time of point `k` in s.
    pub(crate) fn time(k: usize, step_ns: u64) -> f64 {
        (k as u64 * step_ns) as f64 * 1e-9
    }
}

/// The path run through in `duration` (rounded up to whole steps), the profile's own duration stretched evenly.
///
/// # Errors
/// [`ManipulatorError::TooLong`].
pub(crate) fn sample(
    path: &JointPath,
    profile: &Smoothed,
    duration: f64,
    sampling: &Sampling<'_>,
) -> Result<JointTrajectory> {
    let (steps, step_ns) = sampling.steps(duration)?;
    let stretch = Sampling::time(steps, step_ns) / profile.duration();
    let points = (0..=steps)
        .map(|k| {
            let time_s = Sampling::time(k, step_ns);
            let [s, speed, acceleration] = if k == steps {
                [path.domain().1, 0.0, 0.0]
            } else if k == 0 {
                [path.domain().0, 0.0, 0.0]
            } else {
                profile.at(time_s / stretch)
            };
            let (speed, acceleration) = (speed / stretch, acceleration / (stretch * stretch));
            let joints = path.joints_at(s);
            let dof = joints.len();
            let [mut positions, mut velocities, mut accelerations] = [(); 3].map(|()| Vec::with_capacity(dof));
            for [q, dq, ddq, _] in joints {
                positions.push(q);
                velocities.push(dq * speed);
                accelerations.push(dq * acceleration + ddq * (speed * speed));
            }
            JointPoint { time_s, positions, velocities, accelerations }
        })
        .collect();
    Ok(JointTrajectory { joint_names: sampling.joint_names.to_vec(), points })
}
