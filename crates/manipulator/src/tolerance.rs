//! The joint spline whose tool stays within tolerance of the curve everywhere, not only at samples.

use nalgebra::DVector;

use crate::continuation::{Sample, Stopped, Tracker};
use crate::error::{ManipulatorError, Result};
use crate::follow::PathOptions;
use crate::ik::PoseError;
use crate::joint_path::JointPath;
use crate::quintic_spline::{EndDerivatives, QuinticSpline};

/// Rounds of halving samples until the joint spline is within tolerance.
const MAX_REFINEMENTS: usize = 12;
/// The wanted bound on the ratio of neighbouring sample spacings: a spline through very uneven samples swings.
const MAX_SPACING_RATIO: f64 = 4.01;
/// What is left of the tool's error at a sample, in m and rad: twice what inverse kinematics leaves.
const AT_SAMPLE: f64 = 2e-9;
/// Halvings of an interval after which a bound that is still above the tolerance counts as a miss.
const MAX_HALVINGS: usize = 7;
/// By how much the curve's turning may be above the greatest of its values at the ends and the middle of an interval.
const TURNING_MARGIN: f64 = 1.5;

/// Splines the samples and halves their spacing wherever the tool leaves the curve, or a joint its limits, in between.
pub(crate) fn spline_within_tolerance(
    tracker: &Tracker<'_>,
    mut samples: Vec<Sample>,
    options: &PathOptions,
) -> std::result::Result<JointPath, Stopped> {
    let mut worst = None;
    for _ in 0..=MAX_REFINEMENTS {
        let spline = through(tracker, &samples).map_err(|error| tracker.stopped(samples[0].s, error))?;
        worst = None;
        let mut marked: Vec<bool> = Vec::with_capacity(samples.len() - 1);
        for (i, pair) in samples.windows(2).enumerate() {
            let miss = Interval { tracker, spline: &spline, index: i, from: pair[0].s, length: pair[1].s - pair[0].s }
                .miss(options)
                .err();
            marked.push(miss.is_some());
            worst = worst.or(miss.map(|error| tracker.stopped(pair[0].s, error)));
        }
        if worst.is_none() {
            return Ok(JointPath::with_poses_at(spline, tracker.curve.knots().to_vec()));
        }
        samples = refine(tracker, &spline, &samples, marked)?;
    }
    let nowhere = || tracker.stopped(samples[0].s, ManipulatorError::SplineSingular);
    Err(worst.unwrap_or_else(nowhere))
}

/// One polynomial piece of the spline.
struct Interval<'a> {
    tracker: &'a Tracker<'a>,
    spline: &'a QuinticSpline,
    index: usize,
    from: f64,
    length: f64,
}

impl Interval<'_> {
    /// An error unless joints and tool stay within their bounds. For joints and the tool's position that is a proof. For its rotation it
    /// is one up to what the curve's turning is taken for between three places ([`TURNING_MARGIN`]) and to terms that are smaller by
    /// the angle of the error itself, in rad.
    ///
    /// Between two places a and b the error's distance from its linear interpolation is at most (b − a)²/8 times the greatest second
    /// derivative, for which the sum of tool's and curve's accelerations is a bound. Places are added in the middle until that
    /// suffices.
    fn miss(&self, options: &PathOptions) -> Result<()> {
        self.check_limits()?;
        let bends = self.bends();
        let mut open = vec![(0.0, self.length, PoseError { position_m: AT_SAMPLE, rotation_rad: AT_SAMPLE }, 0)];
        while let Some((a, b, ends, halvings)) = open.pop() {
            let slack = (b - a).powi(2) / 8.0;
            let bound = PoseError {
                position_m: ends.position_m + slack * bends.position_m,
                rotation_rad: ends.rotation_rad + slack * bends.rotation_rad,
            };
            if bound.within(options.tolerance_m, options.tolerance_rad) {
                continue;
            }
            let middle = 0.5 * (a + b);
            let [q, ..] = self.spline.in_segment(self.index, middle);
            let tool = self.tracker.robot.chain.forward(&q);
            let here = PoseError::between(&tool, &self.tracker.curve.pose(self.from + middle));
            if halvings == MAX_HALVINGS || !here.within(options.tolerance_m, options.tolerance_rad) {
                return Err(ManipulatorError::PathTolerance {
                    pose: self.pose(),
                    position_error_m: here.position_m,
                    rotation_error_rad: here.rotation_rad,
                });
            }
            // The greater of both ends, for each half.
            let ends = PoseError {
                position_m: ends.position_m.max(here.position_m),
                rotation_rad: ends.rotation_rad.max(here.rotation_rad),
            };
            open.push((a, middle, ends, halvings + 1));
            open.push((middle, b, ends, halvings + 1));
        }
        Ok(())
    }

    fn pose(&self) -> usize {
        self.tracker.pose_after(self.from + self.length)
    }

    fn check_limits(&self) -> Result<()> {
        let robot = self.tracker.robot;
        for (joint, polynomial) in self.spline.polynomials(self.index).iter().enumerate() {
            let (lower, upper) = (robot.limits.lower[joint], robot.limits.upper[joint]);
            let inside = |(least, greatest): (f64, f64)| least >= lower - 1e-9 && greatest <= upper + 1e-9;
            // The hull is quick and nearly always enough.
            if inside(polynomial.hull(0)) {
                continue;
            }
            let (least, greatest) = polynomial.range(0);
            if !inside((least, greatest)) {
                return Err(ManipulatorError::JointLimit {
                    pose: self.pose(),
                    joint: robot.chain.joint_names()[joint].clone(),
                    value: if greatest - upper > lower - least { greatest } else { least },
                    lower,
                    upper,
                });
            }
        }
        Ok(())
    }

    /// Bounds of the second derivative of the tool's error, in m and rad per squared unit of the parameter.
    ///
    /// |∂²p/∂qᵢ∂qⱼ| is at most the tool's greatest distance from the farther joint's axis. On a segment of the curve p″ is linear,
    /// so that its ends bound it; how the curve turns is taken at three places, with a margin. The second derivative of the rotation
    /// vector φ differs from that of the relative turning by terms of order ‖φ‖·‖ω‖², which are left out.
    fn bends(&self) -> PoseError {
        let chain = &self.tracker.robot.chain;
        let polynomials = self.spline.polynomials(self.index);
        let greatest = |order: usize| {
            DVector::from_iterator(
                polynomials.len(),
                polynomials.iter().map(|polynomial| {
                    let (least, most) = polynomial.hull(order);
                    least.abs().max(most.abs())
                }),
            )
        };
        let (speeds, accelerations) = (greatest(1), greatest(2));
        let reach = chain.reach_bounds(&greatest(0));
        let (mut linear, mut angular, mut turning) = (0.0, 0.0, 0.0);
        let mut before = 0.0;
        for j in 0..chain.dof() {
            // 2·Σᵢ<ⱼ and i = j
            linear += reach[j] * (accelerations[j] + speeds[j] * (2.0 * before + speeds[j]));
            if chain.is_rotary(j) {
                angular += accelerations[j] + speeds[j] * turning;
                turning += speeds[j];
            }
            before += speeds[j];
        }
        let places = [0.0, 0.5, 1.0].map(|part| self.tracker.curve.at(self.from + part * self.length));
        let most = |value: &dyn Fn(&se3_geom::Motion) -> f64| places.iter().map(value).fold(0.0, f64::max);
        let curve_bend = most(&|motion| motion.acceleration.linear.norm());
        let curve_turn = TURNING_MARGIN * most(&|motion| motion.twist.angular.norm());
        let curve_turn_bend = TURNING_MARGIN * most(&|motion| motion.acceleration.angular.norm());
        PoseError { position_m: linear + curve_bend, rotation_rad: angular + curve_turn_bend + turning * curve_turn }
    }
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
) -> std::result::Result<Vec<Sample>, Stopped> {
    let length = |i: usize| samples[i + 1].s - samples[i].s;
    // A mark may ask for one beside it: those next to new marks are looked at again.
    let mut open: Vec<usize> = (0..marked.len()).collect();
    while let Some(i) = open.pop() {
        let new_length = |k: usize| length(k) * if marked[k] { 0.5 } else { 1.0 };
        let neighbours = [i.checked_sub(1), (i + 1 < marked.len()).then_some(i + 1)];
        let shortest = neighbours.into_iter().flatten().map(new_length).fold(f64::INFINITY, f64::min);
        if !marked[i] && new_length(i) > MAX_SPACING_RATIO * shortest {
            marked[i] = true;
            open.extend(neighbours.into_iter().flatten());
        }
    }
    let mut refined = Vec::with_capacity(2 * samples.len());
    for (i, sample) in samples.iter().enumerate() {
        refined.push(sample.clone());
        if marked.get(i) == Some(&true) {
            let half = 0.5 * length(i);
            let [seed, ..] = spline.in_segment(i, half);
            let new = tracker.sample(sample.s + half, &seed);
            refined.push(new.map_err(|error| tracker.stopped(sample.s, error))?);
        }
    }
    Ok(refined)
}
