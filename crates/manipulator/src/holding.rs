//! Arms that are too weak to hold themselves still, or to move however slowly.

use nalgebra::DVector;

use crate::bounds::Bounds;
use crate::dynamics::{Dynamics, direction};
use crate::error::ManipulatorError;
use crate::joint_path::JointPath;
use crate::path_report::nearest_pose;
use crate::trajectory::JointTrajectory;

/// Where along the path, at its knots and between them, a joint lacks most to move the arm slowly against gravity and dry friction;
/// `None` where every joint can.
pub(crate) fn too_weak_along(path: &JointPath, bounds: &Bounds<'_>) -> Option<ManipulatorError> {
    let middles = path.knots().windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let places = path.knots().iter().copied().chain(middles);
    weakest(
        bounds,
        places.map(|s| {
            let [q, rates, ..] = path.at(s);
            (q, rates, Some(nearest_pose(path, s)))
        }),
    )
}

/// The same of the points of a move that leads through no poses.
pub(crate) fn too_weak_for(trajectory: &JointTrajectory, bounds: &Bounds<'_>) -> Option<ManipulatorError> {
    let column = |values: &[f64]| DVector::from_column_slice(values);
    weakest(bounds, trajectory.points.iter().map(|p| (column(&p.positions), column(&p.velocities), None)))
}

fn weakest(
    bounds: &Bounds<'_>,
    places: impl Iterator<Item = (DVector<f64>, DVector<f64>, Option<usize>)>,
) -> Option<ManipulatorError> {
    let dynamics = bounds.dynamics.filter(|_| bounds.rules.torque)?;
    let lacking =
        places.filter_map(|(q, rates, pose)| lacking(bounds, &q, &SlowTorque::new(dynamics, &q, &rates), pose));
    lacking.max_by(|(one, _), (other, _)| one.total_cmp(other)).map(|(_, error)| error)
}

/// What a motion takes that is ever so slow, joint by joint, in N·m (N for prismatic joints).
pub(crate) struct SlowTorque {
    /// What holds the links still against gravity.
    pub(crate) holding: DVector<f64>,
    /// That and dry friction, which acts against the motion: it helps where gravity drives the joint.
    pub(crate) moving: DVector<f64>,
}

impl SlowTorque {
    /// At `q`, with rates of the signs of `rates`, both of shape (dof). Joints that stand have no friction.
    pub(crate) fn new(dynamics: &Dynamics, q: &DVector<f64>, rates: &DVector<f64>) -> Self {
        let rest = vec![0.0; q.len()];
        let mut holding = DVector::zeros(q.len());
        dynamics.rigid_torque(q.as_slice(), &rest, &rest, holding.as_mut_slice());
        let mut moving = holding.clone();
        for ((torque, drive), rate) in moving.iter_mut().zip(dynamics.drives()).zip(rates) {
            *torque += drive.friction_n_m * direction(*rate);
        }
        Self { holding, moving }
    }
}

/// The joint whose torque in slow motion is the greatest part of its effort, if that is all of it or more: the part, and the refusal.
pub(crate) fn lacking(
    bounds: &Bounds<'_>,
    q: &DVector<f64>,
    slow: &SlowTorque,
    pose: Option<usize>,
) -> Option<(f64, ManipulatorError)> {
    let part = |joint: usize| slow.moving[joint].abs() / bounds.limits.effort[joint];
    let weak = (0..q.len()).filter(|&joint| part(joint) >= 1.0);
    let joint = weak.max_by(|&one, &other| part(one).total_cmp(&part(other)))?;
    let effort = bounds.limits.effort[joint];
    let held = slow.holding[joint].abs();
    let refusal = ManipulatorError::HoldingTorque {
        joint: bounds.chain.joint_names()[joint].clone(),
        pose,
        configuration: q.as_slice().to_vec(),
        moving: held < effort,
        needed: if held < effort { slow.moving[joint].abs() } else { held },
        effort,
        unit: if bounds.chain.is_rotary(joint) { "N·m" } else { "N" },
    };
    Some((part(joint), refusal))
}
