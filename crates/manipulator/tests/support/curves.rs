//! Tool curves in an arm's workspace.

use super::{Random, configuration_within};
use manipulator::Robot;
use manipulator::nalgebra::{Translation3, UnitQuaternion, Vector3};
use se3_geom::{Ends, Pose, PoseSpline, Se3, centripetal_knots};

/// `count` poses of a pen that writes a lying, slowly growing loop in front of the arm and leans along its stroke.
pub(crate) fn writing(robot: &Robot, count: usize) -> Vec<Pose> {
    scaled_writing(robot, count, 1.0)
}

/// [`writing`] of another size.
pub(crate) fn scaled_writing(robot: &Robot, count: usize, scale: f64) -> Vec<Pose> {
    let home = robot.chain.forward(&robot.preferred);
    (0..count)
        .map(|i| {
            let u = i as f64 / (count - 1) as f64;
            let angle = 7.0 * u;
            let radius = 0.05 + 0.05 * u;
            let offset = Vector3::new(radius * angle.cos() - 0.05, radius * angle.sin(), 0.01 * (5.0 * u).sin());
            let lean =
                UnitQuaternion::from_scaled_axis(Vector3::new(0.3 * angle.sin(), 0.3 * angle.cos() - 0.3, 0.4 * u));
            Pose::from_parts(Translation3::from(home.translation.vector + offset * scale), home.rotation * lean)
        })
        .collect()
}

pub(crate) fn spline(poses: &[Pose]) -> PoseSpline {
    let knots = centripetal_knots(&Se3::default(), poses);
    PoseSpline::through(poses, &knots, Ends::Natural).unwrap()
}

/// A curve of three harmonics through the tool pose of a random configuration, open or closed, through 20 to 200 poses. Not every
/// one can be followed.
pub(crate) fn random_curve(robot: &Robot, random: &mut Random) -> PoseSpline {
    let middle = robot.chain.forward(&configuration_within(robot, 0.8, random));
    let scales = [0.1, 0.1, 0.1, 0.3, 0.3, 0.3];
    let harmonics: Vec<([f64; 6], [f64; 6])> = (1..=3)
        .map(|order| {
            let amplitudes = scales.map(|scale| scale * random.between(-1.0, 1.0) / f64::from(order));
            (amplitudes, scales.map(|_| random.between(0.0, std::f64::consts::TAU)))
        })
        .collect();
    let closed = random.unit() < 0.5;
    let count = random.between(20.0, 200.0) as usize;
    let span = std::f64::consts::TAU * if closed { 1.0 } else { random.between(0.4, 0.9) };
    let poses: Vec<Pose> = (0..count)
        .map(|i| {
            let angle = span * i as f64 / (count - usize::from(!closed)) as f64;
            let mut offset = [0.0; 6];
            for (order, (amplitudes, phases)) in harmonics.iter().enumerate() {
                for k in 0..6 {
                    offset[k] += amplitudes[k] * (angle * (order + 1) as f64 + phases[k]).sin();
                }
            }
            let [x, y, z, a, b, c] = offset;
            let lean = UnitQuaternion::from_scaled_axis(Vector3::new(a, b, c));
            Pose::from_parts((middle.translation.vector + Vector3::new(x, y, z)).into(), middle.rotation * lean)
        })
        .collect();
    if closed { closed_spline(&poses) } else { spline(&poses) }
}

/// The closed curve that leads from the last pose back to the first.
pub(crate) fn closed_spline(poses: &[Pose]) -> PoseSpline {
    let round: Vec<Pose> = poses.iter().chain(poses.first()).copied().collect();
    PoseSpline::through(poses, &centripetal_knots(&Se3::default(), &round), Ends::Periodic).unwrap()
}
