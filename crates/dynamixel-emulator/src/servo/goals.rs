//! What happens when an item is written: torque, modes, and the way to a new goal.

use super::profile::{Profile, Shape};
use super::{Ramp, Servo};
use crate::item::{self, Item};
use crate::memory::{Allowed, POSITION_MODE};
use crate::units::{ACCELERATION_RAD_S2, PULSE_RAD, VELOCITY_RAD_S};

/// Bits of Drive Mode.
pub(super) const SLAVE: i32 = 2;
const TIME_BASED: i32 = 4;
const TORQUE_BY_GOAL: i32 = 8;

/// Units of the table in pulses.
pub(super) const VELOCITY_PULSES_S: f64 = VELOCITY_RAD_S / PULSE_RAD;
const ACCELERATION_PULSES_S2: f64 = ACCELERATION_RAD_S2 / PULSE_RAD;

/// Whether an item is a gain or part of the profile: what a new operating mode has its initial values of.
pub(super) fn is_tuning(item: Item) -> bool {
    let gains = item::VELOCITY_I_GAIN.address..=item::FEEDFORWARD_1ST_GAIN.address;
    gains.contains(&item.address) || [item::PROFILE_ACCELERATION, item::PROFILE_VELOCITY].contains(&item)
}

impl Servo {
    /// Executes a write that the rules allow.
    pub(super) fn apply(&mut self, allowed: &Allowed) {
        let (torque, mode) = (self.has_torque(), self.item(item::OPERATING_MODE));
        let goal = [item::GOAL_POSITION, item::GOAL_VELOCITY, item::GOAL_CURRENT, item::GOAL_PWM];
        let writes_goal = goal.into_iter().any(|item| allowed.writes(item));
        self.memory.write(allowed);
        if writes_goal && self.item(item::DRIVE_MODE) & TORQUE_BY_GOAL != 0 {
            self.memory.set(item::TORQUE_ENABLE, 1);
        }
        if self.is_shut_down {
            self.memory.set(item::TORQUE_ENABLE, 0);
        }
        if self.item(item::OPERATING_MODE) != mode || (self.has_torque() && !torque) {
            if self.item(item::OPERATING_MODE) == POSITION_MODE {
                self.forget_turns();
            }
            self.set_goals_aside();
            if self.item(item::OPERATING_MODE) != mode {
                self.memory.reset(is_tuning);
                self.set_bounds(|_| true);
            }
            // Goals of the same packet are newer than what has just replaced them.
            let on = self.item(item::TORQUE_ENABLE);
            self.memory.write(allowed);
            self.memory.set(item::TORQUE_ENABLE, on);
        }
        if allowed.writes(item::DRIVE_MODE) {
            self.forget_turns();
        }
        // Assumed; the e-manual says so of a new mode only.
        self.set_bounds(|limit| allowed.writes(limit));
        if allowed.writes(item::GOAL_POSITION) && self.has_torque() {
            let goal = f64::from(self.item(item::GOAL_POSITION));
            self.profile = Profile::new(self.profile.desired(), goal, self.shape());
        }
        if allowed.writes(item::GOAL_VELOCITY) {
            let distance = (f64::from(self.item(item::GOAL_VELOCITY)) * VELOCITY_PULSES_S - self.ramp.velocity).abs();
            self.ramp.acceleration = match f64::from(self.item(item::PROFILE_ACCELERATION)) {
                0.0 => f64::INFINITY,
                time_ms if self.is_time_based() => distance / (time_ms * 1e-3),
                acceleration => acceleration * ACCELERATION_PULSES_S2,
            };
        }
        if allowed.writes(item::BUS_WATCHDOG) {
            self.silence_s = 0.0;
        }
    }

    /// Goals that leave the shaft where it is: torque that comes on never moves a servo.
    pub(super) fn set_goals_aside(&mut self) {
        self.seat_position();
        (self.ramp, self.integral) = (Ramp::default(), 0.0);
        let mode = self.item(item::OPERATING_MODE);
        for (of_mode, goal) in [(0, item::GOAL_CURRENT), (1, item::GOAL_VELOCITY), (16, item::GOAL_PWM)] {
            if mode == of_mode {
                self.memory.set(goal, 0);
            }
        }
    }

    /// The position as it is for the goal, and nowhere to go.
    pub(super) fn seat_position(&mut self) {
        let present = self.present_pulses();
        self.memory.set(item::GOAL_POSITION, present);
        self.profile = Profile::at_rest(f64::from(present));
    }

    /// Goals that only bound what the controller does become their limits, where those are wanted.
    pub(super) fn set_bounds(&mut self, wanted: impl Fn(Item) -> bool) {
        for (of_mode, goal, limit) in
            [(0, item::GOAL_CURRENT, item::CURRENT_LIMIT), (16, item::GOAL_PWM, item::PWM_LIMIT)]
        {
            if self.item(item::OPERATING_MODE) != of_mode && wanted(limit) {
                self.memory.set(goal, self.item(limit));
            }
        }
    }

    pub(super) fn is_time_based(&self) -> bool {
        self.item(item::DRIVE_MODE) & TIME_BASED != 0
    }

    pub(super) fn shape(&self) -> Shape {
        let velocity = f64::from(self.item(item::PROFILE_VELOCITY));
        let acceleration = f64::from(self.item(item::PROFILE_ACCELERATION));
        match (velocity, acceleration) {
            (0.0, _) => Shape::Step,
            (total_ms, ms) if self.is_time_based() => {
                Shape::Time { total_s: total_ms * 1e-3, accelerating_s: ms * 1e-3 }
            }
            (velocity, 0.0) => Shape::Velocity { velocity: velocity * VELOCITY_PULSES_S, acceleration: f64::INFINITY },
            _ => Shape::Velocity {
                velocity: velocity * VELOCITY_PULSES_S,
                acceleration: acceleration * ACCELERATION_PULSES_S2,
            },
        }
    }
}
