//! How near a joint path comes to singularities and position limits.

use serde::Serialize;

use crate::continuation::least_singular_value;
use crate::error::Result;
use crate::ik::gram;
use crate::joint_path::JointPath;
use crate::robot::Robot;

/// A figure at its worst place along a path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Worst {
    /// The figure.
    pub value: f64,
    /// Parameter of the path at which it is taken.
    pub parameter: f64,
    /// Index of the pose that is nearest in the parameter.
    pub pose: usize,
}

/// A path of the joints in figures, each at the worst of its samples and their midpoints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PathReport {
    /// Yoshikawa's manipulability √det(J·Jᵀ) with J the body Jacobian, rows in m and rad (Yoshikawa 1985, eq. 8); zero for fewer than
    /// six joints.
    pub manipulability: Worst,
    /// Least singular value of the same Jacobian: the tool's least speed, in m/s or rad/s, for joint rates of norm one.
    pub singular_value: Worst,
    /// Least distance of any joint from its position limits, in rad or m; infinite where no joint has any.
    pub limit_margin: Worst,
    /// Name of the joint with the least margin.
    pub limit_joint: String,
}

impl PathReport {
    /// The report of `path`, made for `robot`.
    ///
    /// ```
    /// # use manipulator::{EndDerivatives, JointPath, PathReport, Robot, nalgebra::DVector};
    /// let robot = Robot::shipped("ur5e")?;
    /// let (mut bent, mut straight) = (robot.preferred.clone(), robot.preferred.clone());
    /// (bent[2], straight[2]) = (1.0, 0.1);
    /// let end = EndDerivatives { first: &straight - &bent, second: DVector::zeros(6) };
    /// let path = JointPath::through(&[0.0, 1.0], &[bent, straight], [&end, &end])?;
    /// let report = PathReport::of(&robot, &path)?;
    /// assert_eq!((report.singular_value.pose, report.singular_value.parameter), (1, 1.0));
    /// # Ok::<(), manipulator::ManipulatorError>(())
    /// ```
    ///
    /// # Errors
    /// [`crate::ManipulatorError::WrongSize`] for a path of another number of joints.
    pub fn of(robot: &Robot, path: &JointPath) -> Result<Self> {
        robot.check_configuration("the joint path", &path.at(path.domain().0)[0])?;
        let nothing = Worst { value: f64::INFINITY, parameter: path.domain().0, pose: 0 };
        let (mut manipulability, mut singular_value, mut limit_margin) = (nothing, nothing, nothing);
        let mut limit_joint = 0;
        let middles = path.knots().windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        for parameter in path.knots().iter().copied().chain(middles) {
            let [q, ..] = path.at(parameter);
            let jacobian = robot.chain.body_jacobian(&q);
            let gram = gram(&jacobian);
            let determinant = gram.cholesky().map_or(0.0, |factor| factor.determinant());
            let note = |worst: &mut Worst, value: f64| {
                let less = value < worst.value;
                if less {
                    *worst = Worst { value, parameter, pose: nearest_pose(path, parameter) };
                }
                less
            };
            note(&mut manipulability, determinant.sqrt());
            // σ₆² ≥ det/(trace/5)⁵: eigenvalues are needed only where that does not settle it.
            let at_least = (determinant / (0.2 * gram.trace()).powi(5)).sqrt();
            if at_least < singular_value.value {
                note(&mut singular_value, least_singular_value(&jacobian));
            }
            for joint in 0..q.len() {
                let margin = (q[joint] - robot.limits.lower[joint]).min(robot.limits.upper[joint] - q[joint]);
                if note(&mut limit_margin, margin) {
                    limit_joint = joint;
                }
            }
        }
        let limit_joint = robot.chain.joint_names()[limit_joint].clone();
        Ok(Self { manipulability, singular_value, limit_margin, limit_joint })
    }
}

pub(crate) fn nearest_pose(path: &JointPath, parameter: f64) -> usize {
    let poses = path.pose_parameters();
    let after = poses.partition_point(|&s| s < parameter).min(poses.len() - 1);
    let before = after.saturating_sub(1);
    if parameter - poses[before] < poses[after] - parameter { before } else { after }
}
