//! The C² spline through poses: midpoint-chart cubic for rotations, ordinary cubic for positions, on the same knots.

use std::f64::consts::PI;

use nalgebra::Vector3;

use crate::group::{LieGroup, So3Group};
use crate::manifold::Manifold;
use crate::pose::Pose;
use crate::rotation_segment::{Cubic, RotationSegment};
use crate::spline_rates::{Chain, EndRates, Problem};
use crate::twist::Twist;

/// How close to half a turn two successive rotations may come, in rad. Nearer than that rounding would choose the side.
pub const HALF_TURN_MARGIN_RAD: f64 = 1e-9;

/// By how much the angle that a segment turns through may exceed the angle between its two rotations at most, in rad. More
/// means that the curve winds, which very uneven knots can cause.
pub const WINDING_BOUND_RAD: f64 = PI;

/// By how many times the largest step near a segment (its own or a neighbour's) its length may exceed its own step. A smooth
/// curve exceeds it by per cents, one round a sharp corner by a fraction of the step, one that winds or overshoots by several.
const DETOUR: f64 = 2.0;

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

/// Poses through which no spline was put, and why. Indices count from 0 in the given sequence.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Fewer than two poses, or fewer than three for a closed curve.
    #[error("a spline needs at least {needed} poses, {given} given")]
    TooFewPoses {
        /// How many it takes.
        needed: usize,
        /// How many there are.
        given: usize,
    },
    /// The number of knots does not fit the number of poses.
    #[error("{expected} knots belong to these poses, {given} given")]
    KnotCount {
        /// One a pose, and one more for a closed curve.
        expected: usize,
        /// How many there are.
        given: usize,
    },
    /// A knot is not finite or not greater than the one before: often two equal poses under a parameter by distance.
    #[error("knot {index} ({value}) does not come after the one before: merge equal poses first")]
    KnotsNotIncreasing {
        /// Which.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A pose has a coordinate that is not finite.
    #[error("pose {index} has a coordinate that is not a finite number")]
    NonFinitePose {
        /// Which.
        index: usize,
    },
    /// Two successive rotations are half a turn apart, so that both ways round are equally short.
    #[error("poses {from} and {to} are half a turn apart: which way round is undetermined, add a pose between them")]
    HalfTurn {
        /// First pose of the pair.
        from: usize,
        /// Second pose of the pair.
        to: usize,
    },
    /// The equations of continuity were not solved.
    #[error("the C2 conditions were not met: the best solution leaves a relative acceleration jump of {residual:.1e}")]
    NotConverged {
        /// Greatest acceleration jump left, relative to the terms it is the sum of.
        residual: f64,
    },
    /// The spline turns much farther than the poses between which it leads.
    #[error(
        "between poses {from} and {to} the spline turns {turned_rad:.3} rad for a difference of {difference_rad:.3} rad: the knots are too uneven"
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
    },
    /// The spline goes much farther than the positions between which it leads.
    #[error(
        "between poses {from} and {to} the spline goes {travelled_m:.3e} m for a distance of {distance_m:.3e} m: the knots are too uneven"
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
    },
    /// A given end twist is not finite.
    #[error("an end twist has a component that is not a finite number")]
    NonFiniteTwist,
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

/// A C² curve through every one of its poses.
///
/// Left-invariant and symmetric: moving all poses by g moves the curve by g, reversing the poses reverses the curve.
#[derive(Debug, Clone)]
pub struct PoseSpline {
    knots: Vec<f64>,
    positions: Vec<Cubic>,
    rotations: Vec<RotationSegment>,
    closed: bool,
}

/// Knots by the centripetal rule tᵢ₊₁ − tᵢ = √d(pᵢ, pᵢ₊₁), from 0, one a point (Lee 1989).
///
/// Milder at uneven gaps than chord length, whose acceleration explodes next to near-duplicates. For a closed curve give the
/// first point again at the end.
pub fn centripetal_knots<M: Manifold>(manifold: &M, points: &[M::Point]) -> Vec<f64> {
    let mut knots = Vec::with_capacity(points.len());
    knots.extend(points.first().map(|_| 0.0));
    for pair in points.windows(2) {
        let last = knots[knots.len() - 1];
        knots.push(last + manifold.distance(&pair[0], &pair[1]).sqrt());
    }
    knots
}

impl PoseSpline {
    /// The spline that passes `poses[i]` at parameter `knots[i]`. With [`Ends::Periodic`] one further knot says where the curve
    /// is back at `poses[0]`.
    ///
    /// # Errors
    /// [`SplineError`] where the input admits no such curve, or none was found.
    pub fn through(poses: &[Pose], knots: &[f64], ends: Ends) -> Result<Self, SplineError> {
        let closed = ends == Ends::Periodic;
        check(poses, knots, closed)?;
        let segments = knots.len() - 1;
        let next = |i: usize| &poses[(i + 1) % poses.len()];
        let lengths: Vec<f64> = knots.windows(2).map(|k| k[1] - k[0]).collect();
        let mut turns = Vec::with_capacity(segments);
        for i in 0..segments {
            let theta = So3Group::log(&(poses[i].rotation.inverse() * next(i).rotation))
                .ok()
                .filter(|theta| theta.norm() < PI - HALF_TURN_MARGIN_RAD)
                .ok_or(SplineError::HalfTurn { from: i, to: (i + 1) % poses.len() })?;
            turns.push(theta);
        }
        let steps: Vec<_> = (0..segments).map(|i| next(i).translation.vector - poses[i].translation.vector).collect();
        let (position_ends, rotation_ends) = match ends {
            Ends::Natural => (EndRates::Natural, EndRates::Natural),
            Ends::Periodic => (EndRates::Periodic, EndRates::Periodic),
            Ends::Clamped { start, end } => {
                let last = &poses[poses.len() - 1];
                let velocities = [poses[0].rotation * start.linear, last.rotation * end.linear];
                (EndRates::Clamped(velocities), EndRates::Clamped([start.angular, end.angular]))
            }
        };
        if let Ends::Clamped { start, end } = ends
            && !start.to_vector().iter().chain(end.to_vector().iter()).all(|x| x.is_finite())
        {
            return Err(SplineError::NonFiniteTwist);
        }
        let solve = |displacements: &[Vector3<f64>], ends, chain| {
            Problem { displacements, lengths: &lengths, ends, chain }
                .solve()
                .map_err(|residual| SplineError::NotConverged { residual })
        };
        let velocities = solve(&steps, position_ends, Chain::Positions)?;
        let rates = solve(&turns, rotation_ends, Chain::Rotations)?;
        let ends_of = |values: &[Vector3<f64>], i: usize| [values[i], values[(i + 1) % values.len()]];
        let positions = (0..segments)
            .map(|i| {
                let from = poses[i].translation.vector;
                Cubic::hermite(lengths[i], [from, next(i).translation.vector], ends_of(&velocities, i))
            })
            .collect();
        let rotations: Vec<_> = (0..segments)
            .map(|i| RotationSegment::new(&poses[i].rotation, turns[i], lengths[i], ends_of(&rates, i)))
            .collect();
        let spline = Self { knots: knots.to_vec(), positions, rotations, closed };
        spline.refuse_detours(poses.len(), &steps, &turns)?;
        Ok(spline)
    }

    /// Refuses segments that go much farther than the poses between which they lead.
    fn refuse_detours(&self, poses: usize, steps: &[Vector3<f64>], turns: &[Vector3<f64>]) -> Result<(), SplineError> {
        for i in 0..steps.len() {
            let [travelled_m, turned_rad] = self.lengths(i);
            let largest_near = |parts: &[Vector3<f64>]| {
                let near = i.saturating_sub(1)..(i + 2).min(parts.len());
                parts[near].iter().map(|part| part.norm()).fold(0.0, f64::max)
            };
            let (distance_m, difference_rad) = (steps[i].norm(), turns[i].norm());
            let (from, to) = (i, (i + 1) % poses);
            let allowed_rad = (DETOUR * largest_near(turns)).min(WINDING_BOUND_RAD);
            // Rounding of what was subtracted to get the parts.
            let slack = 1e-9;
            // Written so that NaN is refused.
            let turns_enough = turned_rad <= difference_rad + allowed_rad + slack;
            if !turns_enough {
                return Err(SplineError::Winding { from, to, turned_rad, difference_rad });
            }
            let goes_straight = travelled_m <= distance_m + DETOUR * largest_near(steps) + slack;
            if !goes_straight {
                return Err(SplineError::Overshoot { from, to, travelled_m, distance_m });
            }
        }
        Ok(())
    }

    /// Length of a segment's position and angle of its rotation, by the midpoint rule. Sixteen points measure to a few per
    /// cent what the bounds must tell: whether the curve goes somewhere else.
    fn lengths(&self, segment: usize) -> [f64; 2] {
        const POINTS: usize = 16;
        let step = (self.knots[segment + 1] - self.knots[segment]) / POINTS as f64;
        let twist = |k: usize| self.in_segment(segment, (k as f64 + 0.5) * step).twist;
        let add = |[p, r]: [f64; 2], twist: Twist| [p + twist.linear.norm() * step, r + twist.angular.norm() * step];
        (0..POINTS).map(twist).fold([0.0; 2], add)
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

    /// Pose and derivatives at parameter `t`. Beyond its domain an open curve stays at its end, a closed one goes round again.
    pub fn at(&self, t: f64) -> Motion {
        let (segment, local) = self.locate(t);
        self.in_segment(segment, local)
    }

    /// The pose alone at parameter `t`, as [`Self::at`].
    pub fn pose(&self, t: f64) -> Pose {
        let (segment, local) = self.locate(t);
        let position = self.positions[segment].at(local)[0];
        Pose::from_parts(position.into(), self.rotations[segment].rotation(local))
    }

    fn locate(&self, t: f64) -> (usize, f64) {
        let (first, last) = self.domain();
        let t = if self.closed { first + (t - first).rem_euclid(last - first) } else { t.clamp(first, last) };
        let segment = self.knots.partition_point(|&k| k <= t).clamp(1, self.knots.len() - 1) - 1;
        (segment, t - self.knots[segment])
    }

    fn in_segment(&self, segment: usize, local: f64) -> Motion {
        let [p, v, a, j] = self.positions[segment].at(local);
        let turn = self.rotations[segment].at(local);
        let body = turn.rotation.inverse();
        Motion {
            pose: Pose::from_parts(p.into(), turn.rotation),
            twist: Twist::new(body * v, turn.rate),
            acceleration: Twist::new(body * a, turn.acceleration),
            jerk: Twist::new(body * j, turn.jerk),
        }
    }
}

fn check(poses: &[Pose], knots: &[f64], closed: bool) -> Result<(), SplineError> {
    let needed = if closed { 3 } else { 2 };
    if poses.len() < needed {
        return Err(SplineError::TooFewPoses { needed, given: poses.len() });
    }
    let expected = poses.len() + usize::from(closed);
    if knots.len() != expected {
        return Err(SplineError::KnotCount { expected, given: knots.len() });
    }
    let metric = crate::Se3::default();
    if let Some(index) = poses.iter().position(|p| !metric.is_finite(p)) {
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

#[cfg(test)]
#[path = "pose_spline_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "pose_spline_edge_tests.rs"]
mod edge_tests;
