//! The controller of an arm: which trajectory it plays, and where the joints are to be at every time.
//!
//! As `joint_trajectory_controller` of ros2_control does, it connects points by quintics, starts at the header's stamp (at once where that
//! is zero), and drops what it plays when something newer comes. It is stricter: a trajectory that would begin with a jump is refused.

use manipulator::nalgebra::DVector;
use manipulator::{JointPoint, JointTrajectory, Robot, TimingOptions, slow_to_stop};

use crate::arm::Present;

/// A joint may be this far from where a trajectory has it when it is taken up, in rad (m for slides): the noise of joint states.
pub const START_TOLERANCE: f64 = 0.01;

/// Plays trajectories on an arm's clock, in s. Positions are in rad (m for slides), in the robot's joint order.
#[derive(Debug, Clone)]
pub struct Controller {
    robot: Robot,
    playing: JointTrajectory,
    /// When the time of what is played is 0, in s of the arm's clock.
    since_s: f64,
    number: u64,
}

/// Why a trajectory is not taken up, by the result codes of FollowJointTrajectory.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refused {
    /// It is malformed, or would begin with a jump.
    #[error("{0}")]
    Goal(String),
    /// It is for other joints.
    #[error("{0}")]
    Joints(String),
    /// It is over.
    #[error("the trajectory ended {ago_s:.3} s ago by its header's stamp")]
    Old {
        /// How long, in s.
        ago_s: f64,
    },
    /// The arm cannot move.
    #[error("the arm stands still after a fault: {0}")]
    Faulty(String),
}

impl Controller {
    /// At rest at a configuration, in the robot's joint order.
    pub fn at_rest(robot: Robot, positions: &[f64]) -> Self {
        let playing = rest(robot.chain.joint_names(), positions);
        Self { robot, playing, since_s: 0.0, number: 0 }
    }

    /// The arm that it is for.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// What is played; its time 0 may be past.
    pub fn playing(&self) -> &JointTrajectory {
        &self.playing
    }

    /// Drops what is played, and rests at a configuration, wherever that is: only for joints that stand there.
    pub fn rest_at(&mut self, now_s: f64, positions: &[f64]) {
        self.playing = rest(self.robot.chain.joint_names(), positions);
        self.since_s = now_s;
    }

    /// Takes a trajectory up that begins at `starts_at_s` of the arm's clock, in the past or the future, or at once. Returns its number.
    ///
    /// # Errors
    /// Where it is no trajectory for this arm, is over, or would begin with a jump.
    pub fn play(&mut self, now_s: f64, starts_at_s: Option<f64>, trajectory: JointTrajectory) -> Result<u64, Refused> {
        let mut next = self.in_own_order(trajectory)?;
        let since_s = starts_at_s.unwrap_or(now_s);
        let ends_at_s = since_s + next.duration_s();
        if ends_at_s < now_s {
            return Err(Refused::Old { ago_s: now_s - ends_at_s });
        }
        // Where it takes over: at its start, or now if that is over.
        let takes_over_s = since_s.max(now_s);
        let (from, to) = (self.playing.at(takes_over_s - self.since_s), next.at(takes_over_s - since_s));
        for (kind, (from, to)) in ["position", "velocity"].into_iter().zip(from.iter().zip(&to)) {
            if let Some(joint) = (0..from.len()).find(|&joint| (from[joint] - to[joint]).abs() > START_TOLERANCE) {
                let (name, by) = (&next.joint_names[joint], to[joint] - from[joint]);
                return Err(Refused::Goal(format!("{name} would begin with a jump of its {kind} by {by:.4}")));
            }
        }
        if takes_over_s > now_s {
            // Until then what is played goes on.
            let before = self.playing.after((now_s - self.since_s).clamp(0.0, self.playing.duration_s()));
            next = before.switched(takes_over_s - now_s, &next);
            (self.playing, self.since_s) = (next, now_s);
        } else {
            (self.playing, self.since_s) = (next, since_s);
        }
        self.number += 1;
        Ok(self.number)
    }

    /// Stops on the path, as soon as the limits allow. What breaks limits is braked all the same, as hard as it accelerates itself.
    pub fn stop(&mut self, now_s: f64) {
        let at_s = now_s - self.since_s;
        let slowed = slow_to_stop(&self.robot, &self.playing, at_s, &TimingOptions::default());
        if let Ok(stop) = slowed {
            (self.playing, self.since_s) = (stop, now_s);
        } else if at_s > 0.0 && at_s < self.playing.duration_s() {
            let stop = braked(&self.playing, at_s, self.robot.limits.acceleration.as_slice());
            (self.playing, self.since_s) = (stop, now_s);
        }
    }

    /// When the arm will rest, in s of its clock.
    pub fn ends_at_s(&self) -> f64 {
        self.since_s + self.playing.duration_s()
    }

    /// Where the joints are to be: position, velocity (per s), acceleration (per s²).
    pub fn at(&self, now_s: f64) -> [DVector<f64>; 3] {
        let [position, velocity, acceleration, _] = self.playing.at(now_s - self.since_s);
        [position, velocity, acceleration]
    }

    /// What there is to say of an arm whose joints are so.
    pub fn present(&self, now_s: f64, position: Vec<f64>, velocity: Vec<f64>) -> Present {
        Present {
            now_s,
            number: self.number,
            position,
            velocity,
            desired: self.at(now_s).map(|values| values.as_slice().to_vec()),
            goal: self.goal().to_vec(),
            ends_at_s: self.ends_at_s(),
            fault: None,
        }
    }

    /// The last point: where everything ends.
    pub fn goal(&self) -> &[f64] {
        self.playing.points.last().map_or(&[], |point| &point.positions)
    }

    /// Checks a trajectory, and puts its joints into the robot's order.
    fn in_own_order(&self, trajectory: JointTrajectory) -> Result<JointTrajectory, Refused> {
        let own = self.robot.chain.joint_names();
        let given = &trajectory.joint_names;
        let place = |name: &String| given.iter().position(|other| other == name);
        let places: Option<Vec<usize>> = own.iter().map(place).collect();
        let places = places.filter(|_| given.len() == own.len()).ok_or_else(|| {
            Refused::Joints(format!("the joints are {}, but the arm has {}", given.join(", "), own.join(", ")))
        })?;
        if trajectory.points.is_empty() {
            return Err(Refused::Goal("the trajectory has no points".into()));
        }
        let mut points = Vec::with_capacity(trajectory.points.len());
        for (index, point) in trajectory.points.into_iter().enumerate() {
            let pick = |kind: &str, values: &[f64]| -> Result<Vec<f64>, Refused> {
                if values.len() != own.len() || !values.iter().all(|value| value.is_finite()) {
                    return Err(Refused::Goal(format!("point {index} has not one finite {kind} for every joint")));
                }
                Ok(places.iter().map(|&place| values[place]).collect())
            };
            let before = points.last().map(|before: &JointPoint| before.time_s);
            if point.time_s < 0.0 || before.is_some_and(|before| point.time_s <= before) {
                return Err(Refused::Goal(format!("the time of point {index} does not come after the one before")));
            }
            let moves = point.velocities.iter().any(|velocity| velocity.abs() > START_TOLERANCE);
            if points.is_empty() && point.time_s > 0.0 && moves {
                return Err(Refused::Goal("nothing leads to the speed of the first point, whose time is not 0".into()));
            }
            points.push(JointPoint {
                time_s: point.time_s,
                positions: pick("position", &point.positions)?,
                velocities: pick("velocity", &point.velocities)?,
                accelerations: pick("acceleration", &point.accelerations)?,
            });
        }
        let last = &points[points.len() - 1];
        if last.velocities.iter().any(|velocity| velocity.abs() > START_TOLERANCE) {
            return Err(Refused::Goal("the last point is not at rest".into()));
        }
        Ok(JointTrajectory { joint_names: own.to_vec(), points })
    }
}

/// Points of a braked trajectory.
const BRAKING_POINTS: usize = 50;

/// A trajectory from its time `at_s` on, whose clock is slowed to a standstill: with u = t/T the rate of time is 1 − (10u³ − 15u⁴ + 6u⁵), which
/// begins and ends without a jump of acceleration. It falls by at most 15/8 a T, and T is such that this decelerates no joint by more than
/// its limit, or than the trajectory itself accelerates it.
fn braked(running: &JointTrajectory, at_s: f64, accelerations: &[f64]) -> JointTrajectory {
    let left_s = running.duration_s() - at_s;
    let hardest = running.points.iter().fold(accelerations.to_vec(), |most, point| {
        most.iter().zip(&point.accelerations).map(|(most, a)| most.max(a.abs())).collect()
    });
    let taken_s = |fastest: &[f64]| {
        fastest.iter().zip(&hardest).fold(0.0, |most: f64, (v, hardest)| most.max(1.875 * v.abs() / hardest))
    };
    // The joints may be faster later on the way than they are now.
    let fastest_within = |span_s: f64| {
        let samples = (0..=BRAKING_POINTS).map(|k| at_s + span_s * k as f64 / BRAKING_POINTS as f64);
        let zeros = vec![0.0_f64; accelerations.len()];
        samples.fold(zeros, |most, time_s| {
            let [_, velocity, ..] = running.at(time_s);
            most.iter().zip(velocity.iter()).map(|(most, v)| most.max(v.abs())).collect()
        })
    };
    let [_, now, ..] = running.at(at_s);
    let first_s = taken_s(now.as_slice());
    // Half of T passes on the running clock.
    let span_s = taken_s(&fastest_within((0.5 * first_s).min(left_s))).max(1e-3);
    let points = (0..=BRAKING_POINTS).map(|k| {
        let u = k as f64 / BRAKING_POINTS as f64;
        let passed_s = span_s * (u - (2.5 * u.powi(4) - 3.0 * u.powi(5) + u.powi(6)));
        let rate = 1.0 - (10.0 * u.powi(3) - 15.0 * u.powi(4) + 6.0 * u.powi(5));
        let slowing = -30.0 * (u * (1.0 - u)).powi(2) / span_s;
        let [position, velocity, acceleration, _] = running.at(at_s + passed_s);
        let curved = &acceleration * (rate * rate) + &velocity * slowing;
        JointPoint {
            time_s: span_s * u,
            positions: position.as_slice().to_vec(),
            velocities: (velocity * rate).as_slice().to_vec(),
            accelerations: curved.as_slice().to_vec(),
        }
    });
    JointTrajectory { joint_names: running.joint_names.clone(), points: points.collect() }
}

/// The trajectory of one point.
fn rest(joint_names: &[String], positions: &[f64]) -> JointTrajectory {
    let zeros = vec![0.0; positions.len()];
    let point =
        JointPoint { time_s: 0.0, positions: positions.to_vec(), velocities: zeros.clone(), accelerations: zeros };
    JointTrajectory { joint_names: joint_names.to_vec(), points: vec![point] }
}

#[cfg(test)]
#[path = "controller_tests.rs"]
mod tests;
