//! A straight move of the joints from rest to rest.

use nalgebra::DVector;

use crate::audit::against;
use crate::error::Result;
use crate::holding::too_weak_for;
use crate::options::TimingOptions;
use crate::robot::Robot;
use crate::sampling::Sampling;
use crate::trajectory::{JointPoint, JointTrajectory};

/// The least duration of the quintic q = D(10τ³ − 15τ⁴ + 6τ⁵), τ = t/T, whose peaks are 15/8·D/T, 10/√3·D/T² and 60·D/T³.
pub(crate) fn least_duration(distance: f64, velocity: f64, acceleration: f64, jerk: f64) -> f64 {
    let by_velocity = 1.875 * distance / velocity;
    let by_acceleration = (10.0 / 3.0_f64.sqrt() * distance / acceleration).sqrt();
    by_velocity.max(by_acceleration).max((60.0 * distance / jerk).cbrt())
}

/// The straight line of the joints from `from` to `to`, both of shape (dof), as the quintic of least duration within the limits. The
/// quintics between its points are pieces of that quintic. Equal ends give a single point at rest.
///
/// # Errors
/// [`ManipulatorError`](crate::ManipulatorError) for malformed configurations or options,
/// [`BeyondLimits`](crate::ManipulatorError::BeyondLimits) for an end beyond a limit,
/// [`HoldingTorque`](crate::ManipulatorError::HoldingTorque) where a joint cannot hold the arm somewhere on the way.
pub fn rest_to_rest(
    robot: &Robot,
    from: &DVector<f64>,
    to: &DVector<f64>,
    options: &TimingOptions,
) -> Result<JointTrajectory> {
    let bounds = options.bounds(robot)?;
    let limits = &bounds.limits;
    robot.check_within_limits("the start of the move", from)?;
    robot.check_within_limits("the end of the move", to)?;
    let distance = to - from;
    // A part in ten thousand keeps rounding of the points below the limits.
    let mut least = 1.0001
        * (0..from.len())
            .map(|i| least_duration(distance[i].abs(), limits.velocity[i], limits.acceleration[i], limits.jerk[i]))
            .fold(0.0, f64::max);
    let sampling = Sampling { rate_hz: options.rate_hz, joint_names: robot.chain.joint_names() };
    for _ in 0..ATTEMPTS {
        let trajectory = straight(from, &distance, to, least, &sampling)?;
        let found = against(&bounds, &trajectory);
        if found.audit.limits_ok {
            return Ok(trajectory);
        }
        if !(found.slowdown > 1.0 && found.slowdown.is_finite()) {
            return Err(too_weak_for(&trajectory, &bounds).unwrap_or_else(|| bounds.not_met(found.audit)));
        }
        least = trajectory.duration_s() * found.slowdown * 1.001;
    }
    Err(bounds.not_met(against(&bounds, &straight(from, &distance, to, least, &sampling)?).audit))
}

/// Joint limits are met at once; torques and the tool's speed need a few more.
const ATTEMPTS: usize = 12;

fn straight(
    from: &DVector<f64>,
    distance: &DVector<f64>,
    to: &DVector<f64>,
    least: f64,
    sampling: &Sampling<'_>,
) -> Result<JointTrajectory> {
    let (steps, step_ns) = if least > 0.0 { sampling.steps(least)? } else { (0, 0) };
    let duration = Sampling::time(steps, step_ns);
    let points = (0..=steps)
        .map(|k| {
            let tau = if steps == 0 { 0.0 } else { k as f64 / steps as f64 };
            let way = tau.powi(3) * (10.0 - 15.0 * tau + 6.0 * tau * tau);
            let (mut speed, mut acceleration) = (0.0, 0.0);
            if k > 0 && k < steps {
                speed = 30.0 * tau * tau * (1.0 - tau) * (1.0 - tau) / duration;
                acceleration = 60.0 * tau * (1.0 - tau) * (1.0 - 2.0 * tau) / (duration * duration);
            }
            let position = if k == steps { to.clone() } else { from + distance * way };
            JointPoint {
                time_s: Sampling::time(k, step_ns),
                positions: position.iter().copied().collect(),
                velocities: distance.iter().map(|d| d * speed).collect(),
                accelerations: distance.iter().map(|d| d * acceleration).collect(),
            }
        })
        .collect();
    Ok(JointTrajectory { joint_names: sampling.joint_names.to_vec(), points })
}
