//! Inverse kinematics of one pose by damped least squares.

use nalgebra::{DVector, Matrix6, Matrix6xX, Vector6};
use se3_geom::{Pose, Twist};

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

    fn of(twist: &Vector6<f64>) -> Self {
        let Twist { linear, angular } = Twist::from_vector(twist);
        Self { position_m: linear.norm(), rotation_rad: angular.norm() }
    }

    pub(crate) fn within(&self, tolerance_m: f64, tolerance_rad: f64) -> bool {
        self.position_m <= tolerance_m && self.rotation_rad <= tolerance_rad
    }
}

/// A configuration within the joint limits whose tool pose is `target` (`base_from_tool`), found from `seed` of shape (dof).
///
/// Levenberg–Marquardt on the tool's distance and angle from the target. Of the equivalent positions of a turning joint, whole turns apart, the
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
    held.map_err(|miss| ManipulatorError::IkNotConverged {
        position_error_m: miss.error.position_m,
        rotation_error_rad: miss.error.rotation_rad,
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

/// Where a descent ended short of its target.
#[derive(Debug, Clone)]
pub(crate) struct Miss {
    pub(crate) q: DVector<f64>,
    pub(crate) error: PoseError,
}

/// Levenberg–Marquardt from `seed`; with `limits`, every step is projected onto them.
pub(crate) fn descend(
    chain: &Chain,
    target: &Pose,
    seed: &DVector<f64>,
    options: &IkOptions,
    limits: Option<&Limits>,
) -> std::result::Result<DVector<f64>, Miss> {
    let clamp = |q: &mut DVector<f64>| {
        if let Some(limits) = limits {
            q.iter_mut().enumerate().for_each(|(i, x)| *x = x.clamp(limits.lower[i], limits.upper[i]));
        }
    };
    let mut q = seed.clone();
    clamp(&mut q);
    let mut jacobian = Matrix6xX::zeros(chain.dof());
    let (mut trial, mut trial_jacobian) = (q.clone(), jacobian.clone());
    let mut twist = tool_error(&chain.forward_with_jacobian(&q, &mut jacobian), target);
    let mut damping = 1e-3;
    for _ in 0..options.max_iterations {
        if PoseError::of(&twist).within(options.tolerance_m, options.tolerance_rad) {
            return Ok(q);
        }
        // Damping in proportion to the squared error keeps the convergence quadratic (Sugihara 2011).
        let lambda = damping * twist.norm_squared();
        let Some(pull) = solve_gram(&jacobian, &twist, lambda) else { break };
        trial.copy_from(&q);
        trial.gemv_tr(1.0, &jacobian, &pull, 1.0);
        if let Some(limits) = limits {
            let Some(step) = step_of_free_joints(&q, &trial, &jacobian, &twist, lambda, limits) else { break };
            trial = &q + step;
        }
        clamp(&mut trial);
        let trial_twist = tool_error(&chain.forward_with_jacobian(&trial, &mut trial_jacobian), target);
        if trial_twist.norm_squared() < twist.norm_squared() {
            std::mem::swap(&mut q, &mut trial);
            std::mem::swap(&mut jacobian, &mut trial_jacobian);
            twist = trial_twist;
            damping = (damping * 0.2).max(1e-9);
        } else {
            damping *= 8.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    let error = PoseError::of(&twist);
    if error.within(options.tolerance_m, options.tolerance_rad) { Ok(q) } else { Err(Miss { q, error }) }
}

/// The damped step of the joints that are not held by a limit: one at its limit that would pass it does not take part, until none
/// is left that would. `wanted` is where all of them together would go.
fn step_of_free_joints(
    q: &DVector<f64>,
    wanted: &DVector<f64>,
    jacobian: &Matrix6xX<f64>,
    twist: &Vector6<f64>,
    lambda: f64,
    limits: &Limits,
) -> Option<DVector<f64>> {
    let mut step = wanted - q;
    let mut free = jacobian.clone();
    for _ in 0..q.len() {
        let held =
            |j: &usize| (q[*j] <= limits.lower[*j] && step[*j] < 0.0) || (q[*j] >= limits.upper[*j] && step[*j] > 0.0);
        let held: Vec<usize> = (0..q.len()).filter(held).collect();
        if held.is_empty() {
            break;
        }
        held.into_iter().for_each(|j| free.column_mut(j).fill(0.0));
        step.gemv_tr(1.0, &free, &solve_gram(&free, twist, lambda)?, 0.0);
    }
    Some(step)
}

/// How exactly the self-motion that is left to a redundant arm is fixed, in rad or m.
const POSTURE_TOLERANCE: f64 = 1e-9;
/// Longest step towards a posture, in rad or m: the self-motion is a curve, which its tangent leaves.
const LONGEST_STEP: f64 = 0.3;

/// Of the configurations at `target` the one nearest to `posture`, found from `seed`: the pose is reached and what is left of
/// `posture` − q lies in the row space of J. A smooth function of target and posture where J has full rank and the posture is
/// nearer than the self-motion's radius of curvature (implicit function theorem).
///
/// Newton on the pose and a projected step to the posture: quadratic in the first, in the second a contraction that is the faster
/// the nearer the posture.
pub(crate) fn nearest_to(
    chain: &Chain,
    target: &Pose,
    seed: &DVector<f64>,
    posture: &DVector<f64>,
    options: &IkOptions,
) -> std::result::Result<DVector<f64>, Miss> {
    let mut q = seed.clone();
    let mut jacobian = Matrix6xX::zeros(chain.dof());
    let mut step = q.clone();
    let mut twist = Vector6::zeros();
    for _ in 0..options.max_iterations {
        twist = tool_error(&chain.forward_with_jacobian(&q, &mut jacobian), target);
        step.copy_from(posture);
        step -= &q;
        let Some(pull) = solve_gram(&jacobian, &(twist - &jacobian * &step), 0.0) else { break };
        step.gemv_tr(1.0, &jacobian, &pull, 1.0);
        let length = step.amax();
        if length < POSTURE_TOLERANCE && PoseError::of(&twist).within(options.tolerance_m, options.tolerance_rad) {
            return Ok(q);
        }
        q.axpy((LONGEST_STEP / length).min(1.0), &step, 1.0);
    }
    Err(Miss { q, error: PoseError::of(&twist) })
}

/// (JJᵀ + λI)⁻¹·twist.
fn solve_gram(jacobian: &Matrix6xX<f64>, twist: &Vector6<f64>, lambda: f64) -> Option<Vector6<f64>> {
    // A hundred roundings of the squares keep the factorisation possible at a singularity.
    let gram = gram(jacobian);
    let least = 1e-14 * gram.trace();
    Some((gram + Matrix6::identity() * lambda.max(least)).cholesky()?.solve(twist))
}

/// JJᵀ.
pub(crate) fn gram(jacobian: &Matrix6xX<f64>) -> Matrix6<f64> {
    let mut gram = Matrix6::zeros();
    for column in jacobian.column_iter() {
        gram.ger(1.0, &column, &column, 1.0);
    }
    gram
}

/// The joint rates nearest to `wanted` that move the tool by `twist`: w + J⁺(twist − J·w).
pub(crate) fn rates_for(
    jacobian: &Matrix6xX<f64>,
    twist: &Vector6<f64>,
    mut wanted: DVector<f64>,
) -> Option<DVector<f64>> {
    let pull = solve_gram(jacobian, &(twist - jacobian * &wanted), 0.0)?;
    wanted.gemv_tr(1.0, jacobian, &pull, 1.0);
    Some(wanted)
}

/// (Rᵀ(p* − p), log RᵀR*): position and rotation apart, to first order the body twist that is missing.
fn tool_error(tool: &Pose, target: &Pose) -> Vector6<f64> {
    let back = tool.rotation.inverse();
    let linear = back * (target.translation.vector - tool.translation.vector);
    Twist::new(linear, (back * target.rotation).scaled_axis()).to_vector()
}
