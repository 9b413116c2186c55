//! Arms that are too weak to hold themselves still.

use nalgebra::DVector;

use crate::bounds::Bounds;
use crate::error::ManipulatorError;
use crate::joint_path::JointPath;
use crate::path_report::nearest_pose;
use crate::trajectory::JointTrajectory;

/// Where along the path, at its knots and between them, a joint lacks most to hold the arm against gravity and dry friction; `None`
/// where every joint can.
pub(crate) fn too_weak_along(path: &JointPath, bounds: &Bounds<'_>) -> Option<ManipulatorError> {
    let middles = path.knots().windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let places = path.knots().iter().copied().chain(middles);
    weakest(bounds, places.map(|s| (path.at(s)[0].clone(), Some(nearest_pose(path, s)))))
}

/// The same of the points of a move that leads through no poses.
pub(crate) fn too_weak_for(trajectory: &JointTrajectory, bounds: &Bounds<'_>) -> Option<ManipulatorError> {
    weakest(bounds, trajectory.points.iter().map(|point| (DVector::from_column_slice(&point.positions), None)))
}

fn weakest(
    bounds: &Bounds<'_>,
    places: impl Iterator<Item = (DVector<f64>, Option<usize>)>,
) -> Option<ManipulatorError> {
    let dynamics = bounds.dynamics.filter(|_| bounds.rules.torque)?;
    let rest = vec![0.0; bounds.limits.lower.len()];
    let (mut torque, mut greatest, mut found) = (rest.clone(), 0.0, None);
    for (q, pose) in places {
        dynamics.torque(q.as_slice(), &rest, &rest, &mut torque);
        for (joint, drive) in dynamics.drives().enumerate() {
            let (needed, effort) = (torque[joint].abs() + drive.friction_n_m, bounds.limits.effort[joint]);
            if needed / effort >= 1.0 && needed / effort > greatest {
                greatest = needed / effort;
                let (joint, configuration) = (bounds.chain.joint_names()[joint].clone(), q.as_slice().to_vec());
                found = Some(ManipulatorError::HoldingTorque { joint, pose, configuration, needed, effort });
            }
        }
    }
    found
}
