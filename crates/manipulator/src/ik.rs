//! Inverse kinematics of one pose by damped least squares.

use nalgebra::{DVector, Matrix6, Matrix6xX, Vector6};
use se3_geom::{LieGroup, Pose, Se3Group, Twist};

use crate::chain::Chain;
use crate::error::{ManipulatorError, Result};
use crate::robot::{Limits, Robot};

/// When inverse kinematics counts as solved and when it gives up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkOptions {
    /// Greatest distance between tool and target, in m.
    pub tolerance_m: f64,
    /// Greatest angle between tool and target, in rad.
    pub tolerance_rad: f64,
    /// Steps, accepted or not, after which it gives up.
    pub max_iterations: usize,
}

impl Default for IkOptions {
    fn default() -> Self {
        Self { tolerance_m: 1e-9, tolerance_rad: 1e-9, max_iterations: 100 }
    }
}

/// How far a tool is from where it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PoseError {
    pub(crate) position_m: f64,
    pub(crate) rotation_rad: f64,
}

impl PoseError {
    pub(crate) fn between(a: &Pose, b: &Pose) -> Self {
        Self {
            position_m: (a.translation.vector - b.translation.vector).norm(),
            rotation_rad: se3_geom::Manifold::distance(&se3_geom::So3, &a.rotation, &b.rotation),
        }
    }

    pub(crate) fn within(&self, tolerance_m: f64, tolerance_rad: f64) -> bool {
        self.position_m <= tolerance_m && self.rotation_rad <= tolerance_rad
    }
}

/// A configuration within the joint limits whose tool pose is `target` (`base_from_tool`), found from `seed` of shape (dof).
///
/// Levenberg–Marquardt on the body twist log(T(q)⁻¹·target). Of the equivalent positions of a turning joint, whole turns apart, the
/// one nearest to the seed within the limits is taken.
///
/// # Errors
/// [`ManipulatorError::IkNotConverged`] with the distance left, [`ManipulatorError::WrongSize`] or
/// [`ManipulatorError::NonFinite`] for a malformed seed or target.
pub fn solve_ik(robot: &Robot, target: &Pose, seed: &DVector<f64>, options: &IkOptions) -> Result<DVector<f64>> {
    robot.check_configuration("the seed of inverse kinematics", seed)?;
    if !se3_geom::Manifold::is_finite(&se3_geom::Se3::default(), target) {
        return Err(ManipulatorError::NonFinite { what: "the target pose" });
    }
    let free = descend(&robot.chain, target, seed, options, None);
    if let Ok(q) = &free {
        let nearest = nearest_turns(robot, q, seed);
        if robot.limits.first_violation(&nearest).is_none() {
            return Ok(nearest);
        }
    }
    let held = descend(&robot.chain, target, seed, options, Some(&robot.limits));
    held.map_err(|left| ManipulatorError::IkNotConverged {
        position_error_m: left.position_m,
        rotation_error_rad: left.rotation_rad,
    })
}

/// `q` with whole turns added to its turning joints so that each is as near to `reference` as its limits allow.
pub(crate) fn nearest_turns(robot: &Robot, q: &DVector<f64>, reference: &DVector<f64>) -> DVector<f64> {
    let turn = std::f64::consts::TAU;
    DVector::from_fn(q.len(), |i, _| {
        if !robot.chain.is_rotary(i) {
            return q[i];
        }
        let nearest = q[i] + turn * ((reference[i] - q[i]) / turn).round();
        let (lower, upper) = (robot.limits.lower[i], robot.limits.upper[i]);
        if nearest < lower {
            nearest + turn * ((lower - nearest) / turn).ceil()
        } else if nearest > upper {
            nearest - turn * ((nearest - upper) / turn).ceil()
        } else {
            nearest
        }
    })
}

/// Levenberg–Marquardt from `seed`; with `limits`, every step is projected onto them.
pub(crate) fn descend(
    chain: &Chain,
    target: &Pose,
    seed: &DVector<f64>,
    options: &IkOptions,
    limits: Option<&Limits>,
) -> std::result::Result<DVector<f64>, PoseError> {
    let clamp = |mut q: DVector<f64>| {
        if let Some(limits) = limits {
            q.iter_mut().enumerate().for_each(|(i, x)| *x = x.clamp(limits.lower[i], limits.upper[i]));
        }
        q
    };
    let mut q = clamp(seed.clone());
    let mut tool = chain.forward(&q);
    let mut twist = tool_error(&tool, target);
    let mut damping = 1e-3;
    for _ in 0..options.max_iterations {
        if PoseError::between(&tool, target).within(options.tolerance_m, options.tolerance_rad) {
            return Ok(q);
        }
        let jacobian = chain.body_jacobian(&q);
        // Damping in proportion to the squared error keeps the convergence quadratic (Sugihara 2011).
        let Some(step) = damped_step(&jacobian, &twist, damping * twist.norm_squared()) else { break };
        let trial = clamp(&q + step);
        let trial_tool = chain.forward(&trial);
        let trial_twist = tool_error(&trial_tool, target);
        if trial_twist.norm_squared() < twist.norm_squared() {
            (q, tool, twist) = (trial, trial_tool, trial_twist);
            damping = (damping * 0.2).max(1e-9);
        } else {
            damping *= 8.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    let left = PoseError::between(&tool, target);
    if left.within(options.tolerance_m, options.tolerance_rad) { Ok(q) } else { Err(left) }
}

/// Jᵀ(JJᵀ + λI)⁻¹·twist.
fn damped_step(jacobian: &Matrix6xX<f64>, twist: &Vector6<f64>, lambda: f64) -> Option<DVector<f64>> {
    // A hundred roundings of the squares keep the factorisation possible at a singularity.
    let least = 1e-14 * jacobian.norm_squared();
    let gram = jacobian * jacobian.transpose() + Matrix6::identity() * lambda.max(least);
    Some(jacobian.transpose() * gram.cholesky()?.solve(twist))
}

/// J⁺·twist: the joint rates (of least norm where there are more than six joints) that move the tool by `twist`.
pub(crate) fn rates_for(jacobian: &Matrix6xX<f64>, twist: &Vector6<f64>) -> Option<DVector<f64>> {
    damped_step(jacobian, twist, 0.0)
}

/// log(tool⁻¹·target) as (linear, angular); at half a turn one of the two shortest ways.
fn tool_error(tool: &Pose, target: &Pose) -> Vector6<f64> {
    let tool_from_target = tool.inverse() * target;
    let twist = Se3Group::log(&tool_from_target).unwrap_or_else(|_| {
        let axis = tool_from_target.rotation.imag().normalize();
        Twist::new(tool_from_target.translation.vector, axis * std::f64::consts::PI)
    });
    twist.to_vector()
}
