//! The configurations in which an arm can take the first pose.

use std::f64::consts::PI;

use nalgebra::DVector;
use se3_geom::Pose;

use crate::error::{ManipulatorError, Result};
use crate::ik::{IkOptions, PoseError, descend, nearest_turns};
use crate::robot::Robot;

/// Seeds spread over the joint ranges. A six-joint arm has at most 16 branches, the UR5e 8; a test below counts how many are found.
const SEEDS: usize = 128;
/// A descent that has not arrived after so many steps hardly ever does.
const OPTIONS: IkOptions = IkOptions { tolerance_m: 1e-9, tolerance_rad: 1e-9, max_iterations: 30 };

/// Branches come nearer to each other than this only where they meet, at a singularity.
const SAME_BRANCH: f64 = 1e-3;
/// Along the self-motion of a redundant arm there are as many configurations as one likes; these, in rad or m apart, suffice.
const SAME_SELF_MOTION: f64 = 0.2;

/// Configurations at `target` within the limits, each the one of its whole-turn copies that is nearest to `reference`, nearest first.
pub(crate) fn first_configurations(
    robot: &Robot,
    target: &Pose,
    reference: &DVector<f64>,
) -> Result<Vec<DVector<f64>>> {
    from_seeds(robot, target, reference, SEEDS)
}

fn from_seeds(robot: &Robot, target: &Pose, reference: &DVector<f64>, seeds: usize) -> Result<Vec<DVector<f64>>> {
    let apart = if robot.chain.dof() > 6 { SAME_SELF_MOTION } else { SAME_BRANCH };
    let mut found: Vec<DVector<f64>> = Vec::new();
    let mut nearest_miss: Option<PoseError> = None;
    let mut out_of_limits: Option<DVector<f64>> = None;
    for index in 0..=seeds {
        let seed = if index == 0 { reference.clone() } else { spread_seed(robot, index) };
        match descend(&robot.chain, target, &seed, &OPTIONS, None) {
            Ok(q) => {
                let q = nearest_turns(robot, &q, reference);
                if robot.limits.first_violation(&q).is_some() {
                    out_of_limits = out_of_limits.or(Some(q));
                } else if found.iter().all(|known| (known - &q).amax() > apart) {
                    found.push(q);
                }
            }
            Err(miss) if nearest_miss.is_none_or(|least| size(&miss.error) < size(&least)) => {
                nearest_miss = Some(miss.error);
            }
            Err(_) => {}
        }
    }
    let distance = |q: &DVector<f64>| (q - reference).component_div(&robot.limits.velocity).amax();
    found.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    if !found.is_empty() {
        return Ok(found);
    }
    if let Some(q) = out_of_limits {
        let joint = robot.limits.first_violation(&q).unwrap_or(0);
        return Err(ManipulatorError::JointLimit {
            pose: 0,
            joint: robot.chain.joint_names()[joint].clone(),
            value: q[joint],
            lower: robot.limits.lower[joint],
            upper: robot.limits.upper[joint],
        });
    }
    let left = nearest_miss.unwrap_or(PoseError { position_m: f64::NAN, rotation_rad: f64::NAN });
    Err(ManipulatorError::UnreachableBetween {
        pose: 0,
        position_error_m: left.position_m,
        rotation_error_rad: left.rotation_rad,
    })
}

/// A metre counts as much as a radian.
pub(crate) fn size(error: &PoseError) -> f64 {
    error.position_m.hypot(error.rotation_rad)
}

/// Point `index` of the Halton sequence, stretched over one turn about the middle of each joint's range, or over the range itself
/// where that is shorter.
pub(crate) fn spread_seed(robot: &Robot, index: usize) -> DVector<f64> {
    const PRIMES: [usize; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    DVector::from_fn(robot.chain.dof(), |joint, _| {
        let (mut fraction, mut weight, mut left) = (0.0, 1.0, index);
        let base = PRIMES[joint % PRIMES.len()];
        while left > 0 {
            weight /= base as f64;
            fraction += weight * (left % base) as f64;
            left /= base;
        }
        let (lower, upper) = (robot.limits.lower[joint], robot.limits.upper[joint]);
        let middle = if (upper - lower).is_finite() { 0.5 * (lower + upper) } else { 0.0 };
        let half = (0.5 * (upper - lower)).min(PI);
        middle + half * (2.0 * fraction - 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against ten times as many seeds. At a singular pose the configurations are a continuum, which cannot be counted.
    #[test]
    fn the_seeds_find_nearly_all_branches() {
        let robot = Robot::shipped("ur5e").unwrap();
        let (mut found, mut there) = (0, 0);
        for k in 0..40 {
            let q = DVector::from_fn(6, |j, _| 2.0 * ((31 * k + 7 * j) as f64).sin());
            let target = robot.chain.forward(&q);
            let few = from_seeds(&robot, &target, &robot.preferred, SEEDS).unwrap();
            let many = from_seeds(&robot, &target, &robot.preferred, 10 * SEEDS).unwrap();
            assert!((&few[0] - &many[0]).amax() < 1e-5, "pose {k}");
            if many.len() <= 8 {
                found += few.len();
                there += many.len();
            }
        }
        // The arm has two shoulders, elbows and wrists: eight branches where the elbow's range and reach allow all.
        assert!(there >= 6 * 35 && found * 100 >= there * 98, "{found} of {there}");
    }
}
