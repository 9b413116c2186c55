//! Which poses of a curve an arm cannot take, and by how much it misses them.

use std::fmt;

use nalgebra::DVector;
use se3_geom::{Pose, PoseSpline};

use crate::branches::{size, spread_seed};
use crate::ik::{IkOptions, Miss, descend, nearest_turns};
use crate::robot::Robot;

/// A pose that is out of reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseMiss {
    /// Its index along the curve.
    pub pose: usize,
    /// Distance of the nearest tool pose found, in m.
    pub position_error_m: f64,
    /// Its angle, in rad.
    pub rotation_error_rad: f64,
}

/// The poses of a curve that an arm cannot take within its joint limits. Its [`fmt::Display`] is one sentence.
#[derive(Debug, Clone, PartialEq)]
pub struct OutOfReach {
    /// Every pose that is missed, by increasing index; at least one.
    pub misses: Vec<PoseMiss>,
    /// Poses of the curve.
    pub poses: usize,
}

impl OutOfReach {
    /// The longest runs of poses that can be reached, first and last index of each, by increasing index.
    pub fn reachable(&self) -> Vec<(usize, usize)> {
        let mut runs = Vec::new();
        let mut from = 0;
        for miss in self.misses.iter().map(|miss| miss.pose).chain([self.poses]) {
            if miss > from {
                runs.push((from, miss - 1));
            }
            from = miss + 1;
        }
        runs
    }

    /// The runs of poses that are missed.
    fn missed(&self) -> Vec<(usize, usize)> {
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for miss in &self.misses {
            match runs.last_mut() {
                Some((_, last)) if *last + 1 == miss.pose => *last = miss.pose,
                _ => runs.push((miss.pose, miss.pose)),
            }
        }
        runs
    }
}

/// Runs that are spelled out.
const SHOWN_RUNS: usize = 4;

fn in_words(runs: &[(usize, usize)]) -> String {
    let run = |&(from, to): &(usize, usize)| if from == to { format!("{from}") } else { format!("{from} to {to}") };
    let mut words: Vec<String> = runs.iter().take(SHOWN_RUNS).map(run).collect();
    if runs.len() > SHOWN_RUNS {
        words.push(format!("{} more runs", runs.len() - SHOWN_RUNS));
    }
    let one = matches!(runs, [(from, to)] if from == to);
    let last = words.pop().unwrap_or_default();
    let list = if words.is_empty() { last } else { format!("{} and {last}", words.join(", ")) };
    format!("{} {list}", if one { "pose" } else { "poses" })
}

impl fmt::Display for OutOfReach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let far = |a: &&PoseMiss| a.position_error_m.hypot(a.rotation_error_rad);
        let Some(worst) = self.misses.iter().max_by(|a, b| far(a).total_cmp(&far(b))) else {
            return write!(f, "no pose is out of reach");
        };
        let PoseMiss { pose, position_error_m, rotation_error_rad } = worst;
        let by = format!("by {position_error_m:.4} m and {rotation_error_rad:.4} rad");
        let missed = in_words(&self.missed());
        if self.misses.len() == 1 {
            write!(f, "{missed} is out of reach within the joint limits, {by}")?;
        } else {
            write!(f, "{missed} are out of reach within the joint limits, pose {pose} the farthest, {by}")?;
        }
        match &self.reachable()[..] {
            [] => write!(f, "; none can be reached"),
            runs => write!(f, "; {} can be reached", in_words(runs)),
        }
    }
}

/// Seeds for a pose that was not reached from its neighbour.
const SEEDS: usize = 32;
/// Descents after which a pose is tried from its neighbour only, so that very many poses take bounded time.
const MOST_DESCENTS: usize = 20_000;

/// Poses of `curve` that are not reached within the joint limits, neither from many seeds nor from the configuration found for the pose
/// before or after; `None` where all are.
pub(crate) fn out_of_reach(robot: &Robot, curve: &PoseSpline, seed: &DVector<f64>) -> Option<OutOfReach> {
    let knots = curve.knots();
    let poses = knots.len() - usize::from(curve.is_closed());
    let mut near = seed.clone();
    let mut descents = 0;
    let mut misses: Vec<(PoseMiss, Option<DVector<f64>>)> = Vec::new();
    for (pose, &s) in knots[..poses].iter().enumerate() {
        let seeds = if descents > MOST_DESCENTS { 0 } else { SEEDS };
        near = match reached(robot, &curve.pose(s), &near, seeds, &mut descents) {
            Ok(q) => {
                // The way back into a run of misses begins here.
                if let Some((_, after)) = misses.last_mut().filter(|(last, _)| last.pose + 1 == pose) {
                    *after = Some(q.clone());
                }
                q
            }
            Err(Miss { q, error }) => {
                let (position_error_m, rotation_error_rad) = (error.position_m, error.rotation_rad);
                misses.push((PoseMiss { pose, position_error_m, rotation_error_rad }, None));
                q
            }
        };
    }
    let mut near = None;
    let mut missed = Vec::new();
    for (miss, after) in misses.into_iter().rev() {
        near = after.or(near).and_then(|q| reached(robot, &curve.pose(knots[miss.pose]), &q, 0, &mut descents).ok());
        if near.is_none() {
            missed.push(miss);
        }
    }
    missed.reverse();
    (!missed.is_empty()).then_some(OutOfReach { misses: missed, poses })
}

fn reached(
    robot: &Robot,
    target: &Pose,
    near: &DVector<f64>,
    seeds: usize,
    descents: &mut usize,
) -> std::result::Result<DVector<f64>, Miss> {
    let options = IkOptions::default();
    let mut nearest: Option<Miss> = None;
    for index in 0..=seeds {
        let seed = if index == 0 { near.clone() } else { spread_seed(robot, index) };
        *descents += 2;
        if let Ok(q) = descend(&robot.chain, target, &seed, &options, None) {
            let q = nearest_turns(robot, &q, near);
            if robot.limits.first_violation(&q).is_none() {
                return Ok(q);
            }
        }
        let miss = match descend(&robot.chain, target, &seed, &options, Some(&robot.limits)) {
            Ok(q) => return Ok(q),
            Err(miss) => miss,
        };
        if nearest.as_ref().is_none_or(|least| size(&miss.error) < size(&least.error)) {
            nearest = Some(miss);
        }
    }
    let untried =
        || Miss { q: near.clone(), error: crate::ik::PoseError { position_m: f64::NAN, rotation_rad: f64::NAN } };
    Err(nearest.unwrap_or_else(untried))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn missing(poses: &[usize], of: usize) -> OutOfReach {
        let miss = |&pose| PoseMiss { pose, position_error_m: 0.01 * pose as f64, rotation_error_rad: 0.0 };
        OutOfReach { misses: poses.iter().map(miss).collect(), poses: of }
    }

    #[test]
    fn the_sentence_names_every_run() {
        let text = |poses: &[usize], of| missing(poses, of).to_string();
        assert_eq!(
            text(&[3], 5),
            "pose 3 is out of reach within the joint limits, by 0.0300 m and 0.0000 rad; poses 0 to 2 and 4 can be reached"
        );
        assert_eq!(
            text(&[0, 1, 5], 6),
            "poses 0 to 1 and 5 are out of reach within the joint limits, pose 5 the farthest, by 0.0500 m and 0.0000 rad; \
             poses 2 to 4 can be reached"
        );
        assert!(text(&[0, 1], 2).ends_with("; none can be reached"));
        assert_eq!(missing(&[0, 4], 6).reachable(), [(1, 3), (5, 5)]);
        assert!(text(&[0, 2, 4, 6, 8, 10], 11).starts_with("poses 0, 2, 4, 6 and 2 more runs are out"));
    }
}
