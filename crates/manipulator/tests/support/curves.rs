//! Tool curves in the UR5e's workspace.

use manipulator::Robot;
use manipulator::nalgebra::{Translation3, UnitQuaternion, Vector3};
use se3_geom::{Ends, Pose, PoseSpline, Se3, centripetal_knots};

/// `count` poses of a pen that writes a lying, slowly growing loop in front of the arm and leans along its stroke.
pub(crate) fn writing(robot: &Robot, count: usize) -> Vec<Pose> {
    let home = robot.chain.forward(&robot.preferred);
    (0..count)
        .map(|i| {
            let u = i as f64 / (count - 1) as f64;
            let angle = 7.0 * u;
            let radius = 0.05 + 0.05 * u;
            let offset = Vector3::new(radius * angle.cos() - 0.05, radius * angle.sin(), 0.01 * (5.0 * u).sin());
            let lean =
                UnitQuaternion::from_scaled_axis(Vector3::new(0.3 * angle.sin(), 0.3 * angle.cos() - 0.3, 0.4 * u));
            Pose::from_parts(Translation3::from(home.translation.vector + offset), home.rotation * lean)
        })
        .collect()
}

pub(crate) fn spline(poses: &[Pose]) -> PoseSpline {
    let knots = centripetal_knots(&Se3::default(), poses);
    PoseSpline::through(poses, &knots, Ends::Natural).unwrap()
}
