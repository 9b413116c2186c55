//! Points of whatever space, as places in the picture.

use planner::se3_geom::Pose;
use planner::se3_geom::nalgebra::{Matrix3, Vector3};

/// Where points are drawn, by input row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    /// What the three axes of the picture are, as "x / m".
    pub axes: [&'static str; 3],
    /// One place a point.
    pub places: Vec<Vector3<f64>>,
    /// Unit vectors along which a short line is drawn from each place; empty for points without orientation.
    pub directions: Vec<Vector3<f64>>,
}

impl Points {
    /// Poses: the tool's origin, and a line back along the tool's z axis, the way in which most tools point.
    pub fn of_poses(poses: &[Pose]) -> Self {
        Self {
            axes: ["x / m", "y / m", "z / m"],
            places: poses.iter().map(|pose| pose.translation.vector).collect(),
            directions: poses.iter().map(|pose| pose.rotation * -Vector3::z()).collect(),
        }
    }

    /// The middle of the box around all, where it is farther from zero than hundred times the box is wide: there the seven digits of the
    /// picture's numbers leave less than five to it.
    pub(crate) fn far_middle(&self) -> Option<Vector3<f64>> {
        let least = self.places.iter().fold(Vector3::repeat(f64::INFINITY), |least, place| least.inf(place));
        let most = self.places.iter().fold(Vector3::repeat(f64::NEG_INFINITY), |most, place| most.sup(place));
        let middle = 0.5 * (least + most);
        (middle.norm() > 100.0 * (most - least).norm() && middle.iter().all(|x| x.is_finite())).then_some(middle)
    }

    /// The direction from which most of the points is seen: the normal of the plane they come nearest to, from above.
    pub(crate) fn seen_from(&self) -> Vector3<f64> {
        let n = self.places.len().max(1) as f64;
        let middle = self.places.iter().sum::<Vector3<f64>>() / n;
        let spread = self.places.iter().fold(Matrix3::zeros(), |sum, place| {
            let offset = place - middle;
            sum + offset * offset.transpose()
        });
        let eigen = spread.symmetric_eigen();
        let normal: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
        // A sum of the three with weights that no axis shares: of two opposite normals always the same one.
        let side = normal.z + 1e-3 * (normal.x - 2.0 * normal.y);
        if !normal.iter().all(|x| x.is_finite()) {
            Vector3::z()
        } else if side < 0.0 {
            -normal
        } else {
            normal
        }
    }
}
