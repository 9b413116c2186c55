//! Everything that can go wrong between a configuration file and an arm that moves, in one sentence each.

use std::fmt;

use mujoco_sim::SimError;

/// A servo as sentences name it: `servo 3 (shoulder_shadow)`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServoName {
    /// Its ID on the bus.
    pub id: u8,
    /// Its name in the configuration; empty for one that it does not have.
    pub name: String,
}

impl fmt::Display for ServoName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "servo {}", self.id)?;
        if self.name.is_empty() { Ok(()) } else { write!(f, " ({})", self.name) }
    }
}

/// What a servo has latched in its Hardware Error Status, as bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct HardwareErrors(pub u8);

/// Bit and meaning (ROBOTIS e-manual, XM540-W270, section 2.4.27).
const HARDWARE_ERRORS: [(u8, &str); 5] = [
    (0x01, "its input voltage is out of range"),
    (0x04, "it is overheated"),
    (0x08, "its encoder has failed"),
    (0x10, "its electronics have had a shock, or too little power"),
    (0x20, "it is overloaded"),
];

impl fmt::Display for HardwareErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = HARDWARE_ERRORS.iter().filter(|(bit, _)| self.0 & bit != 0).map(|(_, meaning)| *meaning);
        let known: Vec<_> = known.collect();
        if known.is_empty() {
            write!(f, "it has hardware error {:#04x}", self.0)
        } else {
            f.write_str(&known.join(", and "))
        }
    }
}

/// Why a servo refuses an instruction (ROBOTIS, Protocol 2.0, Status Packet, Error).
pub(crate) fn refusal(code: u8) -> &'static str {
    match code & 0x7F {
        1 => "it failed to process it",
        2 => "it does not know the instruction",
        3 => "it came damaged",
        4 => "the value is out of range",
        5 => "the value has the wrong length",
        6 => "the value is beyond its limit",
        7 => "it is not accessible now",
        _ => "for a reason that it does not name",
    }
}

/// Why nothing moves, or no longer.
#[derive(Debug, thiserror::Error)]
pub enum HilError {
    /// A configuration file cannot be used.
    #[error("{file}: {reason}")]
    Config {
        /// The file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// Python or ROBOTIS's SDK is not there.
    #[error(
        "the Dynamixel SDK for Python cannot be loaded ({reason}): `cargo xtask setup` fetches it, DYNAMIXEL_SDK names another folder"
    )]
    NoSdk {
        /// What Python says.
        reason: String,
    },
    /// A port cannot be opened.
    #[error("port {port} cannot be opened at {baud} baud: {reason}")]
    Port {
        /// Its name.
        port: String,
        /// The rate.
        baud: u32,
        /// What the system says.
        reason: String,
    },
    /// A port is gone.
    #[error("port {port} is gone, is the cable still plugged in? ({reason})")]
    PortLost {
        /// Its name.
        port: String,
        /// What the system says.
        reason: String,
    },
    /// No answer.
    #[error("{servo} does not answer")]
    Silent {
        /// Which.
        servo: ServoName,
    },
    /// Not one servo answers.
    #[error(
        "no servo answers on port {port}: is the arm powered, is {baud} baud its rate, and is the adapter as quick as latency_ms says?"
    )]
    AllSilent {
        /// The port.
        port: String,
        /// The rate.
        baud: u32,
    },
    /// Answers are no packets.
    #[error("what {servo} answers arrives damaged time and again: another servo has the same ID, or the cable is bad")]
    Garbled {
        /// Which.
        servo: ServoName,
    },
    /// A group's answers are missing or damaged.
    #[error("the servos did not all answer")]
    GroupMissed,
    /// Another servo than the configuration says.
    #[error("{servo} is a {found}, but the configuration says {expected}")]
    WrongModel {
        /// Which.
        servo: ServoName,
        /// By the configuration.
        expected: String,
        /// By the servo.
        found: String,
    },
    /// A servo refuses an instruction.
    #[error("{servo} refuses {what}: {why}")]
    Refused {
        /// Which.
        servo: ServoName,
        /// The instruction.
        what: String,
        /// By the error code.
        why: &'static str,
    },
    /// A servo has latched an error, after most of which its torque is off.
    #[error("{servo} reports that {errors}")]
    Hardware {
        /// Which.
        servo: ServoName,
        /// Why.
        errors: HardwareErrors,
    },
    /// A servo does not hold.
    #[error("{servo} has no torque: it has started anew, or somebody has switched it off")]
    Limp {
        /// Which.
        servo: ServoName,
    },
    /// A servo that holds would have to let go.
    #[error(
        "{servo} holds the arm, and {why}: support the arm, switch its torque off (`dynamixel-hil release`), and start again"
    )]
    WouldDrop {
        /// Which.
        servo: ServoName,
        /// What it would have to let go for.
        why: String,
    },
    /// The servos of one joint do not agree where it is.
    #[error(
        "{servo} and {other} move the same joint and are {by_rad:.3} rad apart: calibrate them, or give them their offset_rad"
    )]
    Apart {
        /// The one.
        servo: ServoName,
        /// The other.
        other: ServoName,
        /// How far.
        by_rad: f64,
    },
    /// A servo stands where it takes no goal.
    #[error(
        "{servo} stands at {position}, outside of its own limits of {least} to {most}, and could not be held there"
    )]
    Outside {
        /// Which.
        servo: ServoName,
        /// In pulses.
        position: i32,
        /// Min Position Limit.
        least: i32,
        /// Max Position Limit.
        most: i32,
    },
    /// A joint does not get where it is to be.
    #[error("joint {joint} is {by_rad:.3} rad from where it is to be: something is in its way, or {servo} is too weak")]
    Following {
        /// The joint.
        joint: String,
        /// How far.
        by_rad: f64,
        /// The first servo that moves it.
        servo: ServoName,
    },
    /// Nothing was sent for too long.
    #[error("this computer paused for {pause_s:.2} s in the midst of a motion")]
    Paused {
        /// How long.
        pause_s: f64,
    },
    /// The simulated arm.
    #[error(transparent)]
    Simulation(#[from] SimError),
    /// The emulated bus.
    #[error("the emulated bus: {0}")]
    Emulator(String),
}

pub(crate) type Result<T> = std::result::Result<T, HilError>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_name_servo_and_cause() {
        let servo = ServoName { id: 4, name: "elbow".into() };
        let error = HilError::Hardware { servo, errors: HardwareErrors(0x21) };
        let words = "servo 4 (elbow) reports that its input voltage is out of range, and it is overloaded";
        assert_eq!(error.to_string(), words);
        assert_eq!(HardwareErrors(0x40).to_string(), "it has hardware error 0x40");
    }
}
