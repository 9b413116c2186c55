//! Whether a trajectory may be executed.

use serde::Serialize;

use crate::robot::{Limits, Robot};
use crate::trajectory::{JointPoint, JointTrajectory};

/// Peak over limit, the greatest of all joints; at most 1 where the limit holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MaxRatio {
    /// Of joint velocities.
    pub velocity: f64,
    /// Of joint accelerations.
    pub acceleration: f64,
    /// Of joint jerks.
    pub jerk: f64,
}

/// What an audit of a trajectory found.
///
/// Peaks are those of the quintics between the points, found exactly (extremes of polynomials), so that they are at least those on
/// any grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Audit {
    /// Whether every check below holds: ratios at most 1, margin not negative, times increase, the start as it must be, rest at the end.
    pub limits_ok: bool,
    /// Peak over limit.
    pub max_ratio: MaxRatio,
    /// Least distance of any joint to a position limit, in rad (m for prismatic joints); negative beyond it.
    pub position_margin: f64,
    /// Whether times are finite, start at 0 and strictly increase.
    pub times_increase: bool,
    /// Whether velocity and acceleration are exactly zero at both ends. For [`audit_from`]: whether the first point has exactly the
    /// position, velocity and acceleration of the given state, and the last is at rest.
    pub starts_and_ends_at_rest: bool,
    /// Duration in s.
    pub duration_s: f64,
    /// Number of points.
    pub points: usize,
}

/// Peak over limit of one joint between two points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peaks {
    /// Velocity, acceleration, jerk.
    pub(crate) ratios: [f64; 3],
    pub(crate) margin: f64,
}

/// Judges the trajectory that a controller would execute against the robot's limits. Numbers that are not finite fail every check.
pub fn audit(robot: &Robot, trajectory: &JointTrajectory) -> Audit {
    judge(robot, trajectory, None)
}

/// [`audit`] of a trajectory that takes over from a moving robot: in place of rest it must begin in exactly the state `from`, whose
/// time does not count.
pub fn audit_from(robot: &Robot, trajectory: &JointTrajectory, from: &JointPoint) -> Audit {
    judge(robot, trajectory, Some(from))
}

fn judge(robot: &Robot, trajectory: &JointTrajectory, from: Option<&JointPoint>) -> Audit {
    if trajectory.joint_names == robot.chain.joint_names() {
        return against_from(&robot.limits, trajectory, from);
    }
    // Judged joint by joint in order: under other names that would be somebody else's limits.
    Audit { duration_s: trajectory.duration_s(), points: trajectory.points.len(), ..Audit::failed() }
}

impl Audit {
    /// Of a trajectory that cannot be judged.
    fn failed() -> Self {
        Self {
            limits_ok: false,
            max_ratio: MaxRatio { velocity: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY },
            position_margin: f64::NEG_INFINITY,
            times_increase: false,
            starts_and_ends_at_rest: false,
            duration_s: 0.0,
            points: 0,
        }
    }
}

pub(crate) fn against(limits: &Limits, trajectory: &JointTrajectory) -> Audit {
    against_from(limits, trajectory, None)
}

pub(crate) fn against_from(limits: &Limits, trajectory: &JointTrajectory, from: Option<&JointPoint>) -> Audit {
    let points = &trajectory.points;
    let dof = limits.lower.len();
    let times_increase = trajectory.is_well_formed(dof);
    let mut audit =
        Audit { times_increase, duration_s: trajectory.duration_s(), points: points.len(), ..Audit::failed() };
    if !times_increase {
        return audit;
    }
    let at_rest = |p: &JointPoint| p.velocities.iter().chain(&p.accelerations).all(|&x| x == 0.0);
    let first = &points[0];
    let begins =
        from.map_or_else(|| at_rest(first), |from| JointPoint { time_s: first.time_s, ..from.clone() } == *first);
    audit.starts_and_ends_at_rest = begins && at_rest(&points[points.len() - 1]);
    let mut ratios = [0.0_f64; 3];
    let mut margin = f64::INFINITY;
    for (j, &q) in points[0].positions.iter().enumerate() {
        margin = margin.min(q - limits.lower[j]).min(limits.upper[j] - q);
    }
    for interval in 0..points.len() - 1 {
        for peaks in peaks(limits, trajectory, interval) {
            margin = margin.min(peaks.margin);
            ratios.iter_mut().zip(peaks.ratios).for_each(|(worst, ratio)| *worst = worst.max(ratio));
        }
    }
    audit.max_ratio = MaxRatio { velocity: ratios[0], acceleration: ratios[1], jerk: ratios[2] };
    audit.position_margin = margin;
    // Inverse kinematics may end on a limit up to rounding.
    audit.limits_ok = ratios.iter().all(|&ratio| ratio <= 1.0) && margin >= -1e-9 && audit.starts_and_ends_at_rest;
    audit
}

/// The peaks of every joint between point `interval` and the next.
pub(crate) fn peaks<'a>(
    limits: &'a Limits,
    trajectory: &'a JointTrajectory,
    interval: usize,
) -> impl Iterator<Item = Peaks> + 'a {
    trajectory.quintics(interval).enumerate().map(|(j, quintic)| {
        let ranges = quintic.ranges();
        // Finite points can be so large that the polynomial between them overflows; nothing can be said of it then.
        if !ranges.iter().all(|(low, high)| low.is_finite() && high.is_finite()) {
            return Peaks { ratios: [f64::INFINITY; 3], margin: f64::NEG_INFINITY };
        }
        let [position, velocity, acceleration, jerk] = ranges;
        let peak = |(low, high): (f64, f64)| high.max(-low);
        Peaks {
            ratios: [
                peak(velocity) / limits.velocity[j],
                peak(acceleration) / limits.acceleration[j],
                peak(jerk) / limits.jerk[j],
            ],
            margin: (position.0 - limits.lower[j]).min(limits.upper[j] - position.1),
        }
    })
}
