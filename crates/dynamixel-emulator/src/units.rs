//! Units of the control tables in SI. Each is what the e-manual gives for the X series.

use std::f64::consts::TAU;

/// Pulses of the encoder a turn.
pub const PULSES_PER_TURN: i32 = 4096;
/// The raw position of the encoder's centre.
pub const CENTRE: i32 = 2048;
/// A pulse in rad.
pub const PULSE_RAD: f64 = TAU / PULSES_PER_TURN as f64;
/// A unit of velocity, 0.229 rev/min, in rad/s.
pub const VELOCITY_RAD_S: f64 = 0.229 * TAU / 60.0;
/// A unit of acceleration, 214.577 rev/min², in rad/s².
pub const ACCELERATION_RAD_S2: f64 = 214.577 * TAU / 3600.0;
/// A unit of current in A.
pub const CURRENT_A: f64 = 2.69e-3;
/// The PWM value of a full duty cycle.
pub const FULL_PWM: f64 = 885.0;
/// A unit of voltage in V.
pub const VOLTAGE_V: f64 = 0.1;
/// A unit of Return Delay Time in s.
pub const RETURN_DELAY_S: f64 = 2e-6;
/// A unit of Bus Watchdog in s.
pub const WATCHDOG_S: f64 = 20e-3;
/// Baud rates by the value of Baud Rate.
pub const BAUD_RATES: [u32; 8] = [9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000];

/// Rounds to a table's integer; what does not fit is the nearest that does.
pub(crate) fn rounded(value: f64) -> i32 {
    value.round() as i32
}
