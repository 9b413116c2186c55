//! What makes a servo switch itself off: the bits of Hardware Error Status and Shutdown.

use super::Servo;
use crate::item;
use crate::units::{VOLTAGE_V, WATCHDOG_S, rounded};

/// A bit of Hardware Error Status. It stays until the servo is rebooted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum HardwareError {
    /// The supply is above Max Voltage Limit or below Min Voltage Limit.
    InputVoltage = 0x01,
    /// The servo is warmer than Temperature Limit.
    Overheating = 0x04,
    /// The encoder is broken.
    Encoder = 0x08,
    /// A shock on the circuit, or too little power for the motor.
    ElectricalShock = 0x10,
    /// A load that the motor cannot bear for so long.
    Overload = 0x20,
}

/// What the world around a servo does to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Surroundings {
    pub(crate) supply_v: f64,
    /// In place of what the losses make of it.
    pub(crate) temperature_c: Option<f64>,
}

impl Servo {
    /// Latches an error, and switches the torque off where Shutdown says so.
    pub(crate) fn raise(&mut self, error: HardwareError) {
        let status = self.item(item::HARDWARE_ERROR_STATUS) | error as i32;
        self.memory.set(item::HARDWARE_ERROR_STATUS, status);
        if status & self.item(item::SHUTDOWN) != 0 {
            self.is_shut_down = true;
            self.memory.set(item::TORQUE_ENABLE, 0);
        }
    }

    /// Measures voltage and temperature.
    pub(super) fn sense(&mut self, surroundings: Surroundings) {
        if let Some(forced) = surroundings.temperature_c {
            self.motor.temperature_c = forced;
        }
        self.memory
            .set(item::PRESENT_INPUT_VOLTAGE, rounded(surroundings.supply_v / VOLTAGE_V).clamp(0, i32::from(i16::MAX)));
        self.memory.set(item::PRESENT_TEMPERATURE, rounded(self.motor.temperature_c).clamp(0, 255));
    }

    pub(super) fn protect(&mut self, dt_s: f64) {
        let voltage = self.item(item::PRESENT_INPUT_VOLTAGE);
        let temperature = self.item(item::PRESENT_TEMPERATURE);
        if !(self.item(item::MIN_VOLTAGE_LIMIT)..=self.item(item::MAX_VOLTAGE_LIMIT)).contains(&voltage) {
            self.raise(HardwareError::InputVoltage);
        }
        if temperature > self.item(item::TEMPERATURE_LIMIT) {
            self.raise(HardwareError::Overheating);
        }
        if self.overload.trips(self.motor.load(), dt_s) {
            self.raise(HardwareError::Overload);
        }
    }

    /// Counts silence on the bus while the torque is on, and stops when it lasts too long.
    pub(super) fn watch_bus(&mut self, dt_s: f64) {
        let limit = self.item(item::BUS_WATCHDOG);
        if limit == 0 || self.has_watchdog_error() || !self.has_torque() {
            return;
        }
        self.silence_s += dt_s;
        if self.silence_s > f64::from(limit) * WATCHDOG_S {
            self.set_goals_aside();
            self.memory.set(item::BUS_WATCHDOG, crate::memory::WATCHDOG_ERROR);
        }
    }
}
