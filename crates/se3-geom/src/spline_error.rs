//! Why no spline was put through given points.

/// Points (poses) through which no spline was put, and why. Indices count from 0 in the given sequence.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Fewer points than the curve takes.
    #[error("a spline needs at least {needed} points, {given} given")]
    TooFewPoses {
        /// How many it takes.
        needed: usize,
        /// How many there are.
        given: usize,
    },
    /// The number of knots does not fit the number of points.
    #[error("{expected} knots belong to these points, {given} given")]
    KnotCount {
        /// One a point, and one more for a closed curve.
        expected: usize,
        /// How many there are.
        given: usize,
    },
    /// A knot is not finite or not greater than the one before: often two equal points under a parameter by distance.
    #[error("knot {index} ({value}) does not come after the one before: merge equal points first")]
    KnotsNotIncreasing {
        /// Which.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A point has a coordinate that is not finite.
    #[error("point {index} has a coordinate that is not a finite number")]
    NonFinitePose {
        /// Which.
        index: usize,
    },
    /// An end twist or end slope has a coordinate that is not finite.
    #[error("an end velocity has a coordinate that is not a finite number")]
    NonFiniteEndVelocity,
    /// Two successive rotations are half a turn apart, so that both ways round are equally short.
    #[error("poses {from} and {to} are half a turn apart: which way round is undetermined, add a pose between them")]
    HalfTurn {
        /// First pose of the pair.
        from: usize,
        /// Second pose of the pair.
        to: usize,
    },
    /// The slopes of the curve are beyond the range of floating-point numbers.
    #[error("the slopes of the spline overflow: its knots are too close for the distances between its points")]
    Overflow,
    /// The equations of continuity were not solved.
    #[error("the C2 conditions were not met: the best solution leaves a relative acceleration jump of {residual:.1e}")]
    NotConverged {
        /// Greatest acceleration jump left, relative to the terms it is the sum of.
        residual: f64,
    },
    /// The spline turns much farther than the poses between which it leads.
    #[error(
        "between poses {from} and {to} the spline turns {turned_rad:.3} rad for a difference of {difference_rad:.3} rad: the knots are too uneven (C2 to {residual:.1e})"
    )]
    Winding {
        /// First pose of the pair.
        from: usize,
        /// Second pose of the pair.
        to: usize,
        /// Angle that the curve turns through, in rad.
        turned_rad: f64,
        /// Angle between the two poses, in rad.
        difference_rad: f64,
        /// What the C² conditions leave: the greatest jump of twist or acceleration at a knot, relative to the greatest at any.
        residual: f64,
    },
    /// The spline goes much farther than the positions between which it leads.
    #[error(
        "between poses {from} and {to} the spline goes {travelled_m:.3e} m for a distance of {distance_m:.3e} m: the knots are too uneven (C2 to {residual:.1e})"
    )]
    Overshoot {
        /// First pose of the pair.
        from: usize,
        /// Second pose of the pair.
        to: usize,
        /// Length of the curve, in m.
        travelled_m: f64,
        /// Distance of the two poses, in m.
        distance_m: f64,
        /// What the C² conditions leave: the greatest jump of twist or acceleration at a knot, relative to the greatest at any.
        residual: f64,
    },
}

/// Checks what every spline needs: enough finite points, and one increasing knot for each, with one more on a closed curve.
pub(crate) fn check<P>(
    points: &[P],
    knots: &[f64],
    closed: bool,
    needed: usize,
    is_finite: impl Fn(&P) -> bool,
) -> Result<(), SplineError> {
    if points.len() < needed {
        return Err(SplineError::TooFewPoses { needed, given: points.len() });
    }
    let expected = points.len() + usize::from(closed);
    if knots.len() != expected {
        return Err(SplineError::KnotCount { expected, given: knots.len() });
    }
    if let Some(index) = points.iter().position(|p| !is_finite(p)) {
        return Err(SplineError::NonFinitePose { index });
    }
    for (i, pair) in knots.windows(2).enumerate() {
        let ascends = pair[0].is_finite() && pair[1].is_finite() && pair[1] > pair[0];
        if !ascends {
            return Err(SplineError::KnotsNotIncreasing { index: i + 1, value: pair[1] });
        }
    }
    Ok(())
}
