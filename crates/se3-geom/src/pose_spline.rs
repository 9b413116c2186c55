//! The C² spline through poses: midpoint-chart cubic for rotations, ordinary cubic for positions, on the same knots.

use std::f64::consts::PI;

use nalgebra::Vector3;

use crate::curve::{Cubic, CubicEnds, Curve, Derivatives, cubic_bends, locate, within};
use crate::group::{LieGroup, So3Group};
use crate::manifold::Manifold;
use crate::pose::Pose;
use crate::rotation_segment::RotationSegment;
use crate::se3::Se3;
use crate::spline_error::{SplineError, check};
use crate::spline_rates::{EndRates, spline_bends};
use crate::twist::Twist;

#[path = "pose_spline_detours.rs"]
mod detours;

/// How close to half a turn two successive rotations may come, in rad. Nearer than that rounding would choose the side.
pub const HALF_TURN_MARGIN_RAD: f64 = 1e-9;

/// By how much the angle that a segment turns through may exceed the angle between its two rotations at most, in rad. More
/// means that the curve winds, which very uneven knots can cause.
pub const WINDING_BOUND_RAD: f64 = PI;

/// What holds at the ends of a [`PoseSpline`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Ends {
    /// Acceleration (linear and angular) vanishes at both ends. Second order accurate near them, fourth inside.
    #[default]
    Natural,
    /// Body twists at both ends, per unit of the parameter.
    Clamped {
        /// At the first pose.
        start: Twist,
        /// At the last pose.
        end: Twist,
    },
    /// A closed curve: one more segment leads from the last pose back to the first, and twist and acceleration match there.
    Periodic,
}

/// A pose with the motion through it, per unit of the curve's parameter. Everything but the pose is in the body (tool) frame.
///
/// `linear` parts are Rᵀp′, Rᵀp″, Rᵀp‴ (derivatives of the position, turned into the tool frame, not derivatives of body
/// components); `angular` parts are ω, ω′, ω″ with R′ = R\[ω\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// `world_from_tool`.
    pub pose: Pose,
    /// First derivative.
    pub twist: Twist,
    /// Second derivative.
    pub acceleration: Twist,
    /// Third derivative; jumps at the knots.
    pub jerk: Twist,
}

/// A C² curve through every one of its poses: the *midpoint-chart cubic* of rotations, and on the same knots the ordinary C² cubic
/// spline of positions.
///
/// Between poses i and i + 1, tᵢ apart from tᵢ₊₁ = tᵢ + h, with θ = log(RᵢᵀRᵢ₊₁):
///
/// R(tᵢ + s) = Rᵢ·Exp(θ/2)·Exp(φ(s)), p(tᵢ + s) a cubic,
///
/// where φ is the cubic vector polynomial that leads from −θ/2 to θ/2 with the end slopes φ′ = Jr⁻¹(φ)·ω of the body rates ωᵢ, ωᵢ₊₁.
/// These rates are the unknowns: they are solved for so that the angular acceleration is continuous at every knot (Newton's method
/// on a block-tridiagonal system). A chart in the middle of each piece makes the curve the same seen from either end. Fourth order, as
/// cubic splines of flat space, of which this is the counterpart on SO(3); the cumulative B-spline (Kim, Kim, Shin 1995) is of
/// third order and not symmetric.
///
/// A curve is refused, not returned, where two successive rotations are within [`HALF_TURN_MARGIN_RAD`] of half a turn, where the
/// equations are not solved to rounding, and where a piece is longer than its own step by more than twice the largest step next to
/// it (in metres or in radians) or turns by [`WINDING_BOUND_RAD`] too much: see [`SplineError`].
///
/// Left-invariant and symmetric: moving all poses by g moves the curve by g, reversing the poses reverses the curve. With
/// clamped or periodic ends it is fourth order accurate in the knot spacing, its twist third, its acceleration second.
///
/// ```
/// # use se3_geom::{centripetal_knots, pose_from_xyzw, Ends, PoseSpline, Se3};
/// let poses = [
///     pose_from_xyzw([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])?,
///     pose_from_xyzw([0.1, 0.0, 0.0], [0.0, 0.0, 0.6, 0.8])?,
///     pose_from_xyzw([0.1, 0.1, 0.0], [0.0, 0.0, 1.0, 0.0])?,
/// ];
/// let knots = centripetal_knots(&Se3::default(), &poses);
/// let spline = PoseSpline::through(&poses, &knots, Ends::Natural)?;
/// let [before, after] = [knots[1].next_down(), knots[1]].map(|t| spline.at(t));
/// assert!((before.acceleration - after.acceleration).to_vector().norm() < 1e-11);
/// assert!(spline.at(knots[2]).acceleration.to_vector().norm() < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PoseSpline {
    knots: Vec<f64>,
    segments: Vec<Segment>,
    closed: bool,
}

#[derive(Debug, Clone, Copy)]
struct Segment {
    position: Cubic<3>,
    rotation: RotationSegment,
}

impl PoseSpline {
    /// The spline that passes `poses[i]` at parameter `knots[i]`. With [`Ends::Periodic`] one further knot says where the curve
    /// is back at `poses[0]`.
    ///
    /// # Errors
    /// [`SplineError`] where the input admits no such curve, or none was found.
    pub fn through(poses: &[Pose], knots: &[f64], ends: Ends) -> Result<Self, SplineError> {
        let closed = ends == Ends::Periodic;
        check(poses, knots, closed, if closed { 3 } else { 2 }, |p| Se3::default().is_finite(p))?;
        let lengths: Vec<f64> = knots.windows(2).map(|k| k[1] - k[0]).collect();
        let next = |i: usize| (i + 1) % poses.len();
        let turns = turns_between(poses, lengths.len())?;
        let steps: Vec<_> =
            (0..lengths.len()).map(|i| poses[next(i)].translation.vector - poses[i].translation.vector).collect();
        let (position_ends, rotation_ends) = ends_of_parts(ends, &poses[0], &poses[poses.len() - 1])?;
        let bends = cubic_bends(&steps, &lengths, position_ends).ok_or(SplineError::Overflow)?;
        let chart_bends =
            spline_bends(&turns, &lengths, rotation_ends).map_err(|residual| SplineError::NotConverged { residual })?;
        let mut segments = Vec::with_capacity(lengths.len());
        for (i, &h) in lengths.iter().enumerate() {
            let j = next(i);
            let ends = [poses[i].translation.vector, poses[j].translation.vector];
            let position = Cubic::bent(h, ends, [bends[i], bends[j]]);
            let rotation = RotationSegment::new(&poses[i].rotation, turns[i], h, chart_bends[i]);
            segments.push(Segment { position, rotation });
        }
        let spline = Self { knots: knots.to_vec(), segments, closed };
        spline.refuse_detours(poses, &steps, &turns)?;
        Ok(spline)
    }

    /// The parameter at every pose, increasing; on a closed curve also the one at which the first pose is reached again.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// First and last parameter.
    pub fn domain(&self) -> (f64, f64) {
        (self.knots[0], self.knots[self.knots.len() - 1])
    }

    /// Whether the curve ends where it began.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Pose and derivatives at parameter `t`. Beyond its domain an open curve stays at its end, **with the derivatives it has there**
    /// (a controller that overruns must set them to zero); a closed one goes round again.
    pub fn at(&self, t: f64) -> Motion {
        let (segment, local) = locate(&self.knots, self.closed, t);
        self.in_segment(segment, local)
    }

    /// The pose alone at parameter `t`, as [`Self::at`].
    pub fn pose(&self, t: f64) -> Pose {
        let (segment, local) = locate(&self.knots, self.closed, t);
        let Segment { position, rotation } = &self.segments[segment];
        Pose::from_parts(position.value(local).into(), rotation.rotation(local))
    }

    /// [`Self::at`] for one parameter after the other, in any order. Where a parameter lies in the segment of the one before or
    /// in the next, as increasing ones mostly do, no search is made.
    ///
    /// ```
    /// # use se3_geom::{pose_from_xyzw, Ends, PoseSpline};
    /// # let poses = [0.0, 0.1, 0.3].map(|x| pose_from_xyzw([x, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).unwrap());
    /// let spline = PoseSpline::through(&poses, &[0.0, 1.0, 2.0], Ends::Natural)?;
    /// let fastest = spline.along((0..=200).map(|k| 0.01 * k as f64)).map(|m| m.twist.linear.norm()).fold(0.0, f64::max);
    /// assert!(fastest > 0.2);
    /// # Ok::<(), se3_geom::SplineError>(())
    /// ```
    pub fn along<I: IntoIterator<Item = f64>>(&self, parameters: I) -> impl Iterator<Item = Motion> {
        let last = self.segments.len() - 1;
        let mut segment = 0;
        parameters.into_iter().map(move |t| {
            let t = within(&self.knots, self.closed, t);
            if t >= self.knots[segment + 1] && segment < last {
                segment += 1;
            }
            let inside = self.knots[segment] <= t && (t < self.knots[segment + 1] || segment == last);
            if !inside {
                (segment, _) = locate(&self.knots, self.closed, t);
            }
            self.in_segment(segment, t - self.knots[segment])
        })
    }

    /// [`Self::at`] for every one of the parameters; quickest where they increase.
    ///
    /// For very many points [`Self::along`] is quicker still: a million motions are 200 MB, and the operating system takes longer to
    /// hand out that much fresh memory than the evaluation takes. Extend a vector that was used before by it, or keep of each
    /// motion what is needed.
    pub fn sample(&self, parameters: &[f64]) -> Vec<Motion> {
        self.along(parameters.iter().copied()).collect()
    }

    #[inline]
    fn in_segment(&self, segment: usize, local: f64) -> Motion {
        let Segment { position, rotation } = &self.segments[segment];
        let [p, v, a, j] = position.at(local);
        let turn = rotation.at(local);
        let body = turn.rotation.inverse();
        Motion {
            pose: Pose::from_parts(p.into(), turn.rotation),
            twist: Twist::new(body * v, turn.rate),
            acceleration: Twist::new(body * a, turn.acceleration),
            jerk: Twist::new(body * j, turn.jerk),
        }
    }
}

impl Curve for PoseSpline {
    type Point = Pose;
    type Tangent = Twist;

    fn domain(&self) -> (f64, f64) {
        self.domain()
    }
    fn derivatives(&self, t: f64) -> Derivatives<Pose, Twist> {
        let Motion { pose, twist, acceleration, jerk } = self.at(t);
        Derivatives { point: pose, velocity: twist, acceleration, jerk }
    }
    fn point(&self, t: f64) -> Pose {
        self.pose(t)
    }
    fn knots(&self) -> Vec<f64> {
        self.knots.clone()
    }
}

/// θᵢ = log(RᵢᵀRᵢ₊₁) for every segment, cyclically.
pub(crate) fn turns_between(poses: &[Pose], segments: usize) -> Result<Vec<Vector3<f64>>, SplineError> {
    let turn = |i: usize| {
        let j = (i + 1) % poses.len();
        So3Group::log(&(poses[i].rotation.inverse() * poses[j].rotation))
            .ok()
            .filter(|theta| theta.norm() < PI - HALF_TURN_MARGIN_RAD)
            .ok_or(SplineError::HalfTurn { from: i, to: j })
    };
    (0..segments).map(turn).collect()
}

fn ends_of_parts(ends: Ends, first: &Pose, last: &Pose) -> Result<(CubicEnds<3>, EndRates), SplineError> {
    Ok(match ends {
        Ends::Natural => (CubicEnds::Natural, EndRates::Natural),
        Ends::Periodic => (CubicEnds::Periodic, EndRates::Periodic),
        Ends::Clamped { start, end } => {
            if !start.to_vector().iter().chain(end.to_vector().iter()).all(|x| x.is_finite()) {
                return Err(SplineError::NonFiniteEndVelocity);
            }
            let velocities =
                CubicEnds::Clamped { start: first.rotation * start.linear, end: last.rotation * end.linear };
            (velocities, EndRates::Clamped([start.angular, end.angular]))
        }
    })
}

#[cfg(test)]
#[path = "pose_spline_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "pose_spline_edge_tests.rs"]
mod edge_tests;

#[cfg(test)]
#[path = "pose_spline_detour_tests.rs"]
mod detour_tests;
