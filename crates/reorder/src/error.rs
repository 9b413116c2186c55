//! Why no order can be given.

use se3_geom::{LogError, Manifold};

/// Input that no order exists for. Points are named by their 0-based input row.
///
/// An order that is merely uncertain is no error: it comes back as [`Verdict::Ambiguous`](crate::Verdict::Ambiguous).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OrderError {
    /// Fewer points than a curve of the wanted topology has.
    #[error("{} to order, but at least {needed} are needed", there_are(*count))]
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
    #[error("all {count} points are equal up to rounding, so there is nothing to order")]
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
    /// Two different points whose distance is lost: coordinates below 1e-138 have no squares.
    #[error("the distance between points {} and {} underflows: choose a smaller unit of length", at[0], at[1])]
    DistanceUnderflow {
        /// Input rows of the points.
        at: [usize; 2],
    },
    /// The wanted start is no input row.
    #[error("the start {start} is out of range: {}, counted from 0", there_are(*count))]
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
    /// More points than noise can be taken from in bearable time.
    #[error("{count} points are too many to denoise, which takes time with their square: {most} at most")]
    TooManyToDenoise {
        /// How many were given.
        count: usize,
        /// [`MOST_DENOISED`](crate::MOST_DENOISED).
        most: usize,
    },
    /// CRUST is asked for where there is no plane.
    #[error("CRUST orders points of the plane only")]
    NotPlanar,
    /// CRUST cannot triangulate these points.
    #[error("CRUST cannot triangulate the points: a coordinate is {}", of_triangulation(reason))]
    NoTriangulation {
        /// What is wrong with a coordinate.
        reason: spade::InsertionError,
    },
    /// The length scale of SE(3) is no length.
    #[error("metres_per_radian is {}, but it, its half, its double and their squares must be positive finite numbers", number(*value))]
    InvalidLengthScale {
        /// What was given.
        value: f64,
    },
}

impl OrderError {
    /// The smaller row comes first.
    pub(crate) fn start_not_an_end(start: usize, ends: [usize; 2]) -> Self {
        Self::StartNotAnEnd { start, ends: [ends[0].min(ends[1]), ends[0].max(ends[1])] }
    }
}

/// With an exponent where it would be mostly zeros.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-4..1e6).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

fn there_are(count: usize) -> String {
    if count == 1 { "there is 1 point".to_owned() } else { format!("there are {count} points") }
}

fn of_triangulation(reason: &spade::InsertionError) -> &'static str {
    match reason {
        spade::InsertionError::TooSmall => "nearer to 0 than 1e-43, and not 0",
        spade::InsertionError::TooLarge => "beyond 1e60",
        spade::InsertionError::NAN => "not a number",
    }
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
