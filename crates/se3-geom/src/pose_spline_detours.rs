//! Whether a pose spline leads from pose to pose, or somewhere else on the way.

use nalgebra::Vector3;

use super::{Motion, PoseSpline, Segment, WINDING_BOUND_RAD};
use crate::pose::Pose;
use crate::spline_error::SplineError;
use crate::twist::Twist;

/// By how many times the largest step near a segment (its own or a neighbour's) its length may exceed its own step. A smooth
/// curve exceeds it by per cents, one round a sharp corner by a fraction of the step, one that winds or overshoots by several.
const DETOUR: f64 = 2.0;

/// Angles closer than this are one angle: orientations seldom come with more than nine digits.
const SAME_ANGLE_RAD: f64 = 1e-9;

/// Positions closer than this part of the greatest coordinate C are one position. What comes out of a kinematic chain carries
/// some ten roundings ε·C, and where all steps are rounding, knots a hundred times uneven make the cubic swing a hundredfold.
const SAME_POSITION: f64 = 1e3 * f64::EPSILON;

impl PoseSpline {
    /// Refuses segments that go much farther than the poses between which they lead.
    pub(super) fn refuse_detours(
        &self,
        poses: &[Pose],
        steps: &[Vector3<f64>],
        turns: &[Vector3<f64>],
    ) -> Result<(), SplineError> {
        let segments = steps.len();
        let greatest_coordinate = poses.iter().map(|p| p.translation.vector.amax()).fold(0.0, f64::max);
        for i in 0..segments {
            let near = if self.closed {
                [(i + segments - 1) % segments, i, (i + 1) % segments]
            } else {
                [i.saturating_sub(1), i, (i + 1).min(segments - 1)]
            };
            let largest_near = |parts: &[Vector3<f64>]| near.map(|k| parts[k].norm()).into_iter().fold(0.0, f64::max);
            let (distance_m, difference_rad) = (steps[i].norm(), turns[i].norm());
            let (from, to) = (i, (i + 1) % poses.len());
            let allowed_rad = (DETOUR * largest_near(turns)).min(WINDING_BOUND_RAD);
            let most_rad = difference_rad + allowed_rad + SAME_ANGLE_RAD;
            let most_m = distance_m + DETOUR * largest_near(steps) + SAME_POSITION * greatest_coordinate;
            let (Segment { position, rotation }, h) = (&self.segments[i], self.length(i));
            if rotation.turned_at_most(h) <= most_rad && position.length_bound(h) <= most_m {
                continue;
            }
            let [travelled_m, turned_rad] = self.travelled(i);
            // Written so that NaN is refused.
            let turns_little = turned_rad <= most_rad;
            if !turns_little {
                return Err(SplineError::Winding { from, to, turned_rad, difference_rad, residual: self.residual() });
            }
            let goes_straight = travelled_m <= most_m;
            if !goes_straight {
                return Err(SplineError::Overshoot { from, to, travelled_m, distance_m, residual: self.residual() });
            }
        }
        Ok(())
    }

    /// Length of a segment's position and angle of its rotation, by the midpoint rule. Sixteen points measure to a few per cent
    /// what the bounds must tell: whether the curve goes somewhere else.
    fn travelled(&self, segment: usize) -> [f64; 2] {
        const POINTS: usize = 16;
        let step = self.length(segment) / POINTS as f64;
        let twist = |k: usize| self.in_segment(segment, (k as f64 + 0.5) * step).twist;
        let add = |[p, r]: [f64; 2], twist: Twist| [p + twist.linear.norm() * step, r + twist.angular.norm() * step];
        (0..POINTS).map(twist).fold([0.0; 2], add)
    }

    /// What the C² conditions leave: the greatest jump at a knot of twist or acceleration, relative to the greatest of its kind at
    /// any knot (a metre counts as a radian). NaN where a number is none.
    pub(super) fn residual(&self) -> f64 {
        let count = self.segments.len();
        let joints = if self.closed { count } else { count - 1 };
        let greater = |a: f64, b: f64| if b <= a { a } else { b };
        let (mut jumps, mut sizes) = ([0.0; 2], [f64::MIN_POSITIVE; 2]);
        for i in 0..joints {
            let [left, right] = [self.in_segment(i, self.length(i)), self.in_segment((i + 1) % count, 0.0)];
            let parts = |motion: &Motion| [motion.twist.to_vector(), motion.acceleration.to_vector()];
            for (k, (left, right)) in parts(&left).into_iter().zip(parts(&right)).enumerate() {
                jumps[k] = greater(jumps[k], (left - right).norm());
                sizes[k] = greater(sizes[k], right.norm());
            }
        }
        greater(jumps[0] / sizes[0], jumps[1] / sizes[1])
    }

    /// The length of a segment in the curve's parameter.
    fn length(&self, segment: usize) -> f64 {
        self.knots[segment + 1] - self.knots[segment]
    }
}
