//! Every gain by itself, on a shaft that is held: Present PWM is what the formula of the e-manual gives.
#![allow(clippy::unwrap_used, missing_docs)]

mod bench;

use bench::Bench;
use dynamixel_emulator::units::{ACCELERATION_RAD_S2, PULSE_RAD, VELOCITY_RAD_S};
use dynamixel_emulator::{Bus, Item, Model, Plant, ServoSettings, Shaft, item};

/// A shaft in a vice, at its centre.
struct Held;

impl Plant for Held {
    fn step(&mut self, _torques: &[f64], _dt_s: f64) {}

    fn shaft(&self, _servo: usize) -> Shaft {
        Shaft::default()
    }
}

/// A servo with no gains but these, its torque on.
fn held(mode: i32, items: &[(Item, i32)]) -> Bench {
    let mut settings = ServoSettings::new(1, Model::Xm540W270).with(item::OPERATING_MODE, mode);
    for gain in [item::POSITION_P_GAIN, item::VELOCITY_P_GAIN, item::VELOCITY_I_GAIN] {
        settings = settings.with(gain, 0);
    }
    settings = items.iter().fold(settings, |settings, (item, value)| settings.with(*item, *value));
    let mut bench = Bench(Bus::new(vec![settings], Box::new(Held)).unwrap());
    bench.write(1, item::TORQUE_ENABLE, 1);
    bench
}

fn pwm(bench: &Bench) -> i32 {
    bench.item(1, item::PRESENT_PWM)
}

/// Pulses a millisecond of Profile Velocity 50, and pulses a millisecond squared of Profile Acceleration 100.
fn profile() -> (f64, f64) {
    (50.0 * VELOCITY_RAD_S / PULSE_RAD * 1e-3, 100.0 * ACCELERATION_RAD_S2 / PULSE_RAD * 1e-6)
}

#[test]
fn proportional_gain_is_a_128th() {
    for (gain, expected) in [(128, 100), (800, 625), (1600, 885)] {
        let mut bench = held(3, &[(item::POSITION_P_GAIN, gain)]);
        bench.write(1, item::GOAL_POSITION, 2148);
        bench.0.advance(0.01);
        assert_eq!(pwm(&bench), expected, "a gain of {gain}");
    }
}

#[test]
fn goal_pwm_and_pwm_limit_bound_the_output() {
    for (limit, goal_pwm, expected) in [(885, 300, 300), (200, 200, 200), (885, -300, 300)] {
        let mut bench = held(3, &[(item::POSITION_P_GAIN, 800), (item::PWM_LIMIT, limit)]);
        bench.write(1, item::GOAL_PWM, goal_pwm);
        bench.write(1, item::GOAL_POSITION, 2148);
        bench.0.advance(0.01);
        assert_eq!(pwm(&bench), expected, "limit {limit}, goal {goal_pwm}");
    }
    let mut bench = held(16, &[(item::PWM_LIMIT, 200)]);
    assert_eq!(bench.try_write(1, item::GOAL_PWM, 201), 6);
    bench.write(1, item::GOAL_PWM, -200);
    bench.0.advance(0.01);
    assert_eq!(pwm(&bench), -200);
}

#[test]
fn integral_gain_is_a_65536th_a_millisecond() {
    let mut bench = held(3, &[(item::POSITION_I_GAIN, 6554)]);
    bench.write(1, item::GOAL_POSITION, 2148);
    bench.0.advance(0.01);
    let before = pwm(&bench);
    bench.0.advance(0.02);
    assert!((pwm(&bench) - before - 200).abs() <= 1, "100 pulses · 0.1 · 20 periods, and {}", pwm(&bench) - before);
    // Wound up it would take as long to come back.
    bench.0.advance(0.5);
    assert_eq!(pwm(&bench), 885);
    bench.write(1, item::GOAL_POSITION, 1948);
    bench.0.advance(0.1);
    assert!(pwm(&bench) < 0, "{}", pwm(&bench));
}

#[test]
fn derivative_gain_is_a_16th_and_feed_forwards_are_quarters() {
    let (velocity, acceleration) = profile();
    for (gain, value, divisor, rate, shape) in [
        (item::POSITION_D_GAIN, 1600, 16.0, velocity, (50, 0)),
        (item::FEEDFORWARD_1ST_GAIN, 400, 4.0, velocity, (50, 0)),
        (item::FEEDFORWARD_2ND_GAIN, 16000, 4.0, acceleration, (1000, 100)),
    ] {
        let mut bench = held(3, &[(gain, value)]);
        bench.write(1, item::PROFILE_VELOCITY, shape.0);
        bench.write(1, item::PROFILE_ACCELERATION, shape.1);
        bench.write(1, item::GOAL_POSITION, 4000);
        bench.0.advance(0.05);
        let expected = (f64::from(value) / divisor * rate).round() as i32;
        assert!(expected > 50 && pwm(&bench) == expected, "{} instead of {expected} with {gain:?}", pwm(&bench));
    }
}

#[test]
fn velocity_gains_are_a_128th_and_a_65536th_a_millisecond() {
    let mut bench = held(1, &[(item::VELOCITY_P_GAIN, 256)]);
    bench.write(1, item::GOAL_VELOCITY, -50);
    bench.0.advance(0.01);
    assert_eq!(pwm(&bench), -100);
    let mut bench = held(1, &[(item::VELOCITY_I_GAIN, 6554)]);
    bench.write(1, item::GOAL_VELOCITY, 50);
    bench.0.advance(0.01);
    let before = pwm(&bench);
    bench.0.advance(0.02);
    assert!((pwm(&bench) - before - 100).abs() <= 1, "50 units · 0.1 · 20 periods, and {}", pwm(&bench) - before);
}

#[test]
fn current_based_position_mode_has_the_gains_in_units_of_current() {
    let mut bench = held(5, &[(item::POSITION_P_GAIN, 128)]);
    bench.write(1, item::GOAL_POSITION, 2248);
    bench.0.advance(0.01);
    assert_eq!(bench.item(1, item::PRESENT_CURRENT), 200);
    bench.write(1, item::GOAL_CURRENT, 150);
    bench.0.advance(0.01);
    assert_eq!(bench.item(1, item::PRESENT_CURRENT), 150);
}
