//! Why no order can be given.

use se3_geom::{LogError, Manifold};

/// Input that no order exists for. Points are named by their 0-based input row.
///
/// An order that is merely uncertain is no error: it comes back as [`Verdict::Ambiguous`](crate::Verdict::Ambiguous).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OrderError {
    /// Fewer points than a curve of the wanted topology has.
    #[error("there are {count} points to order, but at least {needed} are needed")]
    TooFewPoints {
        /// How many were given.
        count: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Duplicates leave fewer distinct points than a curve of the wanted topology has.
    #[error("the {count} points hold only {distinct} distinct ones, but at least {needed} are needed")]
    TooFewDistinct {
        /// How many were given.
        count: usize,
        /// How many remain when equal ones are merged.
        distinct: usize,
        /// How many are needed.
        needed: usize,
    },
    /// All points are the same one.
    #[error("all {count} points are equal, so there is nothing to order")]
    AllEqual {
        /// How many were given.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("point {index} has a coordinate that is not a finite number")]
    NonFinite {
        /// Input row of the point.
        index: usize,
    },
    /// Finite coordinates that are no point of the manifold: a quaternion or a direction whose squared norm is more than 1e-6 off 1.
    #[error("point {index} is not on the manifold: a quaternion or a direction must have norm 1")]
    NotAPoint {
        /// Input row of the point.
        index: usize,
    },
    /// Two finite points whose distance is no finite number.
    #[error("the distance between points {} and {} overflows", at[0], at[1])]
    DistanceOverflow {
        /// Input rows of the points.
        at: [usize; 2],
    },
    /// The wanted start is no input row.
    #[error("the start {start} is out of range: there are {count} points, counted from 0")]
    StartOutOfRange {
        /// The wanted start.
        start: usize,
        /// How many points there are.
        count: usize,
    },
    /// The wanted start lies inside an open curve.
    #[error("the start {start} is not an end of the open curve, whose ends are points {} and {}", ends[0], ends[1])]
    StartNotAnEnd {
        /// The wanted start.
        start: usize,
        /// Input rows of the two ends.
        ends: [usize; 2],
    },
    /// The wanted start lies on none of several curves that were told apart.
    #[error("the start {start} stands apart from every curve")]
    StartApart {
        /// The wanted start.
        start: usize,
    },
    /// CRUST is asked for where there is no plane.
    #[error("CRUST orders points of the plane only")]
    NotPlanar,
    /// CRUST cannot triangulate these points.
    #[error("CRUST cannot triangulate the points: {reason}")]
    NoTriangulation {
        /// What is wrong with a coordinate.
        reason: spade::InsertionError,
    },
    /// The length scale of SE(3) is no length.
    #[error("metres_per_radian is {value}, but it and its square must be positive finite numbers")]
    InvalidLengthScale {
        /// What was given.
        value: f64,
    },
}

/// Refuses the first point that is none, before anything is measured.
pub(crate) fn check_points<M: Manifold>(manifold: &M, points: &[M::Point]) -> Result<(), OrderError> {
    for (index, p) in points.iter().enumerate() {
        if !manifold.is_finite(p) {
            return Err(OrderError::NonFinite { index });
        }
        if matches!(manifold.log(p, p), Err(LogError::NotAPoint)) {
            return Err(OrderError::NotAPoint { index });
        }
    }
    Ok(())
}
