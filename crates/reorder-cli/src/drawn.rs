//! Points of every space as places in a picture.

use planner::se3_geom::Pose;
use planner::se3_geom::nalgebra::{Isometry2, SVector, UnitQuaternion, Vector3};
use report::Points as Drawn;

use crate::source::Points;

impl Points {
    /// The poses, where they are poses in space.
    pub(crate) fn poses(&self) -> Option<&[Pose]> {
        if let Self::Poses(poses) = self { Some(poses) } else { None }
    }

    /// Where each is drawn: flat spaces by their first three coordinates, rotations as rotation vectors.
    pub(crate) fn drawn(&self) -> Drawn {
        match self {
            Self::Plane(points) => flat(points),
            Self::Space(points) => flat(points),
            Self::Flat(points) => flat(points),
            Self::Sphere(points) => Drawn { axes: ["x", "y", "z"], places: points.clone(), directions: Vec::new() },
            Self::Rotations(points) => {
                let places = points.iter().map(UnitQuaternion::scaled_axis).collect();
                Drawn { axes: ["rx / rad", "ry / rad", "rz / rad"], places, directions: Vec::new() }
            }
            Self::PlanarPoses(points) => planar(points.iter()),
            Self::Poses(points) => Drawn::of_poses(points),
            Self::Similarities(points) => planar(points.iter().map(|point| &point.isometry)),
        }
    }
}

fn flat<const N: usize>(points: &[SVector<f64, N>]) -> Drawn {
    let coordinate = |point: &SVector<f64, N>, k: usize| if k < N { point[k] } else { 0.0 };
    let place = |point| Vector3::from_fn(|k, _| coordinate(point, k));
    Drawn { axes: ["x", "y", "z"], places: points.iter().map(place).collect(), directions: Vec::new() }
}

/// In the plane z = 0, with lines along their x axes.
fn planar<'a>(points: impl Iterator<Item = &'a Isometry2<f64>>) -> Drawn {
    let (places, directions) = points
        .map(|point| {
            let (sine, cosine) = point.rotation.angle().sin_cos();
            (point.translation.vector.push(0.0), Vector3::new(cosine, sine, 0.0))
        })
        .unzip();
    Drawn { axes: ["x", "y", "z"], places, directions }
}
