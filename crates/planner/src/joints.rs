//! What joint states say, and when they may be relied on.

use manipulator::Robot;

use crate::motion::Motion;
use crate::refusal::Refusal;

/// A joint slower than this stands, in rad/s or m/s: above the noise of velocity estimates, below any motion on purpose.
const STANDSTILL_PER_S: f64 = 0.01;
/// A joint that moved by less than this stood still, in rad or m: above encoder noise, and small enough for a controller to take up.
pub(crate) const STANDSTILL: f64 = 0.002;

/// The robot's joints in its own order, as they were last measured.
#[derive(Debug, Clone)]
pub(crate) struct MeasuredJoints {
    at_s: f64,
    positions: Vec<f64>,
    velocities: Option<Vec<f64>>,
}

impl MeasuredJoints {
    /// Picks this robot's joints by name. `None` where some are missing: the message belongs to something else.
    ///
    /// # Errors
    /// What is wrong with the message.
    pub(crate) fn read(
        robot: &Robot,
        at_s: f64,
        names: &[String],
        positions: &[f64],
        velocities: &[f64],
    ) -> Result<Option<Self>, String> {
        let [n, p, v] = [names.len(), positions.len(), velocities.len()];
        if n != p || (v != 0 && v != n) {
            return Err(format!("it has {n} names, {p} positions and {v} velocities"));
        }
        let place = |joint: &String| names.iter().position(|name| name == joint);
        let Some(places) = robot.chain.joint_names().iter().map(place).collect::<Option<Vec<_>>>() else {
            return Ok(None);
        };
        let ours = |values: &[f64]| places.iter().map(|&i| values[i]).collect::<Vec<_>>();
        let (positions, velocities) = (ours(positions), (v != 0).then(|| ours(velocities)));
        let mut numbers = positions.iter().chain(velocities.iter().flatten());
        match numbers.position(|x| !x.is_finite()) {
            Some(bad) => Err(format!("{} is not a finite number", name(robot, bad % positions.len()))),
            None => Ok(Some(Self { at_s, positions, velocities })),
        }
    }

    pub(crate) fn age_s(&self, now_s: f64) -> f64 {
        now_s - self.at_s
    }

    /// Whether the robot was heard of within `allowed_s`.
    ///
    /// # Errors
    /// [`Refusal::StaleJointState`].
    pub(crate) fn fresh(&self, now_s: f64, allowed_s: f64) -> Result<(), Refusal> {
        let age_s = self.age_s(now_s);
        // Written so that an age that is no number is too old.
        if age_s <= allowed_s { Ok(()) } else { Err(Refusal::StaleJointState { age_s, allowed_s }) }
    }

    /// The positions of a robot that stands still and was heard of within `allowed_s`.
    ///
    /// # Errors
    /// [`Refusal::StaleJointState`], [`Refusal::Moving`].
    pub(crate) fn standing(&self, robot: &Robot, now_s: f64, allowed_s: f64) -> Result<Vec<f64>, Refusal> {
        self.fresh(now_s, allowed_s)?;
        let velocities = self.velocities.as_deref().unwrap_or_default();
        match velocities.iter().position(|velocity| velocity.abs() > STANDSTILL_PER_S) {
            Some(joint) => Err(Refusal::Moving { joint: name(robot, joint), velocity: velocities[joint] }),
            None => Ok(self.positions.clone()),
        }
    }

    /// The refusal that is due where a joint is farther than `tolerance` from where `motion` had it at the time of measuring. What was
    /// measured before the motion began says nothing of it.
    pub(crate) fn off(&self, robot: &Robot, motion: &Motion, tolerance: f64) -> Option<Refusal> {
        let since_s = self.at_s - motion.starts_at_s;
        if since_s < 0.0 {
            return None;
        }
        let expected = &motion.trajectory.at(since_s)[0];
        let by = |joint: usize| self.positions[joint] - expected[joint];
        let joint = (0..expected.len()).find(|&joint| by(joint).abs() > tolerance)?;
        Some(Refusal::OffTrajectory { joint: name(robot, joint), by: by(joint), tolerance })
    }

    /// The refusal that is due where the robot left the place from which it was planned.
    pub(crate) fn moved_from(&self, robot: &Robot, start: &[f64]) -> Option<Refusal> {
        let by = |joint: usize| self.positions[joint] - start[joint];
        let joint = (0..start.len()).find(|&joint| by(joint).abs() > STANDSTILL)?;
        Some(Refusal::MovedMeanwhile { joint: name(robot, joint), by: by(joint) })
    }
}

fn name(robot: &Robot, joint: usize) -> String {
    robot.chain.joint_names()[joint].clone()
}
