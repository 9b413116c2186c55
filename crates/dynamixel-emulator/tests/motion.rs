//! What the shafts do in each operating mode, and what a master reads of it.
#![allow(clippy::unwrap_used, missing_docs)]

mod bench;

use bench::Bench;
use dynamixel_emulator::packet::instruction;
use dynamixel_emulator::units::{ACCELERATION_RAD_S2, CURRENT_A, PULSE_RAD, VELOCITY_RAD_S};
use dynamixel_emulator::{Item, Model, ServoSettings, item};
use std::f64::consts::FRAC_PI_2;

/// One servo with the ID 1 in an operating mode, its torque on.
fn bench(model: Model, mode: i32, items: &[(Item, i32)]) -> Bench {
    let settings = ServoSettings::new(1, model).with(item::OPERATING_MODE, mode);
    let mut bench =
        Bench::new(vec![items.iter().fold(settings, |settings, (item, value)| settings.with(*item, *value))]);
    bench.write(1, item::TORQUE_ENABLE, 1);
    bench
}

fn position(bench: &Bench) -> i32 {
    bench.item(1, item::PRESENT_POSITION)
}

fn angle(bench: &Bench) -> f64 {
    bench.0.plant().shaft(0).position_rad
}

/// The gear's friction, 1 % of the stall torque, holds against as much PWM: 9 units, or 1.4 pulses at the XM's gain of 800/128.
const AT_REST: i32 = 3;

#[test]
fn position_mode_reaches_its_goal_with_the_factory_s_gains() {
    for model in [Model::Xm540W270, Model::Xm430W350, Model::Xl430W250] {
        let mut bench = bench(model, 3, &[]);
        bench.write(1, item::GOAL_POSITION, 3072);
        bench.0.advance(0.05);
        assert_eq!((bench.item(1, item::MOVING), bench.item(1, item::MOVING_STATUS) & 1), (1, 0), "{}", model.name());
        bench.0.advance(1.5);
        assert!((position(&bench) - 3072).abs() <= AT_REST, "{}: {}", model.name(), position(&bench));
        assert!((angle(&bench) - FRAC_PI_2).abs() <= f64::from(AT_REST) * PULSE_RAD, "{}", angle(&bench));
        assert_eq!((bench.item(1, item::MOVING), bench.item(1, item::MOVING_STATUS)), (0, 1), "{}", model.name());
    }
}

#[test]
fn an_integral_gain_takes_the_last_pulses_away() {
    let mut bench = bench(Model::Xm540W270, 3, &[(item::POSITION_I_GAIN, 500)]);
    bench.write(1, item::GOAL_POSITION, 3000);
    bench.0.advance(4.0);
    assert!((position(&bench) - 3000).abs() <= 1, "{}", position(&bench));
}

/// Profile Velocity 50 is 11.45 rev/min or 781.7 pulses/s; Profile Acceleration 10 is 2145.77 rev/min² or 2441.4 pulses/s².
#[test]
fn a_velocity_profile_takes_its_time() {
    let mut bench = bench(Model::Xm540W270, 3, &[]);
    bench.write(1, item::PROFILE_VELOCITY, 50);
    bench.write(1, item::PROFILE_ACCELERATION, 10);
    let started = bench.0.now_s();
    bench.write(1, item::GOAL_POSITION, 3048);
    bench.0.advance(0.5);
    assert_eq!(bench.item(1, item::MOVING_STATUS) >> 4, 3, "a trapezoid");
    assert_eq!(bench.item(1, item::MOVING_STATUS) & 2, 2, "it is in progress");
    assert_eq!(bench.item(1, item::VELOCITY_TRAJECTORY), 50);
    // Behind the trajectory by what drives it: 11.45 rev/min are 38 % of 30, that is 338 units of PWM, over a gain of 6.25.
    let behind = bench.item(1, item::POSITION_TRAJECTORY) - position(&bench);
    assert!((behind - 54).abs() <= 4, "{behind}");
    while bench.item(1, item::MOVING_STATUS) & 2 == 2 {
        bench.0.advance(1e-3);
    }
    let (v, a) = (50.0 * VELOCITY_RAD_S / PULSE_RAD, 10.0 * ACCELERATION_RAD_S2 / PULSE_RAD);
    let expected = 1000.0 / v + v / a;
    // One byte's share of a period at either end, and the write's own 16 bytes on the wire.
    let took = bench.0.now_s() - started;
    assert!((took - expected).abs() < 6e-3, "{took} s instead of {expected} s");
    assert_eq!(bench.item(1, item::VELOCITY_TRAJECTORY), 0);
}

#[test]
fn a_time_profile_takes_its_time() {
    let mut bench = bench(Model::Xm430W350, 3, &[(item::DRIVE_MODE, 4)]);
    bench.write(1, item::PROFILE_VELOCITY, 1500);
    bench.write(1, item::PROFILE_ACCELERATION, 300);
    let started = bench.0.now_s();
    bench.write(1, item::GOAL_POSITION, 1000);
    bench.0.advance(0.5);
    while bench.item(1, item::MOVING_STATUS) & 2 == 2 {
        bench.0.advance(1e-3);
    }
    let took = bench.0.now_s() - started;
    assert!((took - 1.5).abs() < 6e-3, "{took} s");
}

/// With no delay between velocity and PWM, the first gain that makes up for the back-EMF follows without an error: 885 units of PWM at
/// 30 rev/min are 432 a pulse/ms, 1729 in the table.
#[test]
fn feed_forward_takes_the_following_error_away() {
    let behind = |gain| {
        let mut bench = bench(Model::Xm540W270, 3, &[(item::FEEDFORWARD_1ST_GAIN, gain)]);
        bench.write(1, item::PROFILE_VELOCITY, 50);
        bench.write(1, item::GOAL_POSITION, 3048);
        bench.0.advance(0.7);
        bench.item(1, item::POSITION_TRAJECTORY) - position(&bench)
    };
    assert!(behind(0) > 50 && behind(1729).abs() <= AT_REST, "{} and {}", behind(0), behind(1729));
}

#[test]
fn velocity_mode_holds_its_velocity_against_a_load() {
    for goal in [60, -60] {
        let mut bench = bench(Model::Xm540W270, 1, &[]);
        bench.write(1, item::GOAL_VELOCITY, goal);
        bench.0.advance(2.0);
        bench.0.faults_mut().servos[0].load_torque_n_m = 2.0;
        bench.0.advance(3.0);
        assert!((bench.item(1, item::PRESENT_VELOCITY) - goal).abs() <= 1, "{}", bench.item(1, item::PRESENT_VELOCITY));
        // Beyond one turn: about 13.7 rev/min for 5 s.
        assert!((position(&bench) - 2048).abs() > 4096, "{}", position(&bench));
    }
}

#[test]
fn a_velocity_ramp_gains_speed_as_it_is_told() {
    let mut bench = bench(Model::Xm540W270, 1, &[]);
    bench.write(1, item::PROFILE_ACCELERATION, 5);
    bench.write(1, item::GOAL_VELOCITY, 100);
    bench.0.advance(0.5);
    // 5 units are 1072.9 rev/min², that is 39 units of velocity in half a second; one more is the write's time on the wire.
    let trajectory = bench.item(1, item::VELOCITY_TRAJECTORY);
    assert!((trajectory - 39).abs() <= 1, "{trajectory}");
}

#[test]
fn full_pwm_turns_at_the_no_load_speed() {
    for (model, rev_min) in [(Model::Xm540W270, 30.0), (Model::Xm430W350, 46.0), (Model::Xl430W250, 61.0)] {
        let mut bench = bench(model, 16, &[]);
        bench.write(1, item::GOAL_PWM, -885);
        bench.0.advance(1.0);
        // The friction of the gear, 1 % of the stall torque, takes 1 % of it.
        let velocity = -f64::from(bench.item(1, item::PRESENT_VELOCITY)) * 0.229;
        assert!((velocity / rev_min - 0.99).abs() < 0.01, "{} at {velocity} rev/min", model.name());
        assert_eq!(bench.item(1, item::PRESENT_PWM), -885);
    }
}

#[test]
fn current_mode_makes_the_torque_of_the_datasheet() {
    let mut bench = bench(Model::Xm540W270, 0, &[]);
    // What holds the shaft: as much as the motor gives, 10.6 N m at 4.4 A.
    let current = 400;
    let torque = 10.6 / 4.4 * f64::from(current) * CURRENT_A;
    bench.0.faults_mut().servos[0].load_torque_n_m = -torque;
    bench.write(1, item::GOAL_CURRENT, current);
    bench.0.advance(0.2);
    assert_eq!(bench.item(1, item::PRESENT_CURRENT), current);
    assert!((bench.servo(1).torque_n_m() - torque).abs() < 1e-9, "{}", bench.servo(1).torque_n_m());
}

#[test]
fn current_based_position_mode_is_as_strong_as_it_is_told() {
    let mut bench = bench(Model::Xm430W350, 5, &[]);
    bench.write(1, item::GOAL_CURRENT, 100);
    bench.write(1, item::GOAL_POSITION, 6000);
    bench.0.advance(4.0);
    assert!((position(&bench) - 6000).abs() <= AT_REST, "{}", position(&bench));
    // 100 units make 0.48 N m; twice as much pushes the shaft away, whatever the position's error is. Not for long, since the free shaft
    // is soon faster than 12 V can brake.
    bench.0.faults_mut().servos[0].load_torque_n_m = -0.96;
    bench.0.advance(0.035);
    assert_eq!(bench.item(1, item::PRESENT_CURRENT), 100);
    assert!(position(&bench) < 5970, "{}", position(&bench));
}

#[test]
fn reverse_mode_turns_all_around() {
    let mut bench = bench(Model::Xm540W270, 3, &[(item::DRIVE_MODE, 1)]);
    assert_eq!(position(&bench), 2048);
    bench.write(1, item::GOAL_POSITION, 3072);
    bench.0.advance(0.2);
    assert!(bench.item(1, item::PRESENT_VELOCITY) > 0 && bench.item(1, item::PRESENT_PWM) > 0);
    bench.0.advance(1.5);
    assert!((position(&bench) - 3072).abs() <= AT_REST);
    assert!((angle(&bench) + FRAC_PI_2).abs() <= f64::from(AT_REST) * PULSE_RAD, "{}", angle(&bench));
}

#[test]
fn a_homing_offset_is_added() {
    let present = |mode, offset| position(&bench(Model::Xm540W270, mode, &[(item::HOMING_OFFSET, offset)]));
    assert_eq!(present(3, 100), 2148);
    assert_eq!(present(3, -1024), 1024);
    assert_eq!(present(3, 1025), 2048, "more than a quarter of a turn is ignored in position mode");
    assert_eq!(present(4, 5000), 7048);
}

#[test]
fn turns_count_in_extended_mode_until_they_are_cleared() {
    let clear = |bench: &mut Bench| bench.ask(1, instruction::CLEAR, &[0x01, 0x44, 0x58, 0x4C, 0x22]);
    let mut bench = bench(Model::Xm430W350, 4, &[]);
    bench.write(1, item::GOAL_POSITION, 2048 + 3 * 4096);
    bench.0.advance(0.5);
    assert_eq!(clear(&mut bench), [1], "while it moves");
    bench.0.advance(6.0);
    assert!((position(&bench) - 2048 - 3 * 4096).abs() <= AT_REST, "{}", position(&bench));
    let before = angle(&bench);
    assert_eq!(clear(&mut bench), [0]);
    bench.0.advance(0.5);
    assert!((position(&bench) - 2048).abs() <= AT_REST, "{}", position(&bench));
    assert!((angle(&bench) - before).abs() < 0.01, "nothing moved");
    assert_eq!(bench.ask(1, instruction::CLEAR, &[1, 2, 3, 4, 5]), [4]);
}

#[test]
fn torque_that_comes_on_moves_nothing() {
    let mut bench = Bench::with_ids(&[1]);
    bench.write(1, item::GOAL_POSITION, 100);
    bench.write(1, item::TORQUE_ENABLE, 1);
    bench.0.advance(0.5);
    assert_eq!(position(&bench), 2048);
    // But with Torque On by Goal Update a goal is enough.
    let settings = ServoSettings::new(1, Model::Xm540W270).with(item::DRIVE_MODE, 8);
    let mut bench = Bench::new(vec![settings]);
    bench.write(1, item::GOAL_POSITION, 1500);
    bench.0.advance(1.5);
    assert_eq!(bench.item(1, item::TORQUE_ENABLE), 1);
    assert!((position(&bench) - 1500).abs() <= AT_REST);
}

#[test]
fn clearing_turns_leaves_other_goals_as_they_are() {
    for (mode, goal, value) in [(0, item::GOAL_CURRENT, 1), (1, item::GOAL_VELOCITY, 3), (16, item::GOAL_PWM, 2)] {
        let mut bench = bench(Model::Xm540W270, mode, &[]);
        bench.write(1, goal, value);
        assert_eq!(bench.ask(1, instruction::CLEAR, &[0x01, 0x44, 0x58, 0x4C, 0x22]), [0], "mode {mode}");
        assert_eq!(bench.item(1, goal), value, "mode {mode}");
    }
}

#[test]
fn goals_that_are_bounds_are_never_above_their_limits() {
    let settings = ServoSettings::new(1, Model::Xm540W270).with(item::PWM_LIMIT, 700).with(item::CURRENT_LIMIT, 900);
    let mut bench = Bench::new(vec![settings]);
    let goals = |bench: &Bench| (bench.item(1, item::GOAL_PWM), bench.item(1, item::GOAL_CURRENT));
    assert_eq!(goals(&bench), (700, 900), "as it comes");
    bench.write(1, item::GOAL_PWM, 100);
    assert_eq!(bench.ask(1, instruction::REBOOT, &[]), [0]);
    bench.0.advance(0.5);
    assert_eq!(goals(&bench), (700, 900), "after a reboot");
    bench.write(1, item::PWM_LIMIT, 600);
    bench.write(1, item::CURRENT_LIMIT, 800);
    assert_eq!(goals(&bench), (600, 800), "with new limits");
    bench.write(1, item::GOAL_PWM, 100);
    bench.write(1, item::CURRENT_LIMIT, 700);
    assert_eq!(goals(&bench), (100, 700), "each with its own");
}

/// The e-manual's note on Operating Mode(11).
#[test]
fn a_new_operating_mode_has_the_gains_and_the_profile_of_the_factory() {
    let settings = ServoSettings::new(1, Model::Xm540W270).with(item::PWM_LIMIT, 700).with(item::CURRENT_LIMIT, 900);
    let mut bench = Bench::new(vec![settings]);
    let set: Vec<(Item, i32)> = [76, 78, 80, 82, 84, 88, 90].map(|address| (Item { address, size: 2 }, 77)).to_vec();
    let set =
        [set, vec![(item::PROFILE_ACCELERATION, 5), (item::PROFILE_VELOCITY, 50), (item::GOAL_PWM, 300)]].concat();
    let initial = [1920, 100, 0, 0, 800, 0, 0, 0, 0, 700];
    let values = |bench: &Bench| set.iter().map(|(item, _)| bench.item(1, *item)).collect::<Vec<_>>();
    set.iter().for_each(|(item, value)| bench.write(1, *item, *value));
    bench.write(1, item::GOAL_CURRENT, 100);
    bench.write(1, item::OPERATING_MODE, 3);
    assert_eq!(values(&bench), set.iter().map(|(_, value)| *value).collect::<Vec<_>>(), "it was in that mode");
    bench.write(1, item::OPERATING_MODE, 5);
    assert_eq!((values(&bench), bench.item(1, item::GOAL_CURRENT)), (initial.to_vec(), 900));
}
