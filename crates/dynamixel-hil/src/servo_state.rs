//! What every servo tells in each step, gathered by its indirect addresses so that one read brings it.

use crate::error::HardwareErrors;
use crate::register::{
    FIRST_INDIRECT_ADDRESS, HARDWARE_ERROR_STATUS, PRESENT_CURRENT, PRESENT_INPUT_VOLTAGE, PRESENT_POSITION,
    PRESENT_TEMPERATURE, PRESENT_VELOCITY, Register, TORQUE_ENABLE, near_a_turn, value, within_a_turn,
};

/// The registers, in the order of their bytes.
const GATHERED: [Register; 7] = [
    TORQUE_ENABLE,
    HARDWARE_ERROR_STATUS,
    PRESENT_CURRENT,
    PRESENT_VELOCITY,
    PRESENT_POSITION,
    PRESENT_INPUT_VOLTAGE,
    PRESENT_TEMPERATURE,
];

/// A servo at one time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ServoState {
    /// Whether it holds its position.
    pub torque: bool,
    /// What it has latched.
    pub errors: HardwareErrors,
    /// Of 2.69 mA; for an XL430 the load, of 0.1 %.
    pub current: i16,
    /// Of 0.229 rev/min.
    pub velocity: i32,
    /// In pulses; without torque as it will be counted with it.
    pub position: i32,
    /// Of 0.1 V.
    pub voltage: u16,
    /// In °C.
    pub temperature: u8,
}

impl ServoState {
    /// How many bytes it takes.
    pub(crate) fn length() -> u16 {
        GATHERED.iter().map(|register| register.size).sum()
    }

    /// Where to write which addresses, so that the bytes stand one after the other.
    pub(crate) fn indirect_addresses() -> (u16, Vec<u8>) {
        let of = |register: &Register| (register.address..register.address + register.size).flat_map(u16::to_le_bytes);
        (FIRST_INDIRECT_ADDRESS, GATHERED.iter().flat_map(of).collect())
    }

    /// Takes in what a servo tells; `None` where the bytes are too few.
    ///
    /// A servo that has started anew has forgotten its indirect addresses, and tells nothing but zeros: then it stands where it stood,
    /// without torque.
    pub(crate) fn update(&mut self, bytes: &[u8]) -> Option<()> {
        let told = Self::parse(bytes)?;
        // No servo speaks without a voltage.
        *self = if told.voltage == 0 { Self { torque: false, velocity: 0, current: 0, ..*self } } else { told };
        Some(())
    }

    fn parse(bytes: &[u8]) -> Option<Self> {
        let mut rest = bytes;
        let mut next = |register: &Register| {
            let (head, tail) = rest.split_at_checked(usize::from(register.size))?;
            rest = tail;
            Some(value(head))
        };
        let mut values = [0; GATHERED.len()];
        for (value, register) in values.iter_mut().zip(&GATHERED) {
            *value = next(register)?;
        }
        let [torque, errors, current, velocity, position, voltage, temperature] = values;
        let torque = torque != 0;
        let position = if torque { near_a_turn(position as i32) } else { within_a_turn(position as i32) };
        Some(Self {
            torque,
            errors: HardwareErrors(errors as u8),
            current: current as u16 as i16,
            velocity: velocity as i32,
            position,
            voltage: voltage as u16,
            temperature: temperature as u8,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_taken_apart_in_the_order_in_which_they_are_gathered() {
        let (first, addresses) = ServoState::indirect_addresses();
        assert_eq!((first, addresses.len()), (168, 2 * usize::from(ServoState::length())));
        // Torque Enable, Hardware Error Status, Present Current (two bytes).
        assert_eq!(addresses[..8], [64, 0, 70, 0, 126, 0, 127, 0]);
        let bytes = [1, 0x20, 0xFF, 0xFF, 0xFE, 0xFF, 0xFF, 0xFF, 0x00, 0x08, 0x00, 0x00, 119, 0, 41];
        let state = ServoState::parse(&bytes).unwrap();
        let expected = ServoState {
            torque: true,
            errors: HardwareErrors(0x20),
            current: -1,
            velocity: -2,
            position: 2048,
            voltage: 119,
            temperature: 41,
        };
        assert_eq!(state, expected);
        assert_eq!(ServoState::parse(&bytes[..14]), None);
        // A servo without torque that has been turned back by more than a turn.
        let mut limp = bytes;
        limp[0] = 0;
        limp[8..12].copy_from_slice(&(-5000_i32).to_le_bytes());
        assert_eq!(ServoState::parse(&limp).unwrap().position, 2 * 4096 - 5000);
    }

    #[test]
    fn a_servo_that_has_forgotten_where_to_look_stands_where_it_stood() {
        let bytes = [1, 0, 0, 0, 5, 0, 0, 0, 0x00, 0x07, 0x00, 0x00, 119, 0, 41];
        let mut state = ServoState::default();
        state.update(&bytes).unwrap();
        assert!(state.torque && state.position == 0x700 && state.velocity == 5);
        state.update(&[0; 15]).unwrap();
        assert!(!state.torque && state.position == 0x700 && state.velocity == 0);
        assert_eq!(state.update(&[0; 14]), None);
    }
}
