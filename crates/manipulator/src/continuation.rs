//! Following one branch of the inverse kinematics along a curve.

use nalgebra::{DVector, Matrix6xX, Vector6};
use se3_geom::PoseSpline;

use crate::chain::Chain;
use crate::error::{ManipulatorError, Result};
use crate::ik::{IkOptions, descend, rates_for};
use crate::robot::Robot;

/// A configuration on the curve with its derivative by the curve's parameter.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    pub(crate) s: f64,
    pub(crate) q: DVector<f64>,
    pub(crate) rate: DVector<f64>,
    jacobian: Matrix6xX<f64>,
}

/// Where and why a branch could not be followed further.
pub(crate) struct Stopped {
    pub(crate) parameter: f64,
    pub(crate) pose: usize,
    pub(crate) last: DVector<f64>,
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

pub(crate) struct Tracker<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) curve: &'a PoseSpline,
    pub(crate) least_singular_value: f64,
}

impl Tracker<'_> {
    /// Samples along the whole curve, at least one a pose, on the branch of `first`, a configuration at the first pose.
    pub(crate) fn track(&self, first: &DVector<f64>) -> std::result::Result<Vec<Sample>, Stopped> {
        let knots = self.curve.knots();
        let stopped = |parameter, last: &DVector<f64>, error| Stopped {
            parameter,
            pose: self.pose_after(parameter),
            last: last.clone(),
            error,
        };
        let mut samples = vec![self.sample(knots[0], first).map_err(|error| stopped(knots[0], first, error))?];
        for &knot in &knots[1..] {
            if let Err(error) = self.advance(&mut samples, knot, 0) {
                let last = &samples[samples.len() - 1];
                // The pose that was not reached is the one after the last sample, also where that sample is a pose itself.
                let mut stop = stopped(last.s, &last.q, error);
                stop.pose = self.pose_after(last.s + f64::EPSILON * knot.abs().max(1.0));
                return Err(stop);
            }
        }
        Ok(samples)
    }

    /// Index of the first pose at or after a parameter.
    pub(crate) fn pose_after(&self, s: f64) -> usize {
        let knots = self.curve.knots();
        knots.partition_point(|&k| k < s).min(knots.len() - 1)
    }

    fn advance(&self, samples: &mut Vec<Sample>, to: f64, halvings: usize) -> Result<()> {
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

    /// The configuration at parameter `s` that Newton's method finds from `seed`, if it is legal and regular.
    pub(crate) fn sample(&self, s: f64, seed: &DVector<f64>) -> Result<Sample> {
        let motion = self.curve.at(s);
        let pose = self.pose_after(s);
        let q = descend(&self.robot.chain, &motion.pose, seed, &TRACKING, None).map_err(|left| {
            ManipulatorError::Unreachable {
                pose,
                position_error_m: left.position_m,
                rotation_error_rad: left.rotation_rad,
            }
        })?;
        let limits = &self.robot.limits;
        if let Some(joint) = limits.first_violation(&q) {
            return Err(ManipulatorError::JointLimit {
                pose,
                joint: self.robot.chain.joint_names()[joint].clone(),
                value: q[joint],
                lower: limits.lower[joint],
                upper: limits.upper[joint],
            });
        }
        let jacobian = self.robot.chain.body_jacobian(&q);
        let singular_value = least_singular_value(&jacobian);
        let singular = ManipulatorError::Singular { pose, singular_value, bound: self.least_singular_value };
        if singular_value < self.least_singular_value {
            return Err(singular);
        }
        let rate = rates_for(&jacobian, &motion.twist.to_vector()).ok_or(singular)?;
        Ok(Sample { s, q, rate, jacobian })
    }

    /// q″ from the curve's acceleration: J·q″ = V′ − J′·q′.
    pub(crate) fn second_derivative(&self, sample: &Sample) -> DVector<f64> {
        let motion = self.curve.at(sample.s);
        // The curve gives Rᵀp″; the derivative of the body components Rᵀp′ is that less ω × Rᵀp′.
        let linear = motion.acceleration.linear - motion.twist.angular.cross(&motion.twist.linear);
        let acceleration = se3_geom::Twist::new(linear, motion.acceleration.angular).to_vector();
        let product = Chain::velocity_product(&sample.jacobian, &sample.rate);
        rates_for(&sample.jacobian, &(acceleration - product)).unwrap_or_else(|| DVector::zeros(sample.q.len()))
    }
}

/// The square root of the least eigenvalue of JJᵀ; its rounding error, 1e-8, is far below any sensible bound.
fn least_singular_value(jacobian: &Matrix6xX<f64>) -> f64 {
    let gram = jacobian * jacobian.transpose();
    let eigenvalues: Vector6<f64> = gram.symmetric_eigenvalues();
    eigenvalues.min().max(0.0).sqrt()
}
