//! What a configuration costs by itself, and the self-motion that is left to a redundant arm.

use nalgebra::{DMatrix, DVector, Matrix6xX};

use crate::ik::gram;
use crate::robot::Robot;

/// Whether a joint may take every direction: whole turns are then chosen last, so that the whole path fits its limits.
pub(crate) fn turns_freely(robot: &Robot, joint: usize) -> bool {
    robot.chain.is_rotary(joint)
        && robot.limits.upper[joint] - robot.limits.lower[joint] >= std::f64::consts::TAU - 1e-9
}

/// The first joint beyond its limits that no whole turn would bring back.
pub(crate) fn first_violation(robot: &Robot, q: &DVector<f64>) -> Option<usize> {
    let beyond = |i: usize| q[i] < robot.limits.lower[i] - 1e-9 || q[i] > robot.limits.upper[i] + 1e-9;
    (0..q.len()).find(|&i| beyond(i) && !turns_freely(robot, i))
}

/// `q` with whole turns added to the joints that turn freely, so that each is nearest to `reference`.
pub(crate) fn unwound(robot: &Robot, q: &DVector<f64>, reference: &DVector<f64>) -> DVector<f64> {
    let turn = std::f64::consts::TAU;
    DVector::from_fn(q.len(), |i, _| {
        let turns = if turns_freely(robot, i) { ((reference[i] - q[i]) / turn).round() } else { 0.0 };
        q[i] + turn * turns
    })
}

/// The greatest distance of any joint between two configurations, whole turns of freely turning joints apart.
pub(crate) fn separation(robot: &Robot, a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    let turn = std::f64::consts::TAU;
    let apart = |i: usize| {
        let way = a[i] - b[i];
        if turns_freely(robot, i) { way - turn * (way / turn).round() } else { way }
    };
    (0..a.len()).map(|i| apart(i).abs()).fold(0.0, f64::max)
}

/// −Σ ln(1 − xᵢ²) − ½ ln det JJᵀ, with xᵢ ∈ (−1, 1) the place of joint i in its range: without bound towards position limits and
/// singularities. Joints that turn freely have no place.
pub(crate) fn discomfort(robot: &Robot, q: &DVector<f64>, jacobian: &Matrix6xX<f64>) -> f64 {
    let limits = &robot.limits;
    let barrier = |i: usize| {
        let half = 0.5 * (limits.upper[i] - limits.lower[i]);
        if turns_freely(robot, i) || !half.is_finite() {
            return 0.0;
        }
        let x = (q[i] - limits.lower[i]) / half - 1.0;
        // At a limit itself, which is legal, the cost is great and finite.
        -(1.0 - x * x).max(1e-6).ln()
    };
    let determinant = gram(jacobian).cholesky().map_or(0.0, |c| c.determinant());
    (0..q.len()).map(barrier).sum::<f64>() - 0.5 * determinant.max(1e-30).ln()
}

/// An orthonormal basis, of shape (dof, dof − 6), of the joint rates that leave the tool where it is; `None` at a singularity.
pub(crate) fn self_motions(jacobian: &Matrix6xX<f64>) -> Option<DMatrix<f64>> {
    let dof = jacobian.ncols();
    let gram = gram(jacobian).cholesky()?;
    // I − J⁺J, whose columns span the null-space; pivoted Gram–Schmidt takes the longest that is left.
    let mut rest = DMatrix::identity(dof, dof) - jacobian.transpose() * gram.solve(jacobian);
    let mut basis = DMatrix::zeros(dof, dof.saturating_sub(6));
    for k in 0..basis.ncols() {
        let longest = (0..dof).max_by(|&a, &b| rest.column(a).norm().total_cmp(&rest.column(b).norm()))?;
        let unit = rest.column(longest).normalize();
        rest -= &unit * (unit.transpose() * &rest);
        basis.set_column(k, &unit);
    }
    Some(basis)
}
