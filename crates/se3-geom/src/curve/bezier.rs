//! De Casteljau's construction with straight lines of any space.

use super::{Curve, Derivatives, Jet, JetSpace};
use crate::manifold::LogError;

/// The cubic Bézier curve with control points Q₁ … Q₄ on t ∈ \[0, 1\]: de Casteljau's repeated linear interpolation, with the
/// space's straight lines for line segments (thesis §6.2.3). It passes Q₁ and Q₄.
///
/// With [`Se3`](crate::Se3) the straight lines are slerp and straight lines of the origin; with
/// [`Se3Group`](crate::Se3Group) they are screw motions. Two pieces joined at a pose with one twist are C¹; C² needs the
/// control points solved for, which [`PoseSpline`](crate::PoseSpline) does.
///
/// ```
/// use se3_geom::{nalgebra::Vector3, Bezier, Curve, R3};
/// // Thesis Example 6.1. The tangent printed for P₁ is (1, 1, 0), with which z would be 2t² − t³; (6.8) has (1, 1, 1).
/// let (p1, p2) = (Vector3::zeros(), Vector3::new(1.0, 1.0, 1.0));
/// let curve = Bezier::from_end_velocities(R3::default(), [p1, p2], [Vector3::new(1.0, 1.0, 1.0), Vector3::z()])?;
/// let t: f64 = 0.3;
/// let x = -t.powi(3) + t.powi(2) + t;
/// assert!((curve.point(t) - Vector3::new(x, x, t)).norm() < 1e-15);
/// # Ok::<(), se3_geom::LogError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bezier<S: JetSpace> {
    space: S,
    control_points: [S::Point; 4],
}

impl<S: JetSpace> Bezier<S> {
    /// The curve with these control points.
    ///
    /// # Errors
    /// [`LogError`] where two successive control points are not joined by one straight line, or are not finite. Where they are,
    /// so are all the points of the construction: no two of them are farther apart in angle.
    pub fn new(space: S, control_points: [S::Point; 4]) -> Result<Self, LogError> {
        for pair in control_points.windows(2) {
            space.joins(&pair[0], &pair[1])?;
        }
        Ok(Self { space, control_points })
    }

    /// The curve between two points with given velocities there, per unit of t: Q₂ lies a third of the first velocity after Q₁,
    /// Q₃ a third of the last before Q₄ (thesis eq. 6.15).
    ///
    /// # Errors
    /// As [`Self::new`], and for an angular velocity of 3π or more, whose third no control point can express.
    pub fn from_end_velocities(
        space: S,
        [start, end]: [S::Point; 2],
        [leaving, arriving]: [S::Tangent; 2],
    ) -> Result<Self, LogError> {
        let second = space.straight(&start, leaving * (1.0 / 3.0))?;
        let third = space.straight(&end, arriving * (-1.0 / 3.0))?;
        Self::new(space, [start, second, third, end])
    }

    /// Q₁ … Q₄.
    pub fn control_points(&self) -> &[S::Point; 4] {
        &self.control_points
    }
}

impl<S: JetSpace> Curve for Bezier<S> {
    type Point = S::Point;
    type Tangent = S::Tangent;

    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }
    fn derivatives(&self, t: f64) -> Derivatives<S::Point, S::Tangent> {
        let t = Jet::variable(t.clamp(0.0, 1.0));
        let mut points = self.control_points.each_ref().map(|p| self.space.at_rest(p));
        for level in (1..points.len()).rev() {
            for i in 0..level {
                points[i] = self.space.between(&points[i], &points[i + 1], t);
            }
        }
        self.space.derivatives(&points[0])
    }
}
