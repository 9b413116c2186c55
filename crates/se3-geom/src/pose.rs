//! Poses and the one door through which quaternions come in.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

/// Where a tool is: `world_from_tool`, a rotation and a position in metres.
pub type Pose = Isometry3<f64>;

/// How far the norm of an incoming quaternion may be from 1 before it is refused rather than normalised.
///
/// Single-precision and five-decimal text sources stay below 1e-4; a forgotten normalisation or a wrong field is far above.
pub const UNIT_QUATERNION_TOLERANCE: f64 = 1e-3;

/// Numbers that are no pose.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum InvalidPose {
    /// A coordinate is NaN or infinite.
    #[error("a coordinate is not a finite number")]
    NonFinite,
    /// All four components vanish: often a default-constructed message.
    #[error("the quaternion is zero, so there is no orientation")]
    ZeroQuaternion,
    /// The quaternion is no rotation.
    #[error("the quaternion has norm {norm:.6} instead of 1")]
    NotUnit {
        /// Its Euclidean norm.
        norm: f64,
    },
}

/// The rotation of a quaternion given in the order x, y, z, w (ROS, CSV, TUM).
///
/// # Errors
/// [`InvalidPose`] where a component is not finite or the norm is off by more than [`UNIT_QUATERNION_TOLERANCE`].
pub fn rotation_from_xyzw([x, y, z, w]: [f64; 4]) -> Result<UnitQuaternion<f64>, InvalidPose> {
    let quaternion = Quaternion::new(w, x, y, z);
    if !quaternion.coords.iter().all(|c| c.is_finite()) {
        return Err(InvalidPose::NonFinite);
    }
    let norm = quaternion.norm();
    if norm == 0.0 {
        return Err(InvalidPose::ZeroQuaternion);
    }
    if (norm - 1.0).abs() > UNIT_QUATERNION_TOLERANCE {
        return Err(InvalidPose::NotUnit { norm });
    }
    Ok(UnitQuaternion::new_normalize(quaternion))
}

/// The pose at a position in metres with a quaternion in the order x, y, z, w.
///
/// # Errors
/// [`InvalidPose`] where a number is not finite or the quaternion is no rotation.
pub fn pose_from_xyzw(position: [f64; 3], quaternion_xyzw: [f64; 4]) -> Result<Pose, InvalidPose> {
    if !position.iter().all(|c| c.is_finite()) {
        return Err(InvalidPose::NonFinite);
    }
    let [x, y, z] = position;
    Ok(Pose::from_parts(Translation3::new(x, y, z), rotation_from_xyzw(quaternion_xyzw)?))
}

/// The components of a rotation in the order x, y, z, w.
pub fn xyzw_from_rotation(rotation: &UnitQuaternion<f64>) -> [f64; 4] {
    [rotation.i, rotation.j, rotation.k, rotation.w]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn quaternion_order_is_xyzw() {
        // A quarter turn about x takes y to z; with w first the same numbers would be a different rotation.
        let s = 0.5_f64.sqrt();
        let pose = pose_from_xyzw([1.0, 2.0, 3.0], [s, 0.0, 0.0, s]).unwrap();
        assert!((pose.rotation * Vector3::y() - Vector3::z()).norm() < 1e-15);
        assert_eq!(xyzw_from_rotation(&pose.rotation), [s, 0.0, 0.0, s]);
        assert_eq!(pose.translation.vector, Vector3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn numbers_that_are_no_pose_are_refused() {
        let unit = [0.0, 0.0, 0.0, 1.0];
        assert_eq!(pose_from_xyzw([f64::NAN, 0.0, 0.0], unit), Err(InvalidPose::NonFinite));
        assert_eq!(pose_from_xyzw([0.0; 3], [0.0, f64::INFINITY, 0.0, 1.0]), Err(InvalidPose::NonFinite));
        assert_eq!(pose_from_xyzw([0.0; 3], [0.0; 4]), Err(InvalidPose::ZeroQuaternion));
        assert_eq!(pose_from_xyzw([0.0; 3], [0.0, 0.0, 0.0, 2.0]), Err(InvalidPose::NotUnit { norm: 2.0 }));
        assert!(pose_from_xyzw([0.0; 3], [0.0, 0.0, 0.0, 1.0 + 0.9e-3]).is_ok());
    }
}
