//! A smooth stop on the planned path: the trajectory's own clock is slowed down until it stands.

use crate::audit::against_from;
use crate::error::{ManipulatorError, Result};
use crate::options::TimingOptions;
use crate::quintic::Quintic;
use crate::robot::{Limits, Robot};
use crate::trajectory::{JointPoint, JointTrajectory, whole_ns};

/// Stops a running trajectory from its time `at_s` on, without leaving its path: what was checked of the path, collisions too, still
/// holds. The result begins at time 0 in exactly the state at `at_s`, keeps the limits of `options`, and ends at rest.
///
/// With σ(τ) the trajectory's time at time τ, the joints move by q(σ), so that their velocity, acceleration and jerk are q̇σ̇,
/// q̈σ̇² + q̇σ̈ and q⃛σ̇³ + 3q̈σ̇σ̈ + q̇σ⃛. At each step σ⃛ is chosen as low as the limits allow while there is still a legal way to
/// σ̈ = 0, from where going on at constant σ̇ ≤ 1 is legal always. A trajectory that brakes as hard as it may cannot be stopped
/// earlier; where nothing better is found, the result is its remainder.
///
/// # Errors
/// [`ManipulatorError::NotRunning`] for a time outside the trajectory, [`ManipulatorError::NotOfRobot`] for one that the robot cannot
/// execute, [`ManipulatorError::LimitsNotMet`] for one that breaks limits already, [`ManipulatorError::InvalidOption`].
pub fn slow_to_stop(
    robot: &Robot,
    running: &JointTrajectory,
    at_s: f64,
    options: &TimingOptions,
) -> Result<JointTrajectory> {
    let bounds = options.bounds(robot)?;
    check_running(robot, running, at_s)?;
    let from = running.state_at(at_s);
    let mut best = running.after(at_s);
    let audit = |trajectory: &JointTrajectory| against_from(&bounds, trajectory, Some(&from)).audit;
    let mut found = audit(&best);
    for margin in MARGINS {
        let slowed = Slowing::new(running, &bounds.limits, 1.0 / options.rate_hz, margin).from(at_s, from.clone());
        if slowed.duration_s() < best.duration_s() {
            let judged = audit(&slowed);
            if judged.limits_ok {
                (best, found) = (slowed, judged);
                break;
            }
        }
    }
    if found.limits_ok { Ok(best) } else { Err(bounds.not_met(found)) }
}

/// Parts of the limits to aim at: quintics between points overshoot what they interpolate, a little.
const MARGINS: [f64; 4] = [0.995, 0.97, 0.9, 0.75];
/// Lengths of the way back to a steady clock that are tried, in steps.
const RECOVERIES: [f64; 7] = [2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 32.0];
/// How far, from the hardest braking to the way back, a step may go.
const HARDNESS: [f64; 5] = [0.0, 0.15, 0.35, 0.6, 0.85];
/// The last steps before the clock stands are taken as found: there is nothing left to gain.
const LAST_STEPS: f64 = 3.0;
/// Steps of a clock that slows down for ever so long; by then it is better to go on to the end.
const MOST_STEPS: usize = 2_000;

pub(crate) fn check_running(robot: &Robot, running: &JointTrajectory, at_s: f64) -> Result<()> {
    robot.check_limits()?;
    let dof = robot.chain.dof();
    if running.joint_names != robot.chain.joint_names() || !running.is_well_formed(dof) {
        return Err(ManipulatorError::NotOfRobot { what: "the running trajectory" });
    }
    let duration_s = running.duration_s();
    if (0.0..=duration_s).contains(&at_s) { Ok(()) } else { Err(ManipulatorError::NotRunning { at_s, duration_s }) }
}

/// The trajectory's time, and its derivatives by time.
#[derive(Debug, Clone, Copy)]
struct Clock {
    time: f64,
    rate: f64,
    /// Of the rate; negative while slowing down.
    acceleration: f64,
}

impl Clock {
    fn after(self, h: f64, jerk: f64) -> Self {
        Self {
            time: self.time + h * (self.rate + h * (self.acceleration / 2.0 + h * jerk / 6.0)),
            rate: self.rate + h * (self.acceleration + h * jerk / 2.0),
            acceleration: self.acceleration + h * jerk,
        }
    }
}

/// A legal way back to a steady clock: this jerk, for this long.
#[derive(Debug, Clone, Copy)]
struct Recovery {
    jerk: f64,
    remaining: f64,
    /// Whether the clock stands at its end.
    stops: bool,
}

struct Slowing<'a> {
    running: &'a JointTrajectory,
    limits: &'a Limits,
    quintics: Vec<Vec<Quintic>>,
    step: f64,
    margin: f64,
}

impl<'a> Slowing<'a> {
    fn new(running: &'a JointTrajectory, limits: &'a Limits, step: f64, margin: f64) -> Self {
        let intervals = running.points.len().saturating_sub(1);
        let quintics = (0..intervals).map(|interval| running.quintics(interval).collect()).collect();
        Self { running, limits, quintics, step, margin }
    }

    fn from(&self, at_s: f64, first: JointPoint) -> JointTrajectory {
        let mut clock = Clock { time: at_s, rate: 1.0, acceleration: 0.0 };
        let mut points = vec![first];
        let mut recovery = Recovery { jerk: 0.0, remaining: 0.0, stops: false };
        let mut now = 0.0;
        while points.len() < MOST_STEPS && clock.time < self.running.duration_s() {
            if recovery.stops && recovery.remaining <= LAST_STEPS * self.step {
                let count = (recovery.remaining / self.step).round().max(1.0);
                for k in 1..=count as usize {
                    let part = recovery.remaining * k as f64 / count;
                    points.push(self.point(now + part, clock.after(part, recovery.jerk)));
                }
                break;
            }
            let (jerk, next) = self.brake(clock, recovery);
            recovery = next;
            clock = clock.after(self.step, jerk);
            if recovery.remaining <= 0.0 {
                clock.acceleration = 0.0;
            }
            now += self.step;
            points.push(self.point(now, clock));
        }
        // The clock stands but for rounding, or the trajectory is at its end.
        if let Some(last) = points.last_mut() {
            last.velocities.iter_mut().chain(&mut last.accelerations).for_each(|x| *x = 0.0);
        }
        JointTrajectory { joint_names: self.running.joint_names.clone(), points }
    }

    fn point(&self, now: f64, clock: Clock) -> JointPoint {
        let [q, dq, ddq, _] = self.running.at(clock.time);
        let Clock { rate, acceleration, .. } = clock;
        JointPoint {
            time_s: whole_ns(now),
            positions: q.as_slice().to_vec(),
            velocities: (&dq * rate).as_slice().to_vec(),
            accelerations: (ddq * (rate * rate) + dq * acceleration).as_slice().to_vec(),
        }
    }

    /// The jerk of the clock for the next step, and the way back from there.
    fn brake(&self, clock: Clock, fallback: Recovery) -> (f64, Recovery) {
        let coast = if fallback.remaining > 0.0 { fallback.jerk } else { 0.0 };
        let hardest = self.hardest(clock);
        for part in HARDNESS {
            let jerk = hardest + part * (coast - hardest);
            if jerk >= coast {
                break;
            }
            let next = clock.after(self.step, jerk);
            if next.rate > 0.0
                && next.acceleration < 0.0
                && self.is_legal(clock, jerk, self.step)
                && let Some(recovery) = self.recovery(next)
            {
                return (jerk, recovery);
            }
        }
        (coast, Recovery { remaining: fallback.remaining - self.step, ..fallback })
    }

    /// The lowest jerk of the clock that the joints' jerk limits allow in its present state.
    fn hardest(&self, clock: Clock) -> f64 {
        let mut least = -0.2 / (self.step * self.step);
        self.for_each_joint(clock.time, |joint, [_, v, a, j]| {
            let limit = self.limits.jerk[joint];
            let rest = j * clock.rate.powi(3) + 3.0 * a * clock.rate * clock.acceleration;
            if v != 0.0 {
                least = least.max((-limit - rest * v.signum()) / v.abs());
            }
        });
        least
    }

    /// The quickest legal way found from a slowing clock to a steady or a standing one.
    fn recovery(&self, clock: Clock) -> Option<Recovery> {
        // σ̈ rises evenly to 0 while σ̇ falls by half its product with the time; no longer than until the clock stands.
        let longest = -2.0 * clock.rate / clock.acceleration;
        let steady = RECOVERIES.map(|steps| steps * self.step).into_iter().take_while(|&t| t < longest);
        steady.map(|t| (t, false)).chain([(longest, true)]).find_map(|(remaining, stops)| {
            let jerk = -clock.acceleration / remaining;
            self.is_legal(clock, jerk, remaining).then_some(Recovery { jerk, remaining, stops })
        })
    }

    /// Whether the joints keep their limits while the clock goes on with this jerk for `duration`, twice a step.
    fn is_legal(&self, clock: Clock, jerk: f64, duration: f64) -> bool {
        let samples = (2.0 * duration / self.step).ceil().clamp(2.0, 400.0);
        (0..=samples as usize).all(|k| {
            let Clock { time, rate, acceleration } = clock.after(duration * k as f64 / samples, jerk);
            let mut legal = true;
            self.for_each_joint(time, |joint, [_, v, a, j]| {
                let accelerated = (a * rate * rate + v * acceleration).abs() / self.limits.acceleration[joint];
                let jerked =
                    (j * rate.powi(3) + 3.0 * a * rate * acceleration + v * jerk).abs() / self.limits.jerk[joint];
                // Where the trajectory itself goes closer to a limit than the margin, so may this.
                let allowed = [a.abs() / self.limits.acceleration[joint], j.abs() / self.limits.jerk[joint]];
                let [a_allowed, j_allowed] = allowed.map(|ratio| ratio.clamp(self.margin, 1.0));
                legal &= accelerated <= a_allowed && jerked <= j_allowed;
            });
            legal
        })
    }

    /// Calls `judge` with the joint and its position, velocity, acceleration and jerk on the running trajectory; not at its end.
    fn for_each_joint(&self, time: f64, mut judge: impl FnMut(usize, [f64; 4])) {
        if time >= self.running.duration_s() || self.quintics.is_empty() {
            return;
        }
        let points = &self.running.points;
        let interval = points.partition_point(|p| p.time_s <= time).clamp(1, points.len() - 1) - 1;
        let local = time - points[interval].time_s;
        self.quintics[interval].iter().enumerate().for_each(|(joint, quintic)| judge(joint, quintic.at(local)));
    }
}
