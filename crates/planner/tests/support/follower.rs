//! Inverse kinematics and curve following by other means than the planner's: many random starts, and nothing clever.

use planner::manipulator::Robot;
use planner::manipulator::nalgebra::{DVector, Matrix6, Vector6};
use planner::se3_geom::{Pose, PoseSpline};

use super::random::Random;

pub(crate) fn least_singular_value(robot: &Robot, q: &DVector<f64>) -> f64 {
    robot.chain.body_jacobian(q).svd(false, false).singular_values.min()
}

/// Position and rotation vector from the tool at `q` to `target`, in the tool frame.
fn error(robot: &Robot, q: &DVector<f64>, target: &Pose) -> Vector6<f64> {
    let tool = robot.chain.forward(q);
    let linear = tool.rotation.inverse() * (target.translation.vector - tool.translation.vector);
    let angular = (tool.rotation.inverse() * target.rotation).scaled_axis();
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

/// Newton steps of at most 0.2 rad, damped by the error; a configuration that has the tool within 1e-7 of `target`.
fn descend(robot: &Robot, target: &Pose, from: &DVector<f64>, steps: usize) -> Option<DVector<f64>> {
    let mut q = from.clone();
    for _ in 0..steps {
        let left = error(robot, &q, target);
        if left.norm() < 1e-7 {
            return Some(q);
        }
        let jacobian = robot.chain.body_jacobian(&q);
        let damped = &jacobian * jacobian.transpose() + Matrix6::identity() * (0.01 * left.norm_squared()).min(0.01);
        let step = jacobian.transpose() * damped.cholesky()?.solve(&left);
        q += &step * (0.2 / step.amax()).min(1.0);
    }
    None
}

/// The same arm pose with every turning joint within its limits, if there is one; nearest to `near`.
fn within_limits(robot: &Robot, mut q: DVector<f64>, near: &DVector<f64>) -> Option<DVector<f64>> {
    let turn = std::f64::consts::TAU;
    for j in 0..q.len() {
        let (lower, upper) = (robot.limits.lower[j], robot.limits.upper[j]);
        q[j] += turn * ((near[j] - q[j]) / turn).round();
        if q[j] < lower {
            q[j] += turn * ((lower - q[j]) / turn).ceil();
        }
        if q[j] > upper {
            q[j] -= turn * ((q[j] - upper) / turn).ceil();
        }
        if !(lower..=upper).contains(&q[j]) {
            return None;
        }
    }
    Some(q)
}

/// How many random starts stand for all. A solution draws in at least a hundredth of the starts, so it is missed with 0.99³⁰⁰ = 5 %.
const STARTS: usize = 300;

/// A configuration within the limits at `target`: from `near`, else from random ones.
pub(crate) fn reaches(robot: &Robot, target: &Pose, near: &DVector<f64>, random: &mut Random) -> Option<DVector<f64>> {
    let close = descend(robot, target, near, 100).and_then(|q| within_limits(robot, q, near));
    let limits = &robot.limits;
    close.or_else(|| {
        (0..STARTS / 10).find_map(|_| {
            let seed = random.configuration(&limits.lower, &limits.upper);
            descend(robot, target, &seed, 100).and_then(|q| within_limits(robot, q, &seed))
        })
    })
}

/// Why one attempt at following ended.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum End {
    /// At the curve's last pose.
    Through,
    /// Before this parameter a joint passed its limit.
    Limit(f64, usize),
    /// Before this parameter the singular value fell below the bound.
    Singular(f64, f64),
    /// Before this parameter Newton's method failed: out of reach.
    Lost(f64),
}

/// Parts of each segment that the follower steps over one by one.
const PARTS: usize = 6;

/// Follows `curve` from many configurations at its first pose; arms with joints to spare also drift within their freedom, each
/// attempt its own way. How each attempt ended; none where the first pose is not reached at all. Ends with the first that gets through.
pub(crate) fn follow_from_many(
    robot: &Robot,
    curve: &PoseSpline,
    bound: f64,
    attempts: usize,
    random: &mut Random,
) -> Vec<End> {
    let limits = &robot.limits;
    let knots = curve.knots();
    let first = curve.pose(knots[0]);
    let mut known: Vec<DVector<f64>> = Vec::new();
    let mut ends = Vec::new();
    for _ in 0..attempts {
        let seed = random.configuration(&limits.lower, &limits.upper);
        let drift = (random.configuration(&limits.lower, &limits.upper), random.between(0.0, 0.1));
        let start = descend(robot, &first, &seed, 100).and_then(|q| within_limits(robot, q, &seed));
        let Some(start) = start else { continue };
        if known.iter().any(|q| (q - &start).amax() < 1e-3) {
            continue;
        }
        known.push(start.clone());
        ends.push(follow(robot, curve, bound, start, drift));
        if ends.last() == Some(&End::Through) {
            break;
        }
    }
    ends
}

fn follow(
    robot: &Robot,
    curve: &PoseSpline,
    bound: f64,
    mut q: DVector<f64>,
    (goal, rate): (DVector<f64>, f64),
) -> End {
    let limits = &robot.limits;
    let first = least_singular_value(robot, &q);
    if first < bound {
        return End::Singular(curve.domain().0, first);
    }
    for pair in curve.knots().windows(2) {
        for part in 1..=PARTS {
            let s = pair[0] + (pair[1] - pair[0]) * part as f64 / PARTS as f64;
            if robot.chain.dof() > 6 {
                q += drift(robot, &q, &((&goal - &q) * rate));
            }
            let Some(next) = descend(robot, &curve.pose(s), &q, 20) else { return End::Lost(s) };
            if let Some(joint) =
                (0..q.len()).find(|&j| next[j] < limits.lower[j] - 1e-9 || next[j] > limits.upper[j] + 1e-9)
            {
                return End::Limit(s, joint);
            }
            let singular_value = least_singular_value(robot, &next);
            if singular_value < bound {
                return End::Singular(s, singular_value);
            }
            if (&next - &q).amax() > 0.5 {
                return End::Lost(s);
            }
            q = next;
        }
    }
    End::Through
}

/// The part of `wish` that does not move the tool.
fn drift(robot: &Robot, q: &DVector<f64>, wish: &DVector<f64>) -> DVector<f64> {
    let jacobian = robot.chain.body_jacobian(q);
    let gram = &jacobian * jacobian.transpose();
    let moved = gram.cholesky().map(|cholesky| jacobian.transpose() * cholesky.solve(&(&jacobian * wish)));
    moved.map_or_else(|| wish * 0.0, |moved| wish - moved)
}
