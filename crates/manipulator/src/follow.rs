//! From a curve of tool poses to a path of the joints.

use nalgebra::DVector;
use se3_geom::{Pose, PoseSpline};
use serde::Deserialize;

use crate::branches::first_configurations;
use crate::continuation::{Sample, Stopped, Tracker};
use crate::error::{ManipulatorError, Result};
use crate::ik::{IkOptions, PoseError, descend};
use crate::joint_path::JointPath;
use crate::quintic_spline::{EndDerivatives, QuinticSpline};
use crate::robot::Robot;

/// How closely the joints follow the curve.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PathOptions {
    /// Greatest distance of the tool from the curve, also between samples, in m.
    pub tolerance_m: f64,
    /// Greatest angle of the tool from the curve, in rad.
    pub tolerance_rad: f64,
    /// Least singular value of the body Jacobian (rows in m and rad) that is not yet a singularity. At 5e-3 some joint turns 200 rad
    /// for each rad or m of the tool.
    pub least_singular_value: f64,
    /// How many different configurations at the first pose are tried.
    pub max_branches: usize,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self { tolerance_m: 1e-4, tolerance_rad: 1e-3, least_singular_value: 5e-3, max_branches: 16 }
    }
}

impl PathOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// [`ManipulatorError::InvalidOption`].
    pub fn check(&self) -> Result<()> {
        // Samples are solved to 1e-9: tolerances far above that can be met by refinement.
        let bounded = [
            ("tolerance_m", self.tolerance_m, 1e-7),
            ("tolerance_rad", self.tolerance_rad, 1e-7),
            ("least_singular_value", self.least_singular_value, 1e-9),
            ("max_branches", self.max_branches as f64, 1.0),
        ];
        match bounded.into_iter().find(|(_, value, least)| !(value.is_finite() && value >= least)) {
            Some((name, value, _)) => {
                Err(ManipulatorError::InvalidOption { name, value, must_be: "finite and not that small" })
            }
            None => Ok(()),
        }
    }
}

/// Rounds of halving samples until the joint spline is within tolerance.
const MAX_REFINEMENTS: usize = 12;
/// The wanted bound on the ratio of neighbouring sample spacings: a spline through very uneven samples swings.
const MAX_SPACING_RATIO: f64 = 4.01;

/// The joint path that keeps the tool on `curve` (poses `base_from_tool`).
///
/// Every configuration found for the first pose (several elbows, wrists, whole turns) is followed by continuation along the curve; of
/// those that reach the end the one with the shortest time at the velocity limits is taken, the way from the
/// reference to the first pose included. The reference is `start` where given, else the robot's preferred configuration.
/// At the ends the path has the first and second derivatives that the curve's twist and acceleration ask for.
///
/// # Errors
/// That of the attempt that came farthest: [`ManipulatorError::Unreachable`], [`ManipulatorError::JointLimit`],
/// [`ManipulatorError::Singular`], [`ManipulatorError::Jump`] or [`ManipulatorError::PathTolerance`], with the index of the pose.
pub fn follow(
    robot: &Robot,
    curve: &PoseSpline,
    start: Option<&DVector<f64>>,
    options: &PathOptions,
) -> Result<JointPath> {
    options.check()?;
    let reference = start.unwrap_or(&robot.preferred);
    robot.check_configuration("the start configuration", reference)?;
    let tracker = Tracker { robot, curve, least_singular_value: options.least_singular_value };
    let first = curve.pose(curve.domain().0);
    let mut open = first_configurations(robot, &first, reference)?;
    open.truncate(options.max_branches);
    let mut followed: Vec<(f64, Vec<Sample>)> = Vec::new();
    let mut farthest: Option<Stopped> = None;
    let mut next = 0;
    while next < open.len() {
        match tracker.track(&open[next]) {
            Ok(samples) => followed.push((cost(robot, reference, &samples), samples)),
            Err(stopped) => {
                let turned = turned_away_from_limit(robot, &open[next], &stopped);
                if let Some(q) = turned.filter(|q| open.len() < 2 * options.max_branches && is_new(&open, q)) {
                    open.push(q);
                }
                if farthest.as_ref().is_none_or(|f| stopped.parameter > f.parameter) {
                    farthest = Some(stopped);
                }
            }
        }
        next += 1;
    }
    followed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut first_error = None;
    for (_, samples) in followed {
        match spline_within_tolerance(&tracker, samples, options) {
            Ok(path) => return Ok(path),
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    Err(match (first_error, farthest) {
        (Some(error), _) => error,
        (None, Some(stopped)) => named(&tracker, stopped),
        // No configuration was found at the first pose, and that is reported by `first_configurations`.
        (None, None) => ManipulatorError::NonFinite { what: "the curve" },
    })
}

/// Time that approach and path take at the joints' velocity limits, in s: a lower bound of the true duration.
fn cost(robot: &Robot, reference: &DVector<f64>, samples: &[Sample]) -> f64 {
    let time = |from: &DVector<f64>, to: &DVector<f64>| (to - from).component_div(&robot.limits.velocity).amax();
    time(reference, &samples[0].q) + samples.windows(2).map(|pair| time(&pair[0].q, &pair[1].q)).sum::<f64>()
}

/// The same arm pose with the joint that ran into its limit turned a whole turn back, if its limits allow.
fn turned_away_from_limit(robot: &Robot, q: &DVector<f64>, stopped: &Stopped) -> Option<DVector<f64>> {
    let ManipulatorError::JointLimit { joint, value, upper, .. } = &stopped.error else { return None };
    let index = robot.chain.joint_names().iter().position(|name| name == joint)?;
    let mut turned = q.clone();
    turned[index] += if value > upper { -std::f64::consts::TAU } else { std::f64::consts::TAU };
    (robot.chain.is_rotary(index) && robot.limits.first_violation(&turned).is_none()).then_some(turned)
}

/// Branches come nearer to each other than this only where they meet, at a singularity.
const SAME_BRANCH: f64 = 1e-3;

pub(crate) fn is_new(known: &[DVector<f64>], q: &DVector<f64>) -> bool {
    known.iter().all(|k| (k - q).amax() > SAME_BRANCH)
}

/// An error on the way to a pose, made more telling: if that very pose is out of reach, by how much.
fn named(tracker: &Tracker<'_>, stopped: Stopped) -> ManipulatorError {
    let Stopped { error, last, pose, .. } = stopped;
    let target = tracker.curve.pose(tracker.curve.knots()[pose]);
    match (&error, descend(&tracker.robot.chain, &target, &last, &IkOptions::default(), None)) {
        (ManipulatorError::JointLimit { .. }, _) | (_, Ok(_)) => error,
        (_, Err(left)) => ManipulatorError::Unreachable {
            pose,
            position_error_m: left.position_m,
            rotation_error_rad: left.rotation_rad,
        },
    }
}

/// Splines the samples and halves their spacing wherever the tool leaves the curve in between.
fn spline_within_tolerance(
    tracker: &Tracker<'_>,
    mut samples: Vec<Sample>,
    options: &PathOptions,
) -> Result<JointPath> {
    let mut worst = (0.0, PoseError { position_m: 0.0, rotation_rad: 0.0 });
    for _ in 0..=MAX_REFINEMENTS {
        let spline = through(tracker, &samples)?;
        let mut too_far: Vec<bool> = Vec::with_capacity(samples.len() - 1);
        worst.1 = PoseError { position_m: 0.0, rotation_rad: 0.0 };
        for (i, pair) in samples.windows(2).enumerate() {
            let h = pair[1].s - pair[0].s;
            let mut good = true;
            for local in [0.25 * h, 0.5 * h, 0.75 * h] {
                let [q, ..] = spline.in_segment(i, local);
                let error = off_curve(tracker, &q, &tracker.curve.pose(pair[0].s + local));
                good &= error.within(options.tolerance_m, options.tolerance_rad);
                good &= tracker.robot.limits.first_violation(&q).is_none();
                if error.position_m > worst.1.position_m {
                    worst = (pair[0].s + local, error);
                }
            }
            too_far.push(!good);
        }
        if !too_far.contains(&true) {
            return Ok(JointPath::with_poses_at(spline, tracker.curve.knots().to_vec()));
        }
        samples = refine(tracker, &spline, &samples, too_far)?;
    }
    Err(ManipulatorError::PathTolerance {
        pose: tracker.pose_after(worst.0),
        position_error_m: worst.1.position_m,
        rotation_error_rad: worst.1.rotation_rad,
    })
}

fn off_curve(tracker: &Tracker<'_>, q: &DVector<f64>, target: &Pose) -> PoseError {
    PoseError::between(&tracker.robot.chain.forward(q), target)
}

fn through(tracker: &Tracker<'_>, samples: &[Sample]) -> Result<QuinticSpline> {
    let knots: Vec<f64> = samples.iter().map(|sample| sample.s).collect();
    let values: Vec<DVector<f64>> = samples.iter().map(|sample| sample.q.clone()).collect();
    let end =
        |sample: &Sample| EndDerivatives { first: sample.rate.clone(), second: tracker.second_derivative(sample) };
    QuinticSpline::through(&knots, &values, [&end(&samples[0]), &end(&samples[samples.len() - 1])])
}

/// Puts a sample into the middle of every marked interval, and of every one that is far longer than a neighbour.
fn refine(
    tracker: &Tracker<'_>,
    spline: &QuinticSpline,
    samples: &[Sample],
    mut marked: Vec<bool>,
) -> Result<Vec<Sample>> {
    let new_length = |i: usize, marked: &[bool]| (samples[i + 1].s - samples[i].s) * if marked[i] { 0.5 } else { 1.0 };
    loop {
        let uneven = (0..marked.len()).find(|&i| {
            let neighbours = [i.checked_sub(1), (i + 1 < marked.len()).then_some(i + 1)];
            let shortest =
                neighbours.into_iter().flatten().map(|k| new_length(k, &marked)).fold(f64::INFINITY, f64::min);
            !marked[i] && new_length(i, &marked) > MAX_SPACING_RATIO * shortest
        });
        let Some(i) = uneven else { break };
        marked[i] = true;
    }
    let mut refined = Vec::with_capacity(2 * samples.len());
    for (i, sample) in samples.iter().enumerate() {
        refined.push(sample.clone());
        if marked.get(i) == Some(&true) {
            let half = 0.5 * (samples[i + 1].s - sample.s);
            let [seed, ..] = spline.in_segment(i, half);
            refined.push(tracker.sample(sample.s + half, &seed)?);
        }
    }
    Ok(refined)
}
