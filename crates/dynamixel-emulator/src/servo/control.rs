//! The controllers, at a period of [`PERIOD_S`].
//!
//! Gains are scaled as the e-manual says (P/128, I/65536, D/16, feed-forward/4). Their units are not documented; assumed are pulses
//! and pulses per period for positions and 0.229 rev/min for velocities in, and units of Goal PWM (or of Goal Current) out.

use super::goals::{SLAVE, VELOCITY_PULSES_S};
use super::profile::Kind;
use super::{Servo, Surroundings};
use crate::item;
use crate::plant::Shaft;
use crate::units::{CURRENT_A, FULL_PWM, PULSE_RAD, VELOCITY_RAD_S, rounded};

/// Period of the controllers.
pub(crate) const PERIOD_S: f64 = 1e-3;
/// In-Position is within so many pulses of the goal, Following Error beyond so many of the trajectory. Assumed.
const IN_POSITION: i32 = 20;
const FOLLOWING: i32 = 200;

impl Servo {
    /// One period: what the motor does to the shaft, in N m counter-clockwise.
    pub(crate) fn control(&mut self, shaft: Shaft, surroundings: Surroundings) -> f64 {
        self.shaft = shaft;
        self.sense(surroundings);
        if self.booting_s > 0.0 {
            self.booting_s -= PERIOD_S;
            self.motor.drive(None, shaft.velocity_rad_s, PERIOD_S);
            if self.booting_s <= 0.0 {
                self.start();
            }
            return 0.0;
        }
        self.clock_s += PERIOD_S;
        self.watch_bus(PERIOD_S);
        let supply_v = if surroundings.supply_v.is_finite() { surroundings.supply_v.max(0.0) } else { 0.0 };
        let voltage = self.has_torque().then(|| self.direction() * self.voltage(supply_v));
        if voltage.is_none() {
            self.pwm = 0.0;
            self.rest();
        }
        self.motor.drive(voltage, shaft.velocity_rad_s, PERIOD_S);
        self.protect(PERIOD_S);
        self.motor.torque_n_m()
    }

    /// Power taken away: nothing is driven, nothing is kept but the EEPROM.
    pub(crate) fn stay_dark(&mut self, shaft: Shaft) {
        self.shaft = shaft;
        self.motor.drive(None, shaft.velocity_rad_s, PERIOD_S);
        self.reboot();
    }

    /// Without torque the trajectory is where the shaft is.
    fn rest(&mut self) {
        self.profile = super::Profile::at_rest(f64::from(self.present_pulses()));
        (self.ramp.velocity, self.integral) = (0.0, 0.0);
    }

    /// The voltage that the controller of the operating mode applies, in the servo's own direction.
    fn voltage(&mut self, supply_v: f64) -> f64 {
        let bound = f64::from(self.item(item::PWM_LIMIT).min(self.item(item::GOAL_PWM).abs()));
        let bounded_v = |voltage: f64| voltage.clamp(-supply_v * bound / FULL_PWM, supply_v * bound / FULL_PWM);
        let velocity = self.direction() * self.shaft.velocity_rad_s;
        let mode = if self.item(item::DRIVE_MODE) & SLAVE != 0 { None } else { Some(self.item(item::OPERATING_MODE)) };
        let voltage = match mode {
            Some(0) => bounded_v(self.motor.voltage_for(self.bounded_current(), velocity)),
            Some(1) => self.velocity_pwm(velocity, bound) / FULL_PWM * supply_v,
            Some(3 | 4) => self.position_output(velocity, bound) / FULL_PWM * supply_v,
            Some(5) => {
                let bound = f64::from(self.item(item::GOAL_CURRENT).abs().min(self.item(item::CURRENT_LIMIT)));
                let current = self.position_output(velocity, bound) * CURRENT_A;
                bounded_v(self.motor.voltage_for(current, velocity))
            }
            Some(16) => f64::from(self.item(item::GOAL_PWM)).clamp(-bound, bound) / FULL_PWM * supply_v,
            // A slave of dual mode is driven through a cable that this bus does not have.
            _ => 0.0,
        };
        self.pwm = if supply_v > 0.0 { voltage / supply_v * FULL_PWM } else { 0.0 };
        voltage
    }

    fn bounded_current(&self) -> f64 {
        let limit = self.item(item::CURRENT_LIMIT);
        f64::from(self.item(item::GOAL_CURRENT).clamp(-limit, limit)) * CURRENT_A
    }

    /// PI control of the velocity, in units of PWM.
    fn velocity_pwm(&mut self, velocity_rad_s: f64, bound: f64) -> f64 {
        let goal = f64::from(self.item(item::GOAL_VELOCITY)) * VELOCITY_PULSES_S;
        let step = self.ramp.acceleration * PERIOD_S;
        self.ramp.velocity = goal.clamp(self.ramp.velocity - step, self.ramp.velocity + step);
        let error = (self.ramp.velocity * PULSE_RAD - velocity_rad_s) / VELOCITY_RAD_S;
        let proportional = f64::from(self.item(item::VELOCITY_P_GAIN)) / 128.0 * error;
        let integral_gain = f64::from(self.item(item::VELOCITY_I_GAIN)) / 65536.0;
        self.integrate(proportional, integral_gain, error, bound)
    }

    /// PID control of the position with feed-forward of the trajectory, in units of what `bound` bounds.
    fn position_output(&mut self, velocity_rad_s: f64, bound: f64) -> f64 {
        self.profile.advance(PERIOD_S);
        let desired = self.profile.desired();
        let gain = |item, divisor: f64| f64::from(self.item(item)) / divisor;
        let error = desired.position - f64::from(self.present_pulses());
        let rate = (desired.velocity - velocity_rad_s / PULSE_RAD) * PERIOD_S;
        let output = gain(item::POSITION_P_GAIN, 128.0) * error
            + gain(item::POSITION_D_GAIN, 16.0) * rate
            + gain(item::FEEDFORWARD_1ST_GAIN, 4.0) * desired.velocity * PERIOD_S
            + gain(item::FEEDFORWARD_2ND_GAIN, 4.0) * desired.acceleration * PERIOD_S * PERIOD_S;
        let integral_gain = gain(item::POSITION_I_GAIN, 65536.0);
        self.integrate(output, integral_gain, error, bound)
    }

    /// Adds the integral of the error, which does not grow while the output is at its bound.
    fn integrate(&mut self, output: f64, gain: f64, error: f64, bound: f64) -> f64 {
        let wanted = output + self.integral + gain * error;
        if wanted.abs() < bound || wanted * error < 0.0 {
            self.integral += gain * error;
        }
        wanted.clamp(-bound, bound)
    }

    /// Writes what a master reads of the motion.
    pub(super) fn publish(&mut self) {
        let present = self.present_pulses();
        let velocity = rounded(self.direction() * self.shaft.velocity_rad_s / VELOCITY_RAD_S);
        let (desired, direction) = (self.profile.desired(), self.direction());
        let is_velocity_mode = self.item(item::OPERATING_MODE) == 1;
        let trajectory = if is_velocity_mode { self.ramp.velocity } else { desired.velocity };
        self.memory.set(item::REALTIME_TICK, rounded(self.clock_s / 1e-3) % 32768);
        self.memory.set(item::PRESENT_PWM, rounded(self.pwm));
        let load = match self.model {
            crate::Model::Xl430W250 => rounded(self.pwm / FULL_PWM * 1000.0),
            _ => rounded(direction * self.motor.current_a / CURRENT_A),
        };
        self.memory.set(item::PRESENT_CURRENT, load);
        self.memory.set(item::PRESENT_VELOCITY, velocity);
        self.memory.set(item::PRESENT_POSITION, present);
        self.memory.set(item::VELOCITY_TRAJECTORY, rounded(trajectory / VELOCITY_PULSES_S));
        self.memory.set(item::POSITION_TRAJECTORY, rounded(desired.position));
        let is_profiled = self.has_torque() && self.profile.is_ongoing();
        let is_moving = velocity.abs() > self.item(item::MOVING_THRESHOLD) || is_profiled;
        self.memory.set(item::MOVING, i32::from(is_moving));
        self.memory.set(item::MOVING_STATUS, self.moving_status(present, is_profiled));
    }

    fn moving_status(&self, present: i32, is_profiled: bool) -> i32 {
        if !matches!(self.item(item::OPERATING_MODE), 3..=5) || !self.has_torque() {
            return 0;
        }
        let off = |from: f64| (f64::from(present) - from).abs();
        let kind = if is_profiled { self.profile.kind } else { Kind::Step };
        let arrived = off(self.profile.goal()) <= f64::from(IN_POSITION);
        let following_error = off(self.profile.desired().position) > f64::from(FOLLOWING);
        (kind as i32) << 4 | i32::from(following_error) << 3 | i32::from(is_profiled) << 1 | i32::from(arrived)
    }
}
