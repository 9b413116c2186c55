//! Random pose sets that an arm can reach, anywhere in its workspace.

use std::f64::consts::TAU;

use planner::manipulator::Robot;
use planner::manipulator::nalgebra::{DVector, Vector3};
use planner::reorder::{Topology, TopologyChoice, Verdict, order_poses};
use planner::se3_geom::{LieGroup, Manifold, Pose, Se3, So3Group};
use planner::{Config, Request};

use super::follower::{least_singular_value, reaches};
use super::random::Random;

/// Samples of one curve, in the order of the curve.
#[derive(Debug, Clone)]
pub(crate) struct PoseSet {
    pub(crate) seed: u64,
    pub(crate) closed: bool,
    /// Whether the curve was made of joint positions that keep off limits and singularities, so that a plan exists.
    pub(crate) from_joints: bool,
    pub(crate) request: Request,
}

/// How far the joints of a curve that is certainly plannable stay from their limits, in rad, and its least singular value: the
/// planner's curve through the samples differs a little between them.
const MARGIN: f64 = 0.1;
const REGULAR: f64 = 0.03;

/// Fewest and most poses of a set.
const POSES: (f64, f64) = (20.0, 501.0);

impl PoseSet {
    /// The set of that number, the same on every machine. Half of them are of either kind, of either topology, with and without a
    /// start state.
    pub(crate) fn draw(robot: &Robot, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let (closed, from_joints) = (seed.is_multiple_of(2), (seed / 2).is_multiple_of(2));
        loop {
            let drawn = if from_joints {
                from_joint_curve(robot, closed, &mut random)
            } else {
                from_tool_curve(robot, closed, &mut random)
            };
            let Some(poses) = drawn else { continue };
            let start = random.coin().then(|| {
                let limits = &robot.limits;
                random.configuration(&limits.lower, &limits.upper).as_slice().to_vec()
            });
            let request = Request { poses, start, ..Request::default() };
            let set = Self { seed, closed, from_joints, request };
            if set.is_ordered_as_drawn() {
                return set;
            }
        }
    }

    /// The topology is told, and any verdict will do: the order is another test's subject.
    pub(crate) fn config(&self) -> Config {
        let topology = if self.closed { TopologyChoice::Closed } else { TopologyChoice::Open };
        Config { topology, minimum_verdict: Verdict::Ambiguous, ..Config::default() }
    }

    fn is_ordered_as_drawn(&self) -> bool {
        let config = self.config();
        let options = planner::reorder::Options { topology: config.topology, ..Default::default() };
        let Ok(found) = order_poses(&self.request.poses, config.metres_per_radian, &options) else { return false };
        let n = found.order.len();
        let steps = found.order.windows(2).map(|pair| pair[0].abs_diff(pair[1]));
        found.distinct().len() == n
            && match found.topology {
                Topology::Open => steps.into_iter().all(|step| step == 1),
                Topology::Closed => steps.into_iter().all(|step| step == 1 || step == n - 1),
            }
    }
}

/// Three harmonics in as many coordinates as asked for, of amplitude up to 1 each before their fall with the square of the order.
struct Harmonics(Vec<[(f64, f64); 3]>);

impl Harmonics {
    fn draw(coordinates: usize, random: &mut Random) -> Self {
        Self(
            (0..coordinates).map(|_| [(); 3].map(|()| (random.between(-1.0, 1.0), random.between(0.0, TAU)))).collect(),
        )
    }

    fn at(&self, phase: f64) -> DVector<f64> {
        let value = |terms: &[(f64, f64); 3]| -> f64 {
            let term = |(k, (amplitude, shift)): (usize, &(f64, f64))| {
                let order = (k + 1) as f64;
                amplitude * (order * phase + shift).sin() / (order * order)
            };
            terms.iter().enumerate().map(term).sum()
        };
        DVector::from_iterator(self.0.len(), self.0.iter().map(value))
    }
}

/// Where the samples are: equally spaced on a loop, or on the part of it that an arc takes.
fn phases(closed: bool, random: &mut Random) -> Vec<f64> {
    let count = random.by_ratio(POSES.0, POSES.1) as usize;
    let step = if closed { TAU / count as f64 } else { random.between(0.8, 5.0) / (count - 1) as f64 };
    (0..count).map(|i| i as f64 * step).collect()
}

fn from_joint_curve(robot: &Robot, closed: bool, random: &mut Random) -> Option<Vec<Pose>> {
    let (lower, upper) = (robot.limits.lower.add_scalar(MARGIN), robot.limits.upper.add_scalar(-MARGIN));
    let centre = random.configuration(&lower, &upper);
    let harmonics = Harmonics::draw(robot.chain.dof(), random);
    let amplitude = random.by_ratio(0.05, 1.0);
    let phases = phases(closed, random);
    let mut poses = Vec::with_capacity(phases.len());
    for phase in phases {
        let q = &centre + harmonics.at(phase) * amplitude;
        let within = (0..q.len()).all(|j| q[j] > lower[j] && q[j] < upper[j]);
        if !within || least_singular_value(robot, &q) < REGULAR {
            return None;
        }
        poses.push(robot.chain.forward(&q));
    }
    is_drawn_well(&poses).then_some(poses)
}

fn from_tool_curve(robot: &Robot, closed: bool, random: &mut Random) -> Option<Vec<Pose>> {
    let limits = &robot.limits;
    let mut q = random.configuration(&limits.lower, &limits.upper);
    let centre = robot.chain.forward(&q);
    let harmonics = Harmonics::draw(6, random);
    let (size_m, swing_rad) = (random.by_ratio(0.02, 0.4), random.by_ratio(0.02, 0.8));
    let mut poses = Vec::new();
    for phase in phases(closed, random) {
        let value = harmonics.at(phase);
        let part = |k: usize| Vector3::new(value[k], value[k + 1], value[k + 2]);
        let place = centre.translation.vector + part(0) * size_m;
        poses.push(Pose::from_parts(place.into(), centre.rotation * So3Group::exp(part(3) * swing_rad)));
        q = reaches(robot, poses.last()?, &q, random)?;
    }
    is_drawn_well(&poses).then_some(poses)
}

/// Far enough apart to be told apart, in steps of less than 1 rad, and 3 cm or 0.3 rad long at least.
fn is_drawn_well(poses: &[Pose]) -> bool {
    let metric = Se3::with_metres_per_radian(0.1).unwrap_or_default();
    let gaps: Vec<f64> = poses.windows(2).map(|pair| metric.distance(&pair[0], &pair[1])).collect();
    gaps.iter().all(|gap| (1e-5..0.1).contains(gap)) && gaps.iter().sum::<f64>() > 0.03
}
