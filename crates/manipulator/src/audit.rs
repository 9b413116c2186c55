//! Whether a trajectory may be executed.

use serde::Serialize;

use crate::bounds::Bounds;
use crate::robot::Robot;
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
    /// Of joint torques; none where the robot's inertias or all its effort limits are unknown.
    pub torque: Option<f64>,
    /// Of the tool's speed, where it has a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_speed: Option<f64>,
    /// Of the tool's acceleration, where it has a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_acceleration: Option<f64>,
}

/// What an audit of a trajectory found.
///
/// Peaks of joint velocity, acceleration and jerk are those of the quintics between the points, found exactly (extremes of
/// polynomials), so that they are at least those on any grid. Torques and the tool's motion are sampled ten times between points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Audit {
    /// Whether every check below holds: ratios at most 1 (of what the rules ask for), margin not negative, times increase, the start as
    /// it must be, rest at the end.
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

/// Which limits decide whether a trajectory is legal; position, velocity and acceleration always do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AuditRules {
    /// Whether jerk limits count.
    pub jerk: bool,
    /// Whether effort limits count.
    pub torque: bool,
    /// Greatest speed of the tool frame's origin in m/s.
    pub tool_speed_m_s: Option<f64>,
    /// Greatest acceleration of the tool frame's origin in m/s².
    pub tool_acceleration_m_s2: Option<f64>,
}

impl AuditRules {
    /// Whether every limit of the tool is positive and finite.
    fn are_valid(&self) -> bool {
        let of_tool = [self.tool_speed_m_s, self.tool_acceleration_m_s2];
        of_tool.into_iter().flatten().all(|limit| limit > 0.0 && limit.is_finite())
    }
}

impl Default for AuditRules {
    /// Every limit of the joints, none of the tool.
    fn default() -> Self {
        Self { jerk: true, torque: true, tool_speed_m_s: None, tool_acceleration_m_s2: None }
    }
}

/// Judges the trajectory that a controller would execute against all limits of the robot's joints. Numbers that are not finite fail
/// every check.
pub fn audit(robot: &Robot, trajectory: &JointTrajectory) -> Audit {
    audit_under(robot, trajectory, AuditRules::default(), None)
}

/// [`audit`] of a trajectory that takes over from a moving robot: in place of rest it must begin in exactly the state `from`, whose
/// time does not count.
pub fn audit_from(robot: &Robot, trajectory: &JointTrajectory, from: &JointPoint) -> Audit {
    audit_under(robot, trajectory, AuditRules::default(), Some(from))
}

/// Judges the trajectory that a controller would execute against the robot's limits, as far as the rules say; it must begin at rest, or
/// in the state `from` as for [`audit_from`].
pub fn audit_under(robot: &Robot, trajectory: &JointTrajectory, rules: AuditRules, from: Option<&JointPoint>) -> Audit {
    if trajectory.joint_names == robot.chain.joint_names() && robot.check_limits().is_ok() && rules.are_valid() {
        return against_from(&Bounds::new(robot, robot.limits.clone(), rules), trajectory, from).audit;
    }
    // Judged joint by joint in order: under other names that would be somebody else's limits, and limits that are none allow everything.
    Audit { duration_s: trajectory.duration_s(), points: trajectory.points.len(), ..Audit::failed() }
}

impl Audit {
    /// Of a trajectory that cannot be judged.
    fn failed() -> Self {
        let max_ratio = MaxRatio {
            velocity: f64::INFINITY,
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
            torque: None,
            tool_speed: None,
            tool_acceleration: None,
        };
        Self {
            limits_ok: false,
            max_ratio,
            position_margin: f64::NEG_INFINITY,
            times_increase: false,
            starts_and_ends_at_rest: false,
            duration_s: 0.0,
            points: 0,
        }
    }
}

/// An audit, and by how much the trajectory must be stretched in time for its peaks to come down to the limits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) audit: Audit,
    /// Infinite where no stretching helps.
    pub(crate) slowdown: f64,
}

pub(crate) fn against(bounds: &Bounds<'_>, trajectory: &JointTrajectory) -> Found {
    against_from(bounds, trajectory, None)
}

pub(crate) fn against_from(bounds: &Bounds<'_>, trajectory: &JointTrajectory, from: Option<&JointPoint>) -> Found {
    let points = &trajectory.points;
    let limits = &bounds.limits;
    let dof = limits.lower.len();
    let times_increase = trajectory.is_well_formed(dof);
    let mut audit =
        Audit { times_increase, duration_s: trajectory.duration_s(), points: points.len(), ..Audit::failed() };
    if !times_increase {
        return Found { audit, slowdown: f64::INFINITY };
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
        for (joint, quintic) in trajectory.quintics(interval).enumerate() {
            bounds.raise(joint, &quintic, &mut ratios, &mut margin);
        }
    }
    let sampled = bounds.sampled(trajectory);
    audit.max_ratio = MaxRatio {
        velocity: ratios[0],
        acceleration: ratios[1],
        jerk: ratios[2],
        torque: sampled.torque,
        tool_speed: sampled.tool_speed,
        tool_acceleration: sampled.tool_acceleration,
    };
    audit.position_margin = margin;
    let rules = &bounds.rules;
    let counting = [
        Some(ratios[0]),
        Some(ratios[1]),
        Some(ratios[2]).filter(|_| rules.jerk),
        sampled.torque.filter(|_| rules.torque),
        sampled.tool_speed,
        sampled.tool_acceleration,
    ];
    let within = counting.into_iter().flatten().all(|ratio| ratio <= 1.0);
    // Inverse kinematics may end on a limit up to rounding.
    audit.limits_ok = within && margin >= -1e-9 && audit.starts_and_ends_at_rest;
    let slowdown = ratios[0].max(ratios[1].sqrt()).max(if rules.jerk { ratios[2].cbrt() } else { 0.0 });
    Found { audit, slowdown: slowdown.max(sampled.slowdown) }
}
