//! Following one branch of the inverse kinematics along a curve.

use nalgebra::{DVector, Matrix6xX};
use se3_geom::{PoseSpline, Twist};

use crate::chain::Chain;
use crate::error::{ManipulatorError, Result};
use crate::ik::{IkOptions, descend, gram, nearest_to, rates_for};
use crate::posture::first_violation;
use crate::quintic_spline::QuinticSpline;
use crate::robot::Robot;

/// A configuration on the curve with its derivative by the curve's parameter.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    pub(crate) s: f64,
    pub(crate) q: DVector<f64>,
    pub(crate) rate: DVector<f64>,
    pub(crate) jacobian: Matrix6xX<f64>,
}

/// Where and why a branch could not be followed further.
#[derive(Debug, Clone)]
pub(crate) struct Stopped {
    pub(crate) parameter: f64,
    pub(crate) pose: usize,
    pub(crate) error: ManipulatorError,
}

/// Halvings of the way between two poses before a deviation counts as a jump.
const MAX_HALVINGS: usize = 14;
/// How far the middle may be from where the neighbours' values and slopes predict it, as a part of the step. A smooth branch
/// comes below any bound as the step shrinks (fourth order); a change of branch stays near one half.
const MAX_MIDPOINT_DEVIATION: f64 = 0.05;
/// Deviations below this, in rad, are no jump whatever the step: the tool moves less than a tenth of the path tolerance.
const NEGLIGIBLE_DEVIATION: f64 = 1e-6;
/// From a close predictor Newton's method needs a handful of steps; more means that it wandered off.
const TRACKING: IkOptions = IkOptions { tolerance_m: 1e-9, tolerance_rad: 1e-9, max_iterations: 30 };

#[derive(Debug, Clone)]
pub(crate) struct Tracker<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) curve: &'a PoseSpline,
    pub(crate) least_singular_value: f64,
    /// What a redundant arm stays nearest to; without it, it takes the least motion from sample to sample.
    pub(crate) posture: Option<QuinticSpline>,
}

impl Tracker<'_> {
    /// Samples along the whole curve, at least one a pose, on the branch of `first`, a configuration at the first pose.
    pub(crate) fn track(&self, first: &DVector<f64>) -> std::result::Result<Vec<Sample>, Stopped> {
        let knots = self.curve.knots();
        let start = self.sample(knots[0], first).map_err(|error| self.stopped(knots[0], error))?;
        let mut samples = vec![start];
        for &knot in &knots[1..] {
            if let Err(error) = self.advance(&mut samples, knot, 0) {
                return Err(self.stopped(samples[samples.len() - 1].s, error));
            }
        }
        Ok(samples)
    }

    /// The pose that was not reached is the one after the last sample, also where that sample is a pose itself; only of the
    /// first pose nothing comes before.
    pub(crate) fn stopped(&self, parameter: f64, error: ManipulatorError) -> Stopped {
        let first = parameter <= self.curve.domain().0 && error.poses() == [0];
        let past = if first { parameter } else { parameter + f64::EPSILON * parameter.abs().max(1.0) };
        Stopped { parameter, pose: self.pose_after(past), error }
    }

    /// Index of the first pose at or after a parameter.
    pub(crate) fn pose_after(&self, s: f64) -> usize {
        let knots = self.curve.knots();
        knots.partition_point(|&k| k < s).min(knots.len() - 1)
    }

    /// Adds samples up to parameter `to`, as many as it takes to show that they lie on one continuous branch.
    pub(crate) fn advance(&self, samples: &mut Vec<Sample>, to: f64, halvings: usize) -> Result<()> {
        let from = &samples[samples.len() - 1];
        let step = to - from.s;
        let predicted = |fraction: f64| &from.q + &from.rate * (fraction * step);
        let attempt = self.sample(to, &predicted(1.0)).and_then(|end| {
            let middle = self.sample(from.s + 0.5 * step, &predicted(0.5))?;
            let hermite = (&from.q + &end.q) * 0.5 + (&from.rate - &end.rate) * (0.125 * step);
            let deviation = (&middle.q - hermite).amax();
            let moved = (&end.q - &from.q).amax().max((&middle.q - &from.q).amax());
            if deviation > (MAX_MIDPOINT_DEVIATION * moved).max(NEGLIGIBLE_DEVIATION) {
                return Err(ManipulatorError::Jump { pose: self.pose_after(to), jump_rad: deviation });
            }
            Ok(end)
        });
        match attempt {
            Ok(end) => {
                samples.push(end);
                Ok(())
            }
            Err(error) if halvings == MAX_HALVINGS => Err(error),
            Err(_) => {
                let middle = from.s + 0.5 * step;
                self.advance(samples, middle, halvings + 1)?;
                self.advance(samples, to, halvings + 1)
            }
        }
    }

    /// The configuration at parameter `s` that Newton's method finds from `seed`, if it is legal and regular. Whole turns of joints
    /// that turn freely are not judged here.
    pub(crate) fn sample(&self, s: f64, seed: &DVector<f64>) -> Result<Sample> {
        let motion = self.curve.at(s);
        let pose = self.pose_after(s);
        let chain = &self.robot.chain;
        let (found, wanted) = match &self.posture {
            None => (descend(chain, &motion.pose, seed, &TRACKING, None), DVector::zeros(seed.len())),
            Some(posture) => {
                let [near, rate, ..] = posture.at(s);
                (nearest_to(chain, &motion.pose, seed, &near, &TRACKING), rate)
            }
        };
        let q = found.map_err(|miss| ManipulatorError::UnreachableBetween {
            pose,
            position_error_m: miss.error.position_m,
            rotation_error_rad: miss.error.rotation_rad,
        })?;
        let limits = &self.robot.limits;
        if let Some(joint) = first_violation(self.robot, &q) {
            return Err(ManipulatorError::JointLimit {
                pose,
                joint: chain.joint_names()[joint].clone(),
                value: q[joint],
                lower: limits.lower[joint],
                upper: limits.upper[joint],
            });
        }
        let jacobian = chain.body_jacobian(&q);
        let singular =
            |singular_value| ManipulatorError::Singular { pose, singular_value, bound: self.least_singular_value };
        if !self.is_regular(&jacobian) {
            return Err(singular(least_singular_value(&jacobian)));
        }
        let rate = rates_for(&jacobian, &motion.twist.to_vector(), wanted).ok_or(singular(0.0))?;
        Ok(Sample { s, q, rate, jacobian })
    }

    /// Whether the least singular value is above its bound.
    pub(crate) fn is_regular(&self, jacobian: &Matrix6xX<f64>) -> bool {
        // σ₆² = det/(σ₁⋯σ₅)² ≥ det/(trace/5)⁵ saves the eigenvalues nearly always.
        let gram = gram(jacobian);
        let Some(factor) = gram.cholesky() else { return false };
        let enough = factor.determinant() / (0.2 * gram.trace()).powi(5) >= self.least_singular_value.powi(2);
        enough || least_singular_value(jacobian) >= self.least_singular_value
    }

    /// q″ from the curve's acceleration: J·q″ = V′ − J′·q′, of least norm where the arm is redundant.
    pub(crate) fn second_derivative(&self, sample: &Sample) -> DVector<f64> {
        let motion = self.curve.at(sample.s);
        // The curve gives Rᵀp″; the derivative of the body components Rᵀp′ is that less ω × Rᵀp′.
        let linear = motion.acceleration.linear - motion.twist.angular.cross(&motion.twist.linear);
        let acceleration = Twist::new(linear, motion.acceleration.angular).to_vector();
        let product = Chain::velocity_product(&sample.jacobian, &sample.rate);
        let nothing = DVector::zeros(sample.q.len());
        rates_for(&sample.jacobian, &(acceleration - product), nothing.clone()).unwrap_or(nothing)
    }
}

/// The square root of the least eigenvalue of JJᵀ; its rounding error, 1e-8, is far below any sensible bound.
pub(crate) fn least_singular_value(jacobian: &Matrix6xX<f64>) -> f64 {
    gram(jacobian).symmetric_eigenvalues().min().max(0.0).sqrt()
}
