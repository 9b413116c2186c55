//! How points and tangents of each space stand in arrays.

use bag_replay::planner::se3_geom::nalgebra::{
    Isometry2, Quaternion, SVector, Similarity2, UnitQuaternion, Vector2, Vector3, Vector4,
};
use bag_replay::planner::se3_geom::{
    Euclidean, InvalidPose, LieGroup, Manifold, PlanarTwist, Pose, Se2, Se2Group, Se3, Se3Group, Sim2, Sim2Group,
    SimilarityTwist, So3, So3Group, Sphere, Twist, rotation_from_xyzw, xyzw_from_rotation,
};

/// A manifold with its coordinates in arrays.
pub(crate) trait Space: Manifold + Copy + Send + Sync {
    /// How many numbers a point has.
    const POINT: usize;
    /// Their names.
    const LAYOUT: &'static str;
    /// How many numbers a tangent vector has.
    const TANGENT: usize;
    /// Their names.
    const TANGENT_LAYOUT: &'static str;

    /// The point with these numbers.
    fn point(numbers: &[f64]) -> Result<Self::Point, String>;
    /// Appends the point's numbers.
    fn put(point: &Self::Point, numbers: &mut Vec<f64>);
    /// The tangent vector with these numbers.
    fn tangent(numbers: &[f64]) -> Self::Tangent;
    /// Appends the tangent vector's numbers.
    fn put_tangent(tangent: &Self::Tangent, numbers: &mut Vec<f64>);
}

/// A manifold whose points form a group.
pub(crate) trait Grouped: Space {
    /// The group.
    type Group: LieGroup<Element = Self::Point, Algebra = Self::Tangent>;
}

impl<const N: usize> Space for Euclidean<N> {
    const POINT: usize = N;
    const LAYOUT: &'static str = "of its coordinates";
    const TANGENT: usize = N;
    const TANGENT_LAYOUT: &'static str = "of its coordinates";

    fn point(numbers: &[f64]) -> Result<SVector<f64, N>, String> {
        Ok(SVector::from_column_slice(numbers))
    }
    fn put(point: &SVector<f64, N>, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(point.as_slice());
    }
    fn tangent(numbers: &[f64]) -> SVector<f64, N> {
        SVector::from_column_slice(numbers)
    }
    fn put_tangent(tangent: &SVector<f64, N>, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(tangent.as_slice());
    }
}

impl Space for Sphere {
    const POINT: usize = 3;
    const LAYOUT: &'static str = "x, y, z of a unit vector";
    const TANGENT: usize = 3;
    const TANGENT_LAYOUT: &'static str = "x, y, z";

    fn point(numbers: &[f64]) -> Result<Vector3<f64>, String> {
        Ok(Vector3::from_column_slice(numbers))
    }
    fn put(point: &Vector3<f64>, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(point.as_slice());
    }
    fn tangent(numbers: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(numbers)
    }
    fn put_tangent(tangent: &Vector3<f64>, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(tangent.as_slice());
    }
}

impl Space for So3 {
    const POINT: usize = 4;
    const LAYOUT: &'static str = "qx, qy, qz, qw";
    const TANGENT: usize = 3;
    const TANGENT_LAYOUT: &'static str = "of a rate in rad";

    fn point(numbers: &[f64]) -> Result<UnitQuaternion<f64>, String> {
        rotation(numbers).map_err(|reason| reason.to_string())
    }
    fn put(point: &UnitQuaternion<f64>, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(&xyzw_from_rotation(point));
    }
    fn tangent(numbers: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(numbers)
    }
    fn put_tangent(tangent: &Vector3<f64>, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(tangent.as_slice());
    }
}

impl Space for Se2 {
    const POINT: usize = 3;
    const LAYOUT: &'static str = "x, y, theta";
    const TANGENT: usize = 3;
    const TANGENT_LAYOUT: &'static str = "vx, vy, omega";

    fn point(numbers: &[f64]) -> Result<Isometry2<f64>, String> {
        Ok(Isometry2::new(Vector2::new(numbers[0], numbers[1]), numbers[2]))
    }
    fn put(point: &Isometry2<f64>, numbers: &mut Vec<f64>) {
        numbers.extend([point.translation.x, point.translation.y, point.rotation.angle()]);
    }
    fn tangent(numbers: &[f64]) -> PlanarTwist {
        PlanarTwist::from_vector(&Vector3::from_column_slice(numbers))
    }
    fn put_tangent(tangent: &PlanarTwist, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(tangent.to_vector().as_slice());
    }
}

/// A quaternion whose squared norm is that near to 1 is what normalising makes: it is taken as it is, so that what came from here goes
/// in again to the last bit.
const NORMALISED: f64 = 4.0 * f64::EPSILON;

/// The rotation with the numbers qx, qy, qz, qw.
fn rotation(numbers: &[f64]) -> Result<UnitQuaternion<f64>, InvalidPose> {
    let [x, y, z, w] = [numbers[0], numbers[1], numbers[2], numbers[3]];
    let given = Quaternion::new(w, x, y, z);
    if (given.norm_squared() - 1.0).abs() <= NORMALISED {
        return Ok(UnitQuaternion::new_unchecked(given));
    }
    rotation_from_xyzw([x, y, z, w])
}

/// The pose with the numbers x, y, z, qx, qy, qz, qw.
fn pose(numbers: &[f64]) -> Result<Pose, InvalidPose> {
    let position = Vector3::new(numbers[0], numbers[1], numbers[2]);
    if !position.iter().all(|x| x.is_finite()) {
        return Err(InvalidPose::NonFinite);
    }
    Ok(Pose::from_parts(position.into(), rotation(&numbers[3..])?))
}

impl Space for Se3 {
    const POINT: usize = 7;
    const LAYOUT: &'static str = "x, y, z, qx, qy, qz, qw";
    const TANGENT: usize = 6;
    const TANGENT_LAYOUT: &'static str = "vx, vy, vz, wx, wy, wz";

    fn point(numbers: &[f64]) -> Result<Pose, String> {
        pose(numbers).map_err(|reason| reason.to_string())
    }
    fn put(point: &Pose, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(point.translation.vector.as_slice());
        numbers.extend_from_slice(&xyzw_from_rotation(&point.rotation));
    }
    fn tangent(numbers: &[f64]) -> Twist {
        let three = |from: usize| Vector3::from_column_slice(&numbers[from..from + 3]);
        Twist::new(three(0), three(3))
    }
    fn put_tangent(tangent: &Twist, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(tangent.linear.as_slice());
        numbers.extend_from_slice(tangent.angular.as_slice());
    }
}

impl Space for Sim2 {
    const POINT: usize = 4;
    const LAYOUT: &'static str = "x, y, theta, scale";
    const TANGENT: usize = 4;
    const TANGENT_LAYOUT: &'static str = "vx, vy, omega, sigma";

    fn point(numbers: &[f64]) -> Result<Similarity2<f64>, String> {
        match numbers[3] {
            scale if scale > 0.0 => Ok(Similarity2::from_isometry(Se2::point(numbers)?, scale)),
            scale => Err(format!("scale is not positive: {scale}")),
        }
    }
    fn put(point: &Similarity2<f64>, numbers: &mut Vec<f64>) {
        Se2::put(&point.isometry, numbers);
        numbers.push(point.scaling());
    }
    fn tangent(numbers: &[f64]) -> SimilarityTwist {
        SimilarityTwist::from_vector(&Vector4::from_column_slice(numbers))
    }
    fn put_tangent(tangent: &SimilarityTwist, numbers: &mut Vec<f64>) {
        numbers.extend_from_slice(tangent.to_vector().as_slice());
    }
}

impl Grouped for So3 {
    type Group = So3Group;
}
impl Grouped for Se2 {
    type Group = Se2Group;
}
impl Grouped for Se3 {
    type Group = Se3Group;
}
impl Grouped for Sim2 {
    type Group = Sim2Group;
}

/// A space chosen when the program runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Chosen {
    R1(Euclidean<1>),
    R2(Euclidean<2>),
    R3(Euclidean<3>),
    R4(Euclidean<4>),
    R5(Euclidean<5>),
    R6(Euclidean<6>),
    R7(Euclidean<7>),
    R8(Euclidean<8>),
    S2(Sphere),
    So3(So3),
    Se2(Se2),
    Se3(Se3),
    Sim2(Sim2),
}

/// Does the same on whichever space it is.
macro_rules! on_space {
    ($chosen:expr, $space:ident => $work:expr) => {
        match $chosen {
            $crate::space::Chosen::R1($space) => $work,
            $crate::space::Chosen::R2($space) => $work,
            $crate::space::Chosen::R3($space) => $work,
            $crate::space::Chosen::R4($space) => $work,
            $crate::space::Chosen::R5($space) => $work,
            $crate::space::Chosen::R6($space) => $work,
            $crate::space::Chosen::R7($space) => $work,
            $crate::space::Chosen::R8($space) => $work,
            $crate::space::Chosen::S2($space) => $work,
            $crate::space::Chosen::So3($space) => $work,
            $crate::space::Chosen::Se2($space) => $work,
            $crate::space::Chosen::Se3($space) => $work,
            $crate::space::Chosen::Sim2($space) => $work,
        }
    };
}

/// Does the same on whichever group it is; flat spaces and the sphere get the last arm.
macro_rules! on_group {
    ($chosen:expr, $space:ident => $work:expr, else $other:expr) => {
        match $chosen {
            $crate::space::Chosen::So3($space) => $work,
            $crate::space::Chosen::Se2($space) => $work,
            $crate::space::Chosen::Se3($space) => $work,
            $crate::space::Chosen::Sim2($space) => $work,
            _ => $other,
        }
    };
}

pub(crate) use {on_group, on_space};

/// The points in rows of numbers; `what` is what a row is called where it is none.
pub(crate) fn points<S: Space>(_: S, numbers: &[f64], what: &str) -> Result<Vec<S::Point>, String> {
    let point = |(row, numbers)| S::point(numbers).map_err(|reason| format!("{what} {row}: {reason}"));
    numbers.chunks_exact(S::POINT).enumerate().map(point).collect()
}
