//! Whether the tool keeps a constant speed between its ramps, and what speed it could keep.

use nalgebra::DVector;

use crate::bounds::Bounds;
use crate::error::{ManipulatorError, Result};
use crate::joint_path::JointPath;
use crate::speed_profile::Smoothed;
use crate::trajectory::JointTrajectory;

/// Part of the wanted speed by which the tool's may differ from it.
const TOLERANCE: f64 = 0.01;
/// Part of what the limits allow at the narrowest place that is held in practice: the audit's corrections take the rest.
const HELD: f64 = 0.95;
/// Two ramps that just meet are within the tolerance of their peak for up to 0.14 of a ramp: their speeds differ from it by Jt²/2, and
/// the ramps take at least 2√(v/J). A speed that is to count as held lasts longer.
const TOUCHED: f64 = 0.2;
/// Part of the peak of two ramps that meet which lasts long enough: under acceleration limits alone, for 2·0.15/0.85 of a ramp.
const BELOW_PEAK: f64 = 0.85;
/// Places between two published points at which the tool's speed is looked at.
const PARTS: usize = 10;

/// Judges the executed quintics.
pub(crate) fn check(
    bounds: &Bounds<'_>,
    path: &JointPath,
    profile: &Smoothed,
    trajectory: &JointTrajectory,
    wanted: f64,
) -> Result<()> {
    let step = trajectory.duration_s() / (PARTS * (trajectory.points.len() - 1)).max(1) as f64;
    let speeds: Vec<f64> = (0..=PARTS * (trajectory.points.len() - 1))
        .map(|k| {
            let [q, rates, accelerations, _] = trajectory.at(k as f64 * step);
            bounds.chain.tool_motion(&q, &rates, &accelerations).0.norm()
        })
        .collect();
    let reached = |speed: f64| {
        let fast = |other: &f64| *other >= speed;
        speeds.iter().position(fast).zip(speeds.iter().rposition(fast))
    };
    let longer_than_touched = |&(from, to): &(usize, usize)| {
        let shorter_ramp = from.min(speeds.len() - 1 - to) as f64;
        (to - from) as f64 > TOUCHED * shorter_ramp
    };
    let held = reached((1.0 - TOLERANCE) * wanted).filter(longer_than_touched);
    let off = |speed: &f64| (speed / wanted - 1.0).abs() > TOLERANCE;
    if held.is_some_and(|(from, to)| !speeds[from..=to].iter().any(off)) {
        return Ok(());
    }
    let stretch = trajectory.duration_s() / profile.duration();
    let place = |k: usize| profile.at(k as f64 * step / stretch)[0];
    let below_peak = BELOW_PEAK * speeds.iter().copied().fold(0.0, f64::max);
    let between = held.or_else(|| reached(below_peak)).filter(|(from, to)| from < to);
    let narrowest = between.map(|(from, to)| narrowest(bounds, path, place(from), place(to)));
    let (pose, greatest_m_s) = match narrowest {
        Some((s, greatest)) if held.is_some() || HELD * greatest < below_peak => {
            let pose = path.pose_parameters().partition_point(|&parameter| parameter <= s).max(1) - 1;
            (Some(pose), HELD * greatest)
        }
        _ => (None, below_peak),
    };
    Err(ManipulatorError::ConstantSpeed { pose, wanted_m_s: wanted, greatest_m_s })
}

/// Where between two parameters the limits of joints and tool allow the least constant tool speed, and which.
///
/// With the tool's arc length ℓ, dℓ/ds = ‖p′‖ = σ, at unit speed ṡ = 1/σ, s̈ = −σ′/σ³ and s⃛ = ṡ·ds̈/ds; joint velocities, accelerations
/// and jerks go with the first, second and third power of the speed.
fn narrowest(bounds: &Bounds<'_>, path: &JointPath, from: f64, to: f64) -> (f64, f64) {
    const PLACES: usize = 2000;
    let unit = |s: f64| {
        let [q, first, second, third] = path.at(s);
        let (velocity, acceleration) = bounds.chain.tool_motion(&q, &first, &second);
        let sigma = velocity.norm();
        let slope = velocity.dot(&acceleration) / sigma;
        (first, second, third, velocity, acceleration, 1.0 / sigma, -slope / sigma.powi(3))
    };
    let h = (to - from) / PLACES as f64;
    let limits = &bounds.limits;
    let speed_at = |s: f64| -> f64 {
        let (first, second, third, velocity, acceleration, rate, change) = unit(s);
        let snap = rate * (unit(s + 0.5 * h).6 - unit(s - 0.5 * h).6) / h;
        let rates = &first * rate;
        let accelerations = &second * (rate * rate) + &first * change;
        let jerks = third * rate.powi(3) + second * (3.0 * rate * change) + first * snap;
        let ratio = |values: &DVector<f64>, limits: &DVector<f64>| values.component_div(limits).amax();
        let mut need = ratio(&rates, &limits.velocity).max(ratio(&accelerations, &limits.acceleration).sqrt());
        if bounds.rules.jerk {
            need = need.max(ratio(&jerks, &limits.jerk).cbrt());
        }
        if let Some(most) = bounds.rules.tool_acceleration_m_s2 {
            need = need.max(((acceleration * (rate * rate) + velocity * change).norm() / most).sqrt());
        }
        // Where the tool turns on the spot nothing is a number, and no speed can be held.
        if rate.is_finite() && need.is_finite() && need > 0.0 { 1.0 / need } else { 0.0 }
    };
    (1..PLACES)
        .map(|k| from + h * k as f64)
        .map(|s| (s, speed_at(s)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((from, 0.0))
}
