//! A trajectory matched to the servos that are to execute it.

use planner::manipulator::JointTrajectory;
use planner::manipulator::nalgebra::DVector;

use crate::error::{Result, SimError};
use crate::servo::Servo;

/// A checked trajectory, read in the order of the servos.
pub(crate) struct Command<'a> {
    trajectory: &'a JointTrajectory,
    /// For each servo, the joint's place in the trajectory.
    places: Vec<usize>,
}

impl<'a> Command<'a> {
    /// Matches joints by name and refuses what a controller could not execute.
    pub(crate) fn new(trajectory: &'a JointTrajectory, servos: &[Servo]) -> Result<Self> {
        let names = &trajectory.joint_names;
        if let Some((_, twice)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            return Err(SimError::DuplicateJoint { joint: twice.clone() });
        }
        let listed = |names: Vec<&str>| names.join(", ");
        let present: Vec<&str> = servos.iter().map(|servo| servo.joint.as_str()).collect();
        let unknown: Vec<&str> = names.iter().map(String::as_str).filter(|name| !present.contains(name)).collect();
        if !unknown.is_empty() {
            return Err(SimError::MissingInModel { missing: listed(unknown), present: listed(present) });
        }
        let place = |joint: &&str| names.iter().position(|name| name == joint);
        let silent: Vec<&str> = present.iter().copied().filter(|joint| place(joint).is_none()).collect();
        if !silent.is_empty() {
            return Err(SimError::MissingInTrajectory { missing: listed(silent) });
        }
        check_points(trajectory)?;
        Ok(Self { trajectory, places: present.iter().filter_map(place).collect() })
    }

    /// Position, velocity and acceleration at `time_s`, servo by servo; at rest beyond both ends.
    pub(crate) fn at(&self, time_s: f64) -> [DVector<f64>; 3] {
        let [position, velocity, acceleration, _] = self.trajectory.at(time_s);
        [position, velocity, acceleration].map(|values| values.select_rows(&self.places))
    }
}

impl Command<'_> {
    /// Interval by interval and servo by servo, the Bézier points of the quintic that leads from point to point: it stays between the
    /// least and the greatest of them, and its way is at most the sum of their differences.
    pub(crate) fn bezier_points(&self) -> impl Iterator<Item = Vec<[f64; 6]>> {
        self.trajectory.points.windows(2).map(|pair| {
            let h = pair[1].time_s - pair[0].time_s;
            let quintic = |&joint: &usize| {
                let [from, to] = [&pair[0], &pair[1]].map(|p| {
                    (p.positions[joint], h * p.velocities[joint] / 5.0, h * h * p.accelerations[joint] / 20.0)
                });
                let (p0, v0, a0) = from;
                let (p5, v5, a5) = to;
                [p0, p0 + v0, p0 + 2.0 * v0 + a0, p5 - 2.0 * v5 + a5, p5 - v5, p5]
            };
            self.places.iter().map(quintic).collect()
        })
    }
}

fn check_points(trajectory: &JointTrajectory) -> Result<()> {
    if trajectory.points.is_empty() {
        return Err(SimError::EmptyTrajectory);
    }
    let expected = trajectory.joint_names.len();
    let mut earliest = 0.0;
    for (index, point) in trajectory.points.iter().enumerate() {
        let vectors = [
            ("positions", &point.positions),
            ("velocities", &point.velocities),
            ("accelerations", &point.accelerations),
        ];
        for (what, values) in vectors {
            let what = || format!("{what} of point {index} of the trajectory");
            if values.len() != expected {
                return Err(SimError::WrongSize { what: what(), expected, given: values.len() });
            }
            if !values.iter().all(|value| value.is_finite()) {
                return Err(SimError::NonFinite { what: what() });
            }
        }
        if !point.time_s.is_finite() {
            return Err(SimError::NonFinite { what: format!("the time of point {index} of the trajectory") });
        }
        if point.time_s < earliest || (index > 0 && point.time_s == earliest) {
            return Err(SimError::TimesNotIncreasing { point: index, time_s: point.time_s });
        }
        earliest = point.time_s;
    }
    Ok(())
}
