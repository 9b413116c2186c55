//! The position sensor: pulses, turns and directions.

use super::Servo;
use crate::item;
use crate::memory::POSITION_MODE;
use crate::units::{CENTRE, PULSE_RAD, PULSES_PER_TURN, rounded};

/// Drive Mode's bit of a reversed direction.
const REVERSE: i32 = 1;

impl Servo {
    /// Present Position in pulses: reversed, without forgotten turns, with the homing offset.
    pub(super) fn present_pulses(&self) -> i32 {
        let homing = self.item(item::HOMING_OFFSET);
        let is_ignored = self.item(item::OPERATING_MODE) == POSITION_MODE && homing.abs() > PULSES_PER_TURN / 4;
        self.pulses().wrapping_sub(self.forgotten_turns).wrapping_add(if is_ignored { 0 } else { homing })
    }

    /// The encoder's pulses with all turns, in the direction of Drive Mode.
    pub(super) fn pulses(&self) -> i32 {
        rounded(self.direction() * (self.shaft.position_rad / PULSE_RAD + f64::from(CENTRE)))
    }

    pub(super) fn forget_turns(&mut self) {
        let pulses = self.pulses();
        self.forgotten_turns = pulses.wrapping_sub(pulses.rem_euclid(PULSES_PER_TURN));
    }

    pub(super) fn direction(&self) -> f64 {
        if self.item(item::DRIVE_MODE) & REVERSE == 0 { 1.0 } else { -1.0 }
    }
}
