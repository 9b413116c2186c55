//! From a joint path to a legal trajectory.

use serde::{Deserialize, Serialize};

use crate::audit::{Audit, MaxRatio, against, audit, peaks};
use crate::error::{ManipulatorError, Result};
use crate::joint_path::JointPath;
use crate::optimise::Grid;
use crate::robot::{Limits, Robot};
use crate::sampling::{Sampling, sample};
use crate::speed_profile::{Smoothed, SpeedProfile};
use crate::trajectory::JointTrajectory;

/// How a path is put into time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TimingOptions {
    /// Published points per second, from 10 to 10,000.
    pub rate_hz: f64,
    /// Part of the velocity limits to use, from 0.001 to 1.
    pub velocity_scale: f64,
    /// Part of the acceleration limits to use, from 0.001 to 1.
    pub acceleration_scale: f64,
    /// Part of the jerk limits to use, from 0.001 to 1.
    pub jerk_scale: f64,
}

impl Default for TimingOptions {
    fn default() -> Self {
        Self { rate_hz: 100.0, velocity_scale: 1.0, acceleration_scale: 1.0, jerk_scale: 1.0 }
    }
}

impl TimingOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// [`ManipulatorError::InvalidOption`].
    pub fn check(&self) -> Result<()> {
        let invalid = |name, value, must_be| Err(ManipulatorError::InvalidOption { name, value, must_be });
        // Below ten points a second the quintics between points leave the path by more than its tolerance.
        if !(self.rate_hz >= 10.0 && self.rate_hz <= 10_000.0) {
            return invalid("rate_hz", self.rate_hz, "from 10 to 10000");
        }
        let scales = [
            ("velocity_scale", self.velocity_scale),
            ("acceleration_scale", self.acceleration_scale),
            ("jerk_scale", self.jerk_scale),
        ];
        for (name, value) in scales {
            if !(1e-3..=1.0).contains(&value) {
                return invalid(name, value, "from 0.001 to 1");
            }
        }
        Ok(())
    }

    pub(crate) fn limits(&self, robot: &Robot) -> Result<Limits> {
        self.check()?;
        let mut limits = robot.limits.clone();
        limits.velocity *= self.velocity_scale;
        limits.acceleration *= self.acceleration_scale;
        limits.jerk *= self.jerk_scale;
        Ok(limits)
    }
}

/// A path in time.
#[derive(Debug, Clone, Serialize)]
pub struct TimedPath {
    /// What to execute.
    pub trajectory: JointTrajectory,
    /// When each input pose is passed, in s, increasing.
    pub knot_times_s: Vec<f64>,
    /// The trajectory judged against the robot's limits.
    pub audit: Audit,
    /// The least duration under velocity and acceleration limits alone (TOPP2-RA), in s: with jerk limits it takes longer.
    pub second_order_duration_s: f64,
}

/// Published steps over which the profile is averaged: with two, a jump of the jerk becomes a ramp that quintics follow.
const WINDOW_STEPS: f64 = 2.0;
/// Gridpoints for the first, second-order pass; a bend that is shorter than two of them would be missed.
const COARSE_POINTS: usize = 1000;
/// A jerk of ten accelerations a second has a tenth of a second to build up an acceleration: three intervals resolve it.
const GRIDPOINTS_PER_SECOND: f64 = 30.0;
/// A first solution that is broken by more between its gridpoints needs twice as many: it has bends that they miss.
const TOO_COARSE: f64 = 1.1;
/// Rounds of tightening limits where the audit finds them broken.
const TIGHTENINGS: usize = 5;
/// A slowdown by less than this is not worth another round.
const GOOD_ENOUGH: f64 = 1.005;
/// Joint travel, in rad or m, below which the optimiser stalls and a single quintic serves.
const TINY: f64 = 1e-3;

/// The fastest legal trajectory found along `path`, from rest to rest.
///
/// TOPP3 by sequential second-order cone programmes seeded with TOPP2-RA, averaged over two published steps, audited as it will be
/// executed, limits tightened where the audit finds them broken and solved again, at last slowed down uniformly by what is
/// still missing. Paths of less than a thousandth of a radian take one quintic from end to end.
///
/// # Errors
/// [`ManipulatorError::Timing`] where the optimiser fails, [`ManipulatorError::LimitsNotMet`] where no slowdown made
/// the trajectory legal, [`ManipulatorError::InvalidOption`], [`ManipulatorError::NonFinite`]. Never an illegal trajectory.
pub fn time_path(robot: &Robot, path: &JointPath, options: &TimingOptions) -> Result<TimedPath> {
    let limits = options.limits(robot)?;
    robot.check_configuration("the joint path", &path.at(path.domain().0)[0])?;
    let sampling = Sampling { rate_hz: options.rate_hz, joint_names: robot.chain.joint_names() };
    let travel = travel(path)?;
    let simple = || {
        let profile = single_quintic(path, travel, &limits, 1.0 / options.rate_hz);
        let duration = profile.duration();
        (profile, duration)
    };
    let (profile, second_order_duration_s) = if travel < TINY {
        simple()
    } else {
        match optimised(path, &limits, &sampling) {
            // The solver gave up, about once in three hundred random paths. A slow trajectory is legal all the same.
            Err(ManipulatorError::Timing { .. }) => simple(),
            other => other?,
        }
    };
    let trajectory = slowed_until_legal(path, &profile, &limits, &sampling)?;
    let stretch = trajectory.duration_s() / profile.duration();
    let knot_times_s = path.pose_parameters().iter().map(|&s| profile.time_at(s) * stretch).collect();
    let audit = audit(robot, &trajectory);
    Ok(TimedPath { trajectory, knot_times_s, audit, second_order_duration_s })
}

/// Places between two knots at which travel is measured.
const TRAVEL_PARTS: usize = 8;

/// The greatest way that any joint makes along the path, up and down counted.
fn travel(path: &JointPath) -> Result<f64> {
    // Between knots too, where a spline may swing out and come back.
    let parts = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        (0..TRAVEL_PARTS).map(move |k| from + (to - from) * k as f64 / TRAVEL_PARTS as f64)
    };
    let parameters = path.knots().windows(2).flat_map(parts).chain([path.domain().1]);
    let positions: Vec<_> = parameters.map(|s| path.at(s)[0].clone()).collect();
    let mut sum = positions[0].map(|_| 0.0);
    for pair in positions.windows(2) {
        sum += (&pair[1] - &pair[0]).abs();
    }
    if sum.iter().all(|x: &f64| x.is_finite()) {
        Ok(sum.amax())
    } else {
        Err(ManipulatorError::NonFinite { what: "the joint path" })
    }
}

/// One quintic over the whole path, as fast as the rest-to-rest move of its greatest joint travel; what the path's bends
/// add is left to the slowdown.
fn single_quintic(path: &JointPath, travel: f64, limits: &Limits, shortest: f64) -> Smoothed {
    let (first, last) = path.domain();
    let duration = crate::rest_to_rest::least_duration(
        travel,
        limits.velocity.min(),
        limits.acceleration.min(),
        limits.jerk.min(),
    );
    let profile = SpeedProfile::through(vec![0.0, duration.max(shortest)], &[[first, 0.0, 0.0], [last, 0.0, 0.0]]);
    Smoothed::new(profile, 0.0)
}

/// The best of several rounds of solving and tightening, with the duration of the second-order solution.
fn optimised(path: &JointPath, limits: &Limits, sampling: &Sampling<'_>) -> Result<(Smoothed, f64)> {
    let (mut gridpoints, second_order_duration) = grid(path, limits, 1)?;
    let mut coarse = true;
    let mut best: Option<(f64, Smoothed)> = None;
    for _ in 0..=TIGHTENINGS {
        let profile = match gridpoints.third_order() {
            Ok(profile) => Smoothed::new(profile, WINDOW_STEPS / sampling.rate_hz),
            // Tightening may have made the problem infeasible or ill-posed; what was found before still stands.
            Err(_) if best.is_some() => break,
            Err(error) => return Err(error),
        };
        let trajectory = sample(path, &profile, profile.duration(), sampling)?;
        let slowdown = slowdown(&against(limits, &trajectory).max_ratio);
        let duration = profile.duration() * slowdown.max(1.0);
        if coarse && slowdown > TOO_COARSE {
            gridpoints = grid(path, limits, 2)?.0;
        } else {
            tighten(&mut gridpoints, limits, &trajectory, &profile);
        }
        coarse = false;
        if best.as_ref().is_none_or(|(least, _)| duration < *least) {
            best = Some((duration, profile));
        }
        if slowdown < GOOD_ENOUGH {
            break;
        }
    }
    let (_, profile) = best.ok_or_else(|| ManipulatorError::Timing { reason: "no round was solved".into() })?;
    Ok((profile, second_order_duration))
}

/// Gridpoints that share the path and its second-order time evenly, half and half.
fn grid(path: &JointPath, limits: &Limits, density: usize) -> Result<(Grid, f64)> {
    let (first, last) = path.domain();
    let coarse = COARSE_POINTS.max(4 * path.knots().len());
    let even: Vec<f64> = (0..=coarse).map(|k| first + (last - first) * k as f64 / coarse as f64).collect();
    let (_, times) = Grid::new(path, even.clone(), 1.0 / (last - first), limits)?.second_order()?;
    let duration = times[coarse];
    let share = |k: usize| 0.5 * (k as f64 / coarse as f64 + times[k] / duration);
    let points = ((duration * GRIDPOINTS_PER_SECOND) as usize).max(path.knots().len()).clamp(100, 400) * density;
    let mut parameters = Vec::with_capacity(points + 1);
    let mut k = 0;
    for i in 0..=points {
        let wanted = i as f64 / points as f64;
        while k + 1 < coarse && share(k + 1) < wanted {
            k += 1;
        }
        let fraction = ((wanted - share(k)) / (share(k + 1) - share(k))).clamp(0.0, 1.0);
        parameters.push(even[k] + fraction * (even[k + 1] - even[k]));
    }
    parameters[points] = last;
    Ok((Grid::new(path, parameters, duration / (last - first), limits)?, duration))
}

/// By how much a trajectory must be stretched in time for its peaks to come down to the limits.
fn slowdown(ratio: &MaxRatio) -> f64 {
    ratio.velocity.max(ratio.acceleration.sqrt()).max(ratio.jerk.cbrt())
}

/// Lowers the limits at the gridpoints around every place where the trajectory breaks them.
fn tighten(grid: &mut Grid, limits: &Limits, trajectory: &JointTrajectory, profile: &Smoothed) {
    let dof = limits.lower.len();
    let n = grid.parameters.len();
    let mut worst = vec![[1.0_f64; 3]; dof * n];
    for interval in 0..trajectory.points.len() - 1 {
        let [from, to] = [interval, interval + 1].map(|k| profile.at(trajectory.points[k].time_s)[0]);
        let low = grid.parameters.partition_point(|&s| s <= from).clamp(1, n - 1) - 1;
        let high = grid.parameters.partition_point(|&s| s < to).clamp(1, n - 1);
        for (joint, peak) in peaks(limits, trajectory, interval).enumerate() {
            for station in low..=high {
                let entry = &mut worst[station * dof + joint];
                entry.iter_mut().zip(peak.ratios).for_each(|(w, ratio)| *w = w.max(ratio));
            }
        }
    }
    for station in 0..n {
        for joint in 0..dof {
            for (kind, ratio) in worst[station * dof + joint].into_iter().enumerate() {
                if ratio > 1.0 {
                    grid.limits[kind][(joint, station)] *= 0.99 / ratio;
                }
            }
        }
    }
}

/// Samples ever slower until the audit passes.
fn slowed_until_legal(
    path: &JointPath,
    profile: &Smoothed,
    limits: &Limits,
    sampling: &Sampling<'_>,
) -> Result<JointTrajectory> {
    const ATTEMPTS: usize = 12;
    let mut duration = profile.duration();
    let mut last = None;
    for _ in 0..ATTEMPTS {
        let trajectory = sample(path, profile, duration, sampling)?;
        let found = against(limits, &trajectory);
        if found.limits_ok {
            return Ok(trajectory);
        }
        last = Some(found);
        if slowdown(&found.max_ratio) <= 1.0 {
            // A position limit is broken, and no slowdown cures that.
            break;
        }
        // A thousandth of margin, so that a few rounds suffice and no reader's rounding breaks a limit.
        duration = trajectory.duration_s() * (slowdown(&found.max_ratio) * 1.001).max(1.0005);
        if !duration.is_finite() {
            return Err(ManipulatorError::NonFinite { what: "the timed path" });
        }
    }
    let ratio = last.map(|found| found.max_ratio);
    let ratio = ratio.unwrap_or(MaxRatio { velocity: f64::NAN, acceleration: f64::NAN, jerk: f64::NAN });
    Err(ManipulatorError::LimitsNotMet {
        velocity: ratio.velocity,
        acceleration: ratio.acceleration,
        jerk: ratio.jerk,
        position_margin: last.map_or(f64::NAN, |found| found.position_margin),
    })
}
