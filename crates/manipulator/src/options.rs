//! How a path is put into time.

use serde::Deserialize;

use crate::audit::AuditRules;
use crate::bounds::Bounds;
use crate::error::{ManipulatorError, Result};
use crate::robot::Robot;

/// Which limits of the joints a trajectory keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointLimits {
    /// Velocity, acceleration and jerk.
    #[default]
    Jerk,
    /// Velocity and acceleration alone: shorter, planned ten times faster, harder on the arm. Accelerations then go from one limit to
    /// the other within a published step; they stay continuous.
    Acceleration,
}

/// How a path is put into time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TimingOptions {
    /// Published points per second, from 10 to 10,000.
    pub rate_hz: f64,
    /// Part of the velocity limits to use, from 0.001 to 1.
    pub velocity_scale: f64,
    /// Part of the acceleration limits to use, from 0.001 to 1.
    pub acceleration_scale: f64,
    /// Part of the jerk limits to use, from 0.001 to 1.
    pub jerk_scale: f64,
    /// Whether the jerk limits count.
    pub limits: JointLimits,
    /// Whether the effort limits count, where the robot's inertias are known.
    pub torque: bool,
    /// Greatest speed of the tool frame's origin in m/s.
    pub tool_speed_m_s: Option<f64>,
    /// Greatest acceleration of the tool frame's origin in m/s².
    pub tool_acceleration_m_s2: Option<f64>,
    /// The speed of the tool frame's origin in m/s between a ramp up at the start and a ramp down at the end, within 1 %: for welding
    /// or gluing. It is held for longer than ramps that meet would touch it. Where the limits do not allow it the path is refused.
    pub constant_tool_speed_m_s: Option<f64>,
}

impl Default for TimingOptions {
    fn default() -> Self {
        Self {
            rate_hz: 100.0,
            velocity_scale: 1.0,
            acceleration_scale: 1.0,
            jerk_scale: 1.0,
            limits: JointLimits::Jerk,
            torque: true,
            tool_speed_m_s: None,
            tool_acceleration_m_s2: None,
            constant_tool_speed_m_s: None,
        }
    }
}

impl TimingOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// [`ManipulatorError::InvalidOption`].
    pub fn check(&self) -> Result<()> {
        let invalid = |name, value, must_be| Err(ManipulatorError::InvalidOption { name, value, must_be });
        // Between points h apart the jerk changes by at most 2J, averaged over two steps, so that the fourth derivative is at most J/h
        // and the quintic between them strays by about Jh³/384: at ten points a second 1.3e-4 rad for J = 50 rad/s³. Slower makes no
        // sense; what it comes to is [`TimedPath::strays_m`](crate::TimedPath::strays_m).
        if !(self.rate_hz >= 10.0 && self.rate_hz <= 10_000.0) {
            return invalid("rate_hz", self.rate_hz, "from 10 to 10000");
        }
        let scales = [
            ("velocity_scale", self.velocity_scale),
            ("acceleration_scale", self.acceleration_scale),
            ("jerk_scale", self.jerk_scale),
        ];
        for (name, value) in scales {
            if !(1e-3..=1.0).contains(&value) {
                return invalid(name, value, "from 0.001 to 1");
            }
        }
        let of_tool = [
            ("tool_speed_m_s", self.tool_speed_m_s),
            ("tool_acceleration_m_s2", self.tool_acceleration_m_s2),
            ("constant_tool_speed_m_s", self.constant_tool_speed_m_s),
        ];
        for (name, value) in of_tool {
            if let Some(value) = value.filter(|value| !(*value >= 1e-4 && *value <= 1e3)) {
                return invalid(name, value, "from 0.0001 to 1000");
            }
        }
        match (self.tool_speed_m_s, self.constant_tool_speed_m_s) {
            (Some(most), Some(constant)) if constant > most => {
                invalid("constant_tool_speed_m_s", constant, "at most tool_speed_m_s")
            }
            _ => Ok(()),
        }
    }

    /// What an audit of a trajectory planned under these options checks.
    pub fn audit_rules(&self) -> AuditRules {
        AuditRules {
            jerk: self.limits == JointLimits::Jerk,
            torque: self.torque,
            tool_speed_m_s: self.tool_speed_m_s,
            tool_acceleration_m_s2: self.tool_acceleration_m_s2,
        }
    }

    /// What the timing must keep.
    pub(crate) fn bounds<'a>(&self, robot: &'a Robot) -> Result<Bounds<'a>> {
        self.check()?;
        let mut limits = robot.limits.clone();
        limits.velocity *= self.velocity_scale;
        limits.acceleration *= self.acceleration_scale;
        limits.jerk *= self.jerk_scale;
        Ok(Bounds::new(robot, limits, self.audit_rules()))
    }
}
