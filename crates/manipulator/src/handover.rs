//! From a running trajectory to another goal, without a jump.

use nalgebra::DVector;

use crate::audit::against_from;
use crate::bounds::Bounds;
use crate::error::Result;
use crate::options::TimingOptions;
use crate::quintic::Quintic;
use crate::rest_to_rest::rest_to_rest;
use crate::robot::Robot;
use crate::sampling::Sampling;
use crate::slowing::{check_running, slow_to_stop};
use crate::trajectory::{JointPoint, JointTrajectory};

/// The move that takes over from the trajectory `running` at its time `at_s` and leads to rest at `goal`, of shape (dof). It begins at
/// time 0 in exactly the state at `at_s`; velocity and acceleration are continuous there, all limits are kept.
///
/// The shortest of three: a single quintic from the state to the goal, which has a least and a greatest legal duration (too short breaks
/// limits, too long overshoots); the smooth stop of [`slow_to_stop`] with a straight quintic to the goal laid over it, as
/// early as the limits allow; or, always legal, [`rest_to_rest`] when the robot stands.
///
/// # Errors
/// Those of [`slow_to_stop`] and of [`rest_to_rest`].
pub fn connect(
    robot: &Robot,
    running: &JointTrajectory,
    at_s: f64,
    goal: &DVector<f64>,
    options: &TimingOptions,
) -> Result<JointTrajectory> {
    let bounds = options.bounds(robot)?;
    check_running(robot, running, at_s)?;
    robot.check_within_limits("the goal of the hand-over", goal)?;
    let stop = slow_to_stop(robot, running, at_s, options)?;
    let stopped = DVector::from_column_slice(&stop.points[stop.points.len() - 1].positions);
    // Legal under every limit, those of torque and tool too: what the others begin with, and what is left without them.
    let afterwards = rest_to_rest(robot, &stopped, goal, options)?;
    let from = running.state_at(at_s);
    let mut best = stop.switched(stop.duration_s(), &afterwards);
    let sampling = Sampling { rate_hz: options.rate_hz, joint_names: robot.chain.joint_names() };
    let over = Overlay { stop: &stop, goal, way: goal - &stopped, least_duration: afterwards.duration_s() };
    if let Some(duration) = shortest_quintic(&bounds, &from, goal, best.duration_s()) {
        let direct = sampled_quintic(&from, goal, duration, &sampling)?;
        let shorter = direct.duration_s() < best.duration_s();
        if shorter && against_from(&bounds, &direct, Some(&from)).audit.limits_ok {
            best = direct;
        }
    }
    for (begin, duration) in over.attempts() {
        if stop.points[begin].time_s + duration >= best.duration_s() {
            break;
        }
        let overlaid = over.trajectory(begin, duration, &sampling)?;
        if is_legal(&bounds, &overlaid) && against_from(&bounds, &overlaid, Some(&from)).audit.limits_ok {
            best = overlaid;
            break;
        }
    }
    Ok(best)
}

/// Durations that are tried for a single quintic grow by this factor: what is found is longer than the shortest by 2 % at most.
const FINER: f64 = 1.02;
/// The first of them, in s: five published steps at 100 a second, sooner than which no controller follows.
const SHORTEST: f64 = 0.05;

/// The least duration up to `longest` for which the quintic from a state to rest at `goal` keeps the limits.
fn shortest_quintic(bounds: &Bounds<'_>, from: &JointPoint, goal: &DVector<f64>, longest: f64) -> Option<f64> {
    let mut duration = SHORTEST;
    while duration < longest {
        let rest = vec![0.0; goal.len()];
        let to = JointPoint {
            time_s: duration,
            positions: goal.as_slice().to_vec(),
            velocities: rest.clone(),
            accelerations: rest,
        };
        let whole = JointTrajectory { joint_names: Vec::new(), points: vec![from.clone(), to] };
        if is_legal(bounds, &whole) {
            return Some(duration);
        }
        duration *= FINER;
    }
    None
}

fn sampled_quintic(
    from: &JointPoint,
    goal: &DVector<f64>,
    duration: f64,
    sampling: &Sampling<'_>,
) -> Result<JointTrajectory> {
    // Rounding of the points must not break what the whole quintic kept.
    let (steps, step_ns) = sampling.steps(duration * 1.0001)?;
    let h = Sampling::time(steps, step_ns);
    let joint = |j: usize| {
        Quintic::hermite(h, [from.positions[j], from.velocities[j], from.accelerations[j]], [goal[j], 0.0, 0.0])
    };
    let quintics: Vec<Quintic> = (0..goal.len()).map(joint).collect();
    let mut points: Vec<JointPoint> = vec![from.clone()];
    points.extend((1..steps).map(|k| {
        let time_s = Sampling::time(k, step_ns);
        let at: Vec<[f64; 4]> = quintics.iter().map(|quintic| quintic.at(time_s)).collect();
        let [positions, velocities, accelerations] = [0, 1, 2].map(|order| at.iter().map(|x| x[order]).collect());
        JointPoint { time_s, positions, velocities, accelerations }
    }));
    points.push(resting(h, goal));
    Ok(JointTrajectory { joint_names: sampling.joint_names.to_vec(), points })
}

fn resting(time_s: f64, at: &DVector<f64>) -> JointPoint {
    let zeros = vec![0.0; at.len()];
    JointPoint { time_s, positions: at.as_slice().to_vec(), velocities: zeros.clone(), accelerations: zeros }
}

/// Whether positions, velocities, accelerations and jerks keep their limits; gives up at the first that does not.
fn is_legal(bounds: &Bounds<'_>, trajectory: &JointTrajectory) -> bool {
    let (mut ratios, mut margin) = ([0.0; 3], f64::INFINITY);
    (0..trajectory.points.len() - 1).all(|interval| {
        trajectory.quintics(interval).enumerate().all(|(joint, quintic)| {
            bounds.raise(joint, &quintic, &mut ratios, &mut margin);
            margin >= -1e-9 && ratios.iter().all(|&ratio| ratio <= 1.0)
        })
    })
}

/// A smooth stop with a straight move to the goal laid over it.
struct Overlay<'a> {
    stop: &'a JointTrajectory,
    goal: &'a DVector<f64>,
    way: DVector<f64>,
    /// Of the straight move by itself.
    least_duration: f64,
}

/// How many beginnings of the straight move are tried over the stop: each costs an audit, and twice as many would gain a sixteenth of
/// the stop at most.
const BEGINNINGS: usize = 8;
/// How much slower than by itself the straight move may be, in steps of about a fifth. At 2.6 it takes less than a sixth of each
/// acceleration limit; beyond that, moving after the stop is hardly longer.
const STRETCHES: [f64; 6] = [1.0, 1.15, 1.35, 1.6, 2.0, 2.6];

impl Overlay<'_> {
    /// Index of the point of the stop at which the straight move begins, and its duration; the shortest wholes first.
    fn attempts(&self) -> Vec<(usize, f64)> {
        let last = self.stop.points.len() - 1;
        let end = self.stop.duration_s();
        let mut attempts: Vec<(usize, f64)> = (0..BEGINNINGS)
            .map(|k| k * last / BEGINNINGS)
            .flat_map(|begin| {
                // The straight move ends with the stop, or later: its end is a point.
                let room = end - self.stop.points[begin].time_s;
                STRETCHES.map(|stretch| (begin, (stretch * self.least_duration).max(room)))
            })
            .collect();
        let whole = |&(begin, duration): &(usize, f64)| self.stop.points[begin].time_s + duration;
        attempts.sort_by(|a, b| whole(a).total_cmp(&whole(b)));
        attempts.dedup();
        attempts
    }

    fn trajectory(&self, begin: usize, duration: f64, sampling: &Sampling<'_>) -> Result<JointTrajectory> {
        let (begin_s, stopped_s) = (self.stop.points[begin].time_s, self.stop.duration_s());
        let left = (begin_s + duration - stopped_s).max(0.0);
        let (steps, step_ns) = if left > 1e-9 { sampling.steps(left)? } else { (0, 0) };
        let end_s = stopped_s + Sampling::time(steps, step_ns);
        let duration = end_s - begin_s;
        let way = Quintic::hermite(duration, [0.0; 3], [1.0, 0.0, 0.0]);
        let mut points: Vec<JointPoint> = self.stop.points[..=begin].to_vec();
        let rest = &self.stop.points[self.stop.points.len() - 1];
        let later = (1..=steps).map(|k| {
            let time_s = crate::trajectory::whole_ns(stopped_s + Sampling::time(k, step_ns));
            JointPoint { time_s, ..rest.clone() }
        });
        points.extend(self.stop.points[begin + 1..].iter().cloned().chain(later).map(|mut point| {
            let over = way.at(point.time_s - begin_s);
            for (j, way) in self.way.iter().enumerate() {
                point.positions[j] += way * over[0];
                point.velocities[j] += way * over[1];
                point.accelerations[j] += way * over[2];
            }
            point
        }));
        if points.len() > 1
            && let Some(last) = points.last_mut()
        {
            *last = resting(last.time_s, self.goal);
        }
        Ok(JointTrajectory { joint_names: self.stop.joint_names.clone(), points })
    }
}
