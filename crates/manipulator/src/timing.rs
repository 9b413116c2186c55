//! From a joint path to a legal trajectory.

use serde::Serialize;

use crate::arc_length::at_constant_speed;
use crate::audit::{Audit, Found, against, audit_under};
use crate::bounds::Bounds;
use crate::constant_speed;
use crate::error::{ManipulatorError, Result};
use crate::executed::strays;
use crate::gridpoints::{Coarse, even_grid};
use crate::holding::too_weak_along;
use crate::joint_path::JointPath;
use crate::optimise::Grid;
use crate::options::{JointLimits, TimingOptions};
use crate::robot::{Limits, Robot};
use crate::sampling::{Sampling, sample};
use crate::speed_profile::{Smoothed, SpeedProfile};
use crate::tightening::tighten;
use crate::trajectory::JointTrajectory;

/// A path in time.
#[derive(Debug, Clone, Serialize)]
pub struct TimedPath {
    /// What to execute.
    pub trajectory: JointTrajectory,
    /// When each input pose is passed, in s, increasing.
    pub knot_times_s: Vec<f64>,
    /// The trajectory judged against the robot's limits.
    pub audit: Audit,
    /// How far, in m, the executed tool may be from the path's between points: quintics deviate from what they interpolate. A bound at
    /// three places an interval; at 100 points a second and 50 rad/s³ some 1e-7.
    pub strays_m: f64,
    /// The same as an angle, in rad.
    pub strays_rad: f64,
    /// The least duration under limits of velocity and acceleration, of joints and tool, alone (TOPP2-RA), in s: with jerk limits it
    /// takes longer.
    pub second_order_duration_s: f64,
}

/// Published steps over which the profile is averaged: with two, a jump of the jerk becomes a ramp that quintics follow; a jump of the
/// acceleration needs one to become a ramp.
const WINDOW_STEPS: [f64; 2] = [2.0, 1.0];
/// A first solution that is broken by more between its gridpoints needs twice as many: it has bends that they miss.
pub(crate) const TOO_COARSE: f64 = 1.1;
/// Rounds of tightening limits where the audit finds them broken.
const TIGHTENINGS: usize = 6;
/// A slowdown by less than this is not worth another round.
const GOOD_ENOUGH: f64 = 1.005;
/// Joint travel, in rad or m, below which the optimiser stalls and a single quintic serves.
const TINY: f64 = 1e-3;

/// The fastest legal trajectory found along `path`, from rest to rest.
///
/// TOPP3 by sequential second-order cone programmes seeded with TOPP2-RA (that alone without jerk limits), averaged over two published
/// steps (one), audited as it will be executed, limits tightened where the audit finds them broken and solved again, at last
/// slowed down uniformly by what is still missing. Torques count from the first round in which one is too great. Paths
/// of less than a thousandth of a radian take one quintic from end to end.
///
/// # Errors
/// [`ManipulatorError::Timing`] where the optimiser fails, [`ManipulatorError::LimitsNotMet`] where no slowdown made
/// the trajectory legal, [`ManipulatorError::HoldingTorque`], [`ManipulatorError::ConstantSpeed`],
/// [`ManipulatorError::InvalidOption`], [`ManipulatorError::NonFinite`]. Never an illegal trajectory.
pub fn time_path(robot: &Robot, path: &JointPath, options: &TimingOptions) -> Result<TimedPath> {
    let bounds = options.bounds(robot)?;
    robot.check_configuration("the joint path", &path.at(path.domain().0)[0])?;
    let sampling = Sampling { rate_hz: options.rate_hz, joint_names: robot.chain.joint_names() };
    let travel = travel(path)?;
    let simple = || {
        let profile = single_quintic(path, travel, &bounds.limits, 1.0 / options.rate_hz);
        let duration = profile.duration();
        Optimised { duration, profile, legal: None, second_order_duration: duration }
    };
    let Optimised { duration, profile, legal, second_order_duration } = if travel < TINY {
        simple()
    } else {
        match optimised(path, &bounds, options, &sampling) {
            // The solver gave up, about once in three hundred random paths. A slow trajectory is legal all the same.
            Err(ManipulatorError::Timing { .. }) => simple(),
            Err(weak @ ManipulatorError::HoldingTorque { .. }) => {
                return Err(too_weak_along(path, &bounds).unwrap_or(weak));
            }
            other => other?,
        }
    };
    let (mut trajectory, mut audit) = match legal {
        Some(legal) => legal,
        None => slowed_until_legal(path, &profile, duration, &bounds, &sampling)?,
    };
    let mut profile = profile;
    if let Some(wanted) = options.constant_tool_speed_m_s {
        let check = |profile: &Smoothed, trajectory: &JointTrajectory| {
            constant_speed::check(&bounds, path, profile, trajectory, wanted)
        };
        if let Err(not_held) = check(&profile, &trajectory) {
            let held = at_constant_speed(path, &bounds, &sampling, wanted);
            let held = held.filter(|(profile, trajectory, _)| check(profile, trajectory).is_ok());
            (profile, trajectory, audit) = held.ok_or(not_held)?;
        }
    }
    let stretch = trajectory.duration_s() / profile.duration();
    let knot_times_s = path.pose_parameters().iter().map(|&s| profile.time_at(s) * stretch).collect();
    let audit = match bounds.limits == robot.limits {
        true => audit,
        false => audit_under(robot, &trajectory, options.audit_rules(), None),
    };
    let (strays_m, strays_rad) = strays(&robot.chain, path, &profile, &trajectory);
    let second_order_duration_s = second_order_duration;
    Ok(TimedPath { trajectory, knot_times_s, audit, strays_m, strays_rad, second_order_duration_s })
}

/// The least duration along `path`, from rest to rest, under limits of velocity and acceleration, of joints and tool, alone, in s:
/// one solution by TOPP2-RA on that many even intervals of the path's parameter, at least two.
///
/// It bounds what [`time_path`] can reach, as closely as the gridpoints resolve the path, and takes a few milliseconds.
///
/// # Errors
/// [`ManipulatorError::Timing`], [`ManipulatorError::InvalidOption`], [`ManipulatorError::NonFinite`],
/// [`ManipulatorError::WrongSize`] and [`ManipulatorError::InvalidJoint`] for a path or limits that are not the robot's.
pub fn least_duration_s(robot: &Robot, path: &JointPath, options: &TimingOptions, intervals: usize) -> Result<f64> {
    let bounds = options.bounds(robot)?;
    robot.check_configuration("the joint path", &path.at(path.domain().0)[0])?;
    let (_, times) = even_grid(path, &bounds, options, intervals.max(2))?.second_order(None)?;
    times.last().copied().ok_or(ManipulatorError::NonFinite { what: "the joint path" })
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

type Audited = (JointTrajectory, Audit);

struct Optimised {
    /// How long the profile takes once it is slowed down by what the audit found.
    duration: f64,
    profile: Smoothed,
    /// The trajectory and its audit, where it needs no slowdown.
    legal: Option<Audited>,
    second_order_duration: f64,
}

/// What finds a profile on given gridpoints.
pub(crate) struct Solver {
    jerk_limited: bool,
    window: f64,
}

impl Solver {
    pub(crate) fn new(options: &TimingOptions) -> Self {
        let jerk_limited = options.limits == JointLimits::Jerk;
        Self { jerk_limited, window: WINDOW_STEPS[usize::from(!jerk_limited)] / options.rate_hz }
    }

    /// The profile linearised about squared speeds, and its own.
    pub(crate) fn solve(&self, gridpoints: &Grid, about: Option<&[f64]>) -> Result<(Smoothed, Vec<f64>)> {
        let (profile, squared_speeds) = match self.jerk_limited {
            true => gridpoints.third_order(about)?,
            false => gridpoints.second_order_profile(about)?,
        };
        Ok((Smoothed::new(profile, self.window), squared_speeds))
    }
}

/// The best of several rounds of solving and tightening.
fn optimised(
    path: &JointPath,
    bounds: &Bounds<'_>,
    options: &TimingOptions,
    sampling: &Sampling<'_>,
) -> Result<Optimised> {
    let coarse = Coarse::new(path, bounds, options)?;
    let second_order_duration = coarse.duration();
    let mut gridpoints = coarse.grid(1)?;
    let solver = Solver::new(options);
    let mut seed: Option<Vec<f64>> = None;
    let mut best: Option<(f64, Smoothed, Option<Audited>)> = None;
    for round in 0..=TIGHTENINGS {
        let (profile, squared_speeds) = match solver.solve(&gridpoints, seed.as_deref()) {
            Ok(solution) => solution,
            // Tightening may have made the problem infeasible or ill-posed; what was found before still stands.
            Err(_) if best.is_some() => break,
            Err(error) => return Err(error),
        };
        let trajectory = sample(path, &profile, profile.duration(), sampling)?;
        let Found { audit, slowdown } = against(bounds, &trajectory);
        // The first solution is linearised about one without jerk limits; the second, about the first, is faster.
        let good_enough = slowdown < GOOD_ENOUGH && (round > 0 || !solver.jerk_limited);
        let too_coarse = round == 0 && slowdown > TOO_COARSE;
        let too_strong = bounds.rules.torque && audit.max_ratio.torque.is_some_and(|ratio| ratio > 1.0);
        seed = Some(squared_speeds);
        if too_coarse && !too_strong {
            gridpoints = coarse.grid(2)?;
            seed = None;
        } else if !good_enough {
            tighten(&mut gridpoints, bounds, &trajectory, &profile, too_strong);
        }
        if too_strong && !good_enough {
            // After the tightening: by how much torques are too great while nothing limits them says nothing of what will be left.
            gridpoints.limit_torque(bounds)?;
        }
        let duration = slowed(&trajectory, slowdown);
        if best.as_ref().is_none_or(|(least, ..)| duration < *least) {
            best = Some((duration, profile, audit.limits_ok.then_some((trajectory, audit))));
        }
        if good_enough {
            break;
        }
    }
    let (duration, profile, legal) =
        best.ok_or_else(|| ManipulatorError::Timing { reason: "no round was solved".into() })?;
    Ok(Optimised { duration, profile, legal, second_order_duration })
}

/// How long a trajectory takes when it is slowed down by that much: a thousandth more, so that a few rounds suffice and no
/// reader's rounding breaks a limit.
fn slowed(trajectory: &JointTrajectory, slowdown: f64) -> f64 {
    trajectory.duration_s() * if slowdown > 1.0 { (slowdown * 1.001).max(1.0005) } else { 1.0 }
}

/// Samples ever slower, at first over `duration`, until the audit passes, and that audit.
fn slowed_until_legal(
    path: &JointPath,
    profile: &Smoothed,
    mut duration: f64,
    bounds: &Bounds<'_>,
    sampling: &Sampling<'_>,
) -> Result<(JointTrajectory, Audit)> {
    const ATTEMPTS: usize = 12;
    // What no slowdown makes legal is to be refused for the reason that its own speed shows.
    if !duration.is_finite() {
        duration = profile.duration();
    }
    let mut attempt = 0;
    loop {
        let trajectory = sample(path, profile, duration, sampling)?;
        let Found { audit, slowdown } = against(bounds, &trajectory);
        if audit.limits_ok {
            return Ok((trajectory, audit));
        }
        attempt += 1;
        // Where no slowdown helps, a position limit is broken, or holding the arm alone takes too much torque.
        if attempt == ATTEMPTS || slowdown <= 1.0 || slowdown.is_infinite() {
            let weak = slowdown.is_infinite().then(|| too_weak_along(path, bounds)).flatten();
            return Err(weak.unwrap_or_else(|| bounds.not_met(audit)));
        }
        duration = slowed(&trajectory, slowdown);
        if !duration.is_finite() {
            return Err(ManipulatorError::NonFinite { what: "the timed path" });
        }
    }
}
