//! Arms that are too weak to hold themselves still.

use nalgebra::DVector;

use crate::bounds::Bounds;
use crate::dynamics::Dynamics;
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
    let lacking = places.filter_map(|(q, pose)| lacking(bounds, dynamics, &q, &holding_torque(dynamics, &q), pose));
    lacking.max_by(|(one, _), (other, _)| one.total_cmp(other)).map(|(_, error)| error)
}

/// What holds the links still at `q` against gravity, of shape (dof), in N·m (N for prismatic joints).
pub(crate) fn holding_torque(dynamics: &Dynamics, q: &DVector<f64>) -> DVector<f64> {
    let rest = vec![0.0; q.len()];
    let mut torque = DVector::zeros(q.len());
    dynamics.rigid_torque(q.as_slice(), &rest, &rest, torque.as_mut_slice());
    torque
}

/// The joint whose holding torque, with dry friction, is the greatest part of its effort, if that is all of it or more: the part, and
/// the refusal.
pub(crate) fn lacking(
    bounds: &Bounds<'_>,
    dynamics: &Dynamics,
    q: &DVector<f64>,
    holding: &DVector<f64>,
    pose: Option<usize>,
) -> Option<(f64, ManipulatorError)> {
    let needed = holding.iter().zip(dynamics.drives()).map(|(torque, drive)| torque.abs() + drive.friction_n_m);
    let parts = needed.zip(&bounds.limits.effort).enumerate();
    let (joint, (needed, &effort)) = parts
        .filter(|(_, (needed, effort))| *needed >= **effort)
        .max_by(|(_, (n, e)), (_, (m, f))| (n / *e).total_cmp(&(m / *f)))?;
    let (joint, configuration) = (bounds.chain.joint_names()[joint].clone(), q.as_slice().to_vec());
    Some((needed / effort, ManipulatorError::HoldingTorque { joint, pose, configuration, needed, effort }))
}
