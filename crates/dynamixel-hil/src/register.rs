//! The entries of the X-series control table that an arm uses (ROBOTIS e-manual, XM540-W270, section 2.2; the same for XM430 and XL430).

use std::f64::consts::TAU;

/// An entry of the control table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Register {
    /// Where it begins.
    pub address: u16,
    /// Its length in bytes: 1, 2 or 4.
    pub size: u16,
    /// As the manual calls it.
    pub name: &'static str,
}

impl Register {
    const fn new(address: u16, size: u16, name: &'static str) -> Self {
        Self { address, size, name }
    }

    /// Its bytes, least first.
    pub(crate) fn bytes(self, value: u32) -> Vec<u8> {
        value.to_le_bytes()[..usize::from(self.size)].to_vec()
    }
}

/// The value of some bytes, least first; negative ones of four bytes are in two's complement.
pub(crate) fn value(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| (value << 8) | u32::from(byte))
}

/// Kept without power, written only while the torque is off.
pub const RETURN_DELAY_TIME: Register = Register::new(9, 1, "Return Delay Time");
/// Bit 0: clockwise is positive.
pub const DRIVE_MODE: Register = Register::new(10, 1, "Drive Mode");
/// See [`Mode`].
pub const OPERATING_MODE: Register = Register::new(11, 1, "Operating Mode");
/// A servo also obeys what is written to this ID; 255 is none.
pub const SECONDARY_ID: Register = Register::new(12, 1, "Secondary(Shadow) ID");
/// In pulses.
pub const HOMING_OFFSET: Register = Register::new(20, 4, "Homing Offset");
/// In pulses: a servo takes no goal above.
pub const MAX_POSITION_LIMIT: Register = Register::new(48, 4, "Max Position Limit");
/// In pulses: a servo takes no goal below.
pub const MIN_POSITION_LIMIT: Register = Register::new(52, 4, "Min Position Limit");
/// 0 or 1.
pub const TORQUE_ENABLE: Register = Register::new(64, 1, "Torque Enable");
/// See [`HardwareErrors`](crate::HardwareErrors).
pub const HARDWARE_ERROR_STATUS: Register = Register::new(70, 1, "Hardware Error Status");
/// Of 1/16.
pub const POSITION_D_GAIN: Register = Register::new(80, 2, "Position D Gain");
/// Of 1/65536.
pub const POSITION_I_GAIN: Register = Register::new(82, 2, "Position I Gain");
/// Of 1/128.
pub const POSITION_P_GAIN: Register = Register::new(84, 2, "Position P Gain");
/// Of 214.577 rev/min²; 0 is no ramp.
pub const PROFILE_ACCELERATION: Register = Register::new(108, 4, "Profile Acceleration");
/// Of 0.229 rev/min; 0 is no bound.
pub const PROFILE_VELOCITY: Register = Register::new(112, 4, "Profile Velocity");
/// In pulses.
pub const GOAL_POSITION: Register = Register::new(116, 4, "Goal Position");
/// In mA or so, signed.
pub const PRESENT_CURRENT: Register = Register::new(126, 2, "Present Current");
/// Of 0.229 rev/min, signed.
pub const PRESENT_VELOCITY: Register = Register::new(128, 4, "Present Velocity");
/// In pulses, signed.
pub const PRESENT_POSITION: Register = Register::new(132, 4, "Present Position");
/// Of 0.1 V.
pub const PRESENT_INPUT_VOLTAGE: Register = Register::new(144, 2, "Present Input Voltage");
/// In °C.
pub const PRESENT_TEMPERATURE: Register = Register::new(146, 1, "Present Temperature");

/// What a servo controls, in its Operating Mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Speed.
    Velocity = 1,
    /// Angles of one turn.
    Position = 3,
    /// Angles of any number of turns.
    ExtendedPosition = 4,
    /// Angles, under a bound on the current.
    CurrentBasedPosition = 5,
}

/// Addresses that the indirect data stand for, one every two bytes.
pub(crate) const FIRST_INDIRECT_ADDRESS: u16 = 168;
/// Where the bytes of those addresses can be read in one piece.
pub(crate) const FIRST_INDIRECT_DATA: u16 = 224;

/// Pulses a turn; raw position 2048 is the middle.
const PULSES_PER_TURN: f64 = 4096.0;
const TURN: i32 = 4096;
const CENTRE: f64 = 2048.0;

/// The angle of a raw position, in rad from the middle.
pub(crate) fn angle_rad(pulses: i32) -> f64 {
    (f64::from(pulses) - CENTRE) * TAU / PULSES_PER_TURN
}

/// The raw position nearest to an angle in rad from the middle.
pub(crate) fn pulses(angle_rad: f64) -> i32 {
    (angle_rad / TAU * PULSES_PER_TURN + CENTRE).round() as i32
}

/// A position without torque, as position control counts it once the torque is on: from the beginning of the turn that it is in.
pub(crate) fn within_a_turn(pulses: i32) -> i32 {
    pulses.rem_euclid(TURN)
}

/// A position under torque: a joint may swing beyond the ends of the turn, but what is farther away was counted before the torque came.
pub(crate) fn near_a_turn(pulses: i32) -> i32 {
    const SWING: i32 = TURN / 16;
    if (-SWING..TURN + SWING).contains(&pulses) { pulses } else { within_a_turn(pulses) }
}

/// 0.229 rev/min in rad/s.
pub(crate) const VELOCITY_UNIT_RAD_S: f64 = 0.229 / 60.0 * TAU;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_units() {
        assert_eq!(GOAL_POSITION.bytes(-2_i32 as u32), [0xFE, 0xFF, 0xFF, 0xFF]);
        assert_eq!(value(&[0x78, 0x56, 0x34, 0x12]), 0x1234_5678);
        assert_eq!(value(&PRESENT_INPUT_VOLTAGE.bytes(119)), 119);
        assert_eq!(
            (pulses(0.0), pulses(std::f64::consts::PI), pulses(-std::f64::consts::FRAC_PI_2)),
            (2048, 4096, 1024)
        );
        assert_eq!([-5, 4100, -2374].map(near_a_turn), [-5, 4100, 1722]);
        assert!((angle_rad(3072) - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!((131.0 * VELOCITY_UNIT_RAD_S - std::f64::consts::PI).abs() < 1e-3);
    }
}
