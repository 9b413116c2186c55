//! C² cubic splines in flat space.

use nalgebra::SVector;

use super::{Cubic, Curve, Derivatives, cubic_bends, locate};
use crate::spline_error::{SplineError, check};

/// What holds at the ends of a [`CubicSpline`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum CubicEnds<const N: usize> {
    /// The second derivative vanishes at both ends.
    #[default]
    Natural,
    /// The first derivatives at both ends (thesis eq. 6.9).
    Clamped {
        /// At the first point.
        start: SVector<f64, N>,
        /// At the last point.
        end: SVector<f64, N>,
    },
    /// A closed curve: one more segment leads from the last point back to the first (thesis eq. 6.10).
    Periodic,
    /// The third derivative is continuous at the second and at the last but one knot, so that a cubic is reproduced. With three
    /// points a parabola, with two a line.
    NotAKnot,
}

/// The C² piecewise cubic p(t) through points of ℝᴺ; N = 1 is the scalar spline.
///
/// ```
/// use se3_geom::{nalgebra::Vector1, CubicEnds, CubicSpline, Curve};
/// let cube = |t: f64| Vector1::new(t * t * t);
/// let knots = [0.0, 1.0, 3.0, 4.0, 6.0];
/// let spline = CubicSpline::through(&knots.map(cube), &knots, CubicEnds::NotAKnot)?;
/// assert!((spline.point(5.0) - cube(5.0)).norm() < 1e-12);
/// # Ok::<(), se3_geom::SplineError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CubicSpline<const N: usize> {
    knots: Vec<f64>,
    pieces: Vec<Cubic<N>>,
    closed: bool,
}

impl<const N: usize> CubicSpline<N> {
    /// The spline that passes `points[i]` at parameter `knots[i]`. With [`CubicEnds::Periodic`] one further knot says where the
    /// curve is back at `points[0]`.
    ///
    /// # Errors
    /// [`SplineError`] for fewer than two points, knots that do not increase or do not fit, numbers that are not finite, and
    /// slopes that overflow.
    pub fn through(points: &[SVector<f64, N>], knots: &[f64], ends: CubicEnds<N>) -> Result<Self, SplineError> {
        let closed = ends == CubicEnds::Periodic;
        let finite = |p: &SVector<f64, N>| p.iter().all(|x| x.is_finite());
        check(points, knots, closed, 2, finite)?;
        if let CubicEnds::Clamped { start, end } = &ends
            && !(finite(start) && finite(end))
        {
            return Err(SplineError::NonFiniteEndVelocity);
        }
        let ends_of = |values: &[SVector<f64, N>], i: usize| [values[i], values[(i + 1) % values.len()]];
        let lengths: Vec<f64> = knots.windows(2).map(|k| k[1] - k[0]).collect();
        let steps: Vec<_> = (0..lengths.len()).map(|i| ends_of(points, i)).map(|[p, q]| q - p).collect();
        let bends = cubic_bends(&steps, &lengths, ends).ok_or(SplineError::Overflow)?;
        let pieces = lengths.iter().enumerate().map(|(i, &h)| Cubic::bent(h, ends_of(points, i), ends_of(&bends, i)));
        Ok(Self { knots: knots.to_vec(), pieces: pieces.collect(), closed })
    }

    /// Whether the curve ends where it began.
    pub fn is_closed(&self) -> bool {
        self.closed
    }
}

impl<const N: usize> Curve for CubicSpline<N> {
    type Point = SVector<f64, N>;
    type Tangent = SVector<f64, N>;

    fn domain(&self) -> (f64, f64) {
        (self.knots[0], self.knots[self.knots.len() - 1])
    }
    fn derivatives(&self, t: f64) -> Derivatives<Self::Point, Self::Tangent> {
        let (piece, local) = locate(&self.knots, self.closed, t);
        let [point, velocity, acceleration, jerk] = self.pieces[piece].at(local);
        Derivatives { point, velocity, acceleration, jerk }
    }
    fn point(&self, t: f64) -> Self::Point {
        let (piece, local) = locate(&self.knots, self.closed, t);
        self.pieces[piece].value(local)
    }
    fn knots(&self) -> Vec<f64> {
        self.knots.clone()
    }
}
