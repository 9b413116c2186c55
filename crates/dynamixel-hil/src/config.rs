//! The configuration file of an arm (`config/arms/*.yaml`).

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use planner::manipulator::Robot;
use serde::Deserialize;

use crate::error::{HilError, Result, ServoName};
use crate::model::Model;

/// The port that stands for the emulated bus.
pub const SIMULATED_PORT: &str = "sim";

/// An arm of servos: nothing else differs between a real and an emulated one than [`Config::port`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Name of a shipped robot.
    pub robot: String,
    /// A serial port, or `sim`.
    pub port: String,
    /// Its rate, in bit/s.
    pub baud: u32,
    /// How long the port's adapter may keep bytes to itself, in ms.
    pub latency_ms: f64,
    /// Control steps a second.
    pub rate_hz: f64,
    /// The greatest speed of every joint, in rad/s.
    pub velocity_rad_s: f64,
    /// When something counts as a fault.
    pub watch: Watch,
    /// The servos' Position P Gain, of 1/128.
    pub position_p_gain: u16,
    /// The servos, base to tool.
    pub servos: Vec<Servo>,
}

/// When something counts as a fault.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Watch {
    /// A joint so far from where it is to be, in rad,
    pub following_rad: f64,
    /// for so long, in s.
    pub following_s: f64,
    /// No answer for so long, in s.
    pub silence_s: f64,
    /// Nothing sent for so long, in s.
    pub pause_s: f64,
    /// How far a joint may stand from where a trajectory begins, in rad.
    pub start_rad: f64,
}

/// A servo, and the joint that it moves.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Servo {
    /// ID on the bus, 0 … 252.
    pub id: u8,
    /// How sentences call it.
    pub name: String,
    /// What it is.
    pub model: Model,
    /// The joint that it moves; without one it is held where it stands.
    #[serde(default)]
    pub joint: Option<String>,
    /// Whether clockwise is positive, bit 0 of its Drive Mode.
    #[serde(default)]
    pub reversed: bool,
    /// Where the joint is when the servo is at raw position 2048, in rad.
    #[serde(default)]
    pub offset_rad: f64,
}

impl Servo {
    /// As sentences name it.
    pub fn label(&self) -> ServoName {
        ServoName { id: self.id, name: self.name.clone() }
    }
}

impl Config {
    /// Reads a file.
    ///
    /// # Errors
    /// Where it cannot be read, has unknown or missing keys, or values that make no sense.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let file = path.as_ref().display().to_string();
        let refused = |reason: String| HilError::Config { file: file.clone(), reason };
        let text = fs::read_to_string(path.as_ref()).map_err(|error| refused(error.to_string()))?;
        Self::from_yaml(&text).map_err(refused)
    }

    /// Reads text; what is wrong comes back as a sentence.
    ///
    /// # Errors
    /// As [`Config::read`].
    pub fn from_yaml(text: &str) -> std::result::Result<Self, String> {
        let parsed: Self = serde_yaml::from_str(text)
            .map_err(|error| error.to_string().split_whitespace().collect::<Vec<_>>().join(" "))?;
        parsed.check()?;
        Ok(parsed)
    }

    /// The robot, with the speeds of this file.
    ///
    /// # Errors
    /// Where no such robot is shipped.
    pub fn robot(&self) -> Result<Robot> {
        let mut robot = self.shipped().map_err(|reason| HilError::Config { file: "robot".into(), reason })?;
        robot.limits.velocity.apply(|limit| *limit = limit.min(self.velocity_rad_s));
        Ok(robot)
    }

    /// All IDs, in the order of [`Config::servos`].
    pub fn ids(&self) -> Vec<u8> {
        self.servos.iter().map(|servo| servo.id).collect()
    }

    fn shipped(&self) -> std::result::Result<Robot, String> {
        Robot::shipped(&self.robot).map_err(|error| error.to_string())
    }

    fn check(&self) -> std::result::Result<(), String> {
        let Watch { following_rad, following_s, silence_s, pause_s, start_rad } = self.watch;
        for (key, value, [least, most]) in [
            ("latency_ms", self.latency_ms, [0.5, 100.0]),
            ("rate_hz", self.rate_hz, [10.0, 1000.0]),
            ("velocity_rad_s", self.velocity_rad_s, [0.05, 10.0]),
            ("position_p_gain", self.position_p_gain.into(), [1.0, 16383.0]),
            ("watch: following_rad", following_rad, [0.01, 3.0]),
            ("watch: following_s", following_s, [0.0, 2.0]),
            ("watch: silence_s", silence_s, [0.01, 2.0]),
            ("watch: pause_s", pause_s, [0.02, 2.0]),
            ("watch: start_rad", start_rad, [0.005, 0.5]),
        ] {
            if !(value >= least && value <= most) {
                return Err(format!("{key} must be from {least} to {most}, not {value}"));
            }
        }
        let mut ids = BTreeSet::new();
        for servo in &self.servos {
            if servo.id > 252 {
                return Err(format!("a servo's id is from 0 to 252, not {}", servo.id));
            }
            if !ids.insert(servo.id) {
                return Err(format!("two servos have the id {}", servo.id));
            }
            // Also no number of degrees by mistake.
            if !(-PI..=PI).contains(&servo.offset_rad) {
                return Err(format!("{}: offset_rad must be from -pi to pi, not {}", servo.label(), servo.offset_rad));
            }
        }
        let robot = self.shipped()?;
        let moved: BTreeSet<_> = self.servos.iter().filter_map(|servo| servo.joint.as_deref()).collect();
        let joints: BTreeSet<_> = robot.chain.joint_names().iter().map(String::as_str).collect();
        if let Some(unknown) = moved.difference(&joints).next() {
            return Err(format!("{} has no joint {unknown}", self.robot));
        }
        match joints.difference(&moved).next() {
            Some(idle) => Err(format!("no servo moves joint {idle}")),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIPPED: &str = include_str!("../../../config/arms/vx300s.yaml");

    #[test]
    fn the_shipped_arm_has_nine_servos_on_six_joints() {
        let config = Config::from_yaml(SHIPPED).unwrap();
        assert_eq!(config.ids(), (1..=9).collect::<Vec<_>>());
        assert_eq!(config.port, SIMULATED_PORT);
        assert_eq!(config.robot().unwrap().limits.velocity[0], 2.0);
        assert_eq!(config.servos[2].label().to_string(), "servo 3 (shoulder_shadow)");
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        for (from, to, words) in [
            ("baud:", "bauds:", "bauds"),
            ("rate_hz: 220", "rate_hz: fast", "rate_hz"),
            ("rate_hz: 220", "rate_hz: 2", "rate_hz must be from 10 to 1000, not 2"),
            ("pause_s: 0.1", "pause_s: .nan", "pause_s must be"),
            ("id: 3", "id: 2", "two servos have the id 2"),
            ("id: 9", "id: 254", "from 0 to 252"),
            ("XM430-W350, joint", "XM430, joint", "XM430"),
            ("joint: wrist_rotate", "joint: wrist", "vx300s has no joint wrist"),
            (", joint: waist", "", "no servo moves joint waist"),
            ("reversed: true", "offset_rad: 90", "servo 2 (shoulder): offset_rad must be from -pi to pi, not 90"),
            ("robot: vx300s", "robot: hal", "hal"),
            ("reversed: true", "reverse: true", "reverse"),
        ] {
            assert!(SHIPPED.contains(from), "{from}");
            let why = Config::from_yaml(&SHIPPED.replacen(from, to, 1)).unwrap_err();
            assert!(why.contains(words) && !why.contains('\n'), "{words}: {why}");
        }
    }
}
