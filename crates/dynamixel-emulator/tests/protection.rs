//! Errors that a servo latches, the watchdog, reboots, resets and backups.
#![allow(clippy::unwrap_used, missing_docs)]

mod bench;

use bench::{Bench, write};
use dynamixel_emulator::packet::{BROADCAST_ID, Packet, instruction};
use dynamixel_emulator::{HardwareError, Model, ServoSettings, item};

const ALERT: u8 = 0x80;

/// A servo that holds its position.
fn holding() -> Bench {
    let mut bench = Bench::with_ids(&[1]);
    bench.write(1, item::TORQUE_ENABLE, 1);
    bench
}

fn status(bench: &Bench) -> i32 {
    bench.item(1, item::HARDWARE_ERROR_STATUS)
}

#[test]
fn overload_switches_off_until_a_reboot() {
    let mut bench = holding();
    // 94 % of the stall torque: the integral of 0.94² − 0.5² reaches 1.5 s after 2.4 s.
    bench.0.faults_mut().servos[0].load_torque_n_m = -10.0;
    bench.0.advance(2.2);
    assert_eq!(status(&bench), 0, "it takes a while");
    while status(&bench) == 0 && bench.0.now_s() < 3.0 {
        bench.0.advance(1e-3);
    }
    assert_eq!(status(&bench), HardwareError::Overload as i32);
    bench.0.faults_mut().servos[0].load_torque_n_m = 0.0;
    bench.0.advance(2e-3);
    assert_eq!((bench.item(1, item::TORQUE_ENABLE), bench.servo(1).torque_n_m()), (0, 0.0));
    assert_eq!(bench.try_write(1, item::TORQUE_ENABLE, 1), ALERT);
    assert_eq!(bench.item(1, item::TORQUE_ENABLE), 0, "torque stays off");
    assert_eq!(bench.ask(1, instruction::READ, &[70, 0, 1, 0]), [ALERT, 0x20]);
    assert_eq!(bench.ask(1, instruction::REBOOT, &[]), [ALERT]);
    bench.0.advance(0.5);
    bench.write(1, item::TORQUE_ENABLE, 1);
    bench.0.advance(0.5);
    assert_eq!((status(&bench), bench.item(1, item::TORQUE_ENABLE)), (0, 1));
}

#[test]
fn heat_switches_off_and_cold_does_not_switch_on() {
    let mut bench = holding();
    bench.0.faults_mut().servos[0].temperature_c = Some(80.0);
    bench.0.advance(0.1);
    assert_eq!((status(&bench), bench.item(1, item::PRESENT_TEMPERATURE)), (0, 80), "80 °C are allowed");
    bench.0.faults_mut().servos[0].temperature_c = Some(81.0);
    bench.0.advance(0.1);
    bench.0.faults_mut().servos[0].temperature_c = None;
    bench.0.advance(0.1);
    assert_eq!((status(&bench), bench.item(1, item::TORQUE_ENABLE)), (HardwareError::Overheating as i32, 0));
}

#[test]
fn low_voltage_is_told_and_switches_off_only_where_shutdown_says_so() {
    let mut bench = holding();
    bench.0.faults_mut().supply_v = 9.0;
    bench.0.advance(0.1);
    assert_eq!((status(&bench), bench.item(1, item::TORQUE_ENABLE)), (HardwareError::InputVoltage as i32, 1));
    assert_eq!(bench.item(1, item::PRESENT_INPUT_VOLTAGE), 90);
    assert_eq!(bench.try_write(1, item::LED, 1), ALERT, "what is told is done all the same");
    let mut bench = Bench::new(vec![ServoSettings::new(1, Model::Xm540W270).with(item::SHUTDOWN, 53)]);
    bench.write(1, item::TORQUE_ENABLE, 1);
    bench.0.faults_mut().supply_v = 16.1;
    bench.0.advance(0.1);
    assert_eq!((status(&bench), bench.item(1, item::TORQUE_ENABLE)), (HardwareError::InputVoltage as i32, 0));
}

#[test]
fn no_supply_that_there_cannot_be_is_a_panic() {
    for mode in [0, 1, 3, 5, 16] {
        let settings = ServoSettings::new(1, Model::Xm540W270).with(item::OPERATING_MODE, mode);
        let mut bench = Bench::new(vec![settings]);
        bench.write(1, item::TORQUE_ENABLE, 1);
        for supply_v in [0.0, -12.0, f64::NAN, f64::INFINITY] {
            bench.0.faults_mut().supply_v = supply_v;
            bench.0.advance(0.01);
            assert!(bench.servo(1).torque_n_m().abs() < 1e-9, "{} N m at {supply_v} V", bench.servo(1).torque_n_m());
        }
    }
}

#[test]
fn errors_that_no_model_makes_can_be_raised() {
    for (error, torque) in [(HardwareError::ElectricalShock, 0), (HardwareError::Encoder, 1)] {
        let mut bench = holding();
        bench.0.faults_mut().servos[0].hardware_error = Some(error);
        bench.0.advance(0.01);
        assert_eq!((status(&bench), bench.item(1, item::TORQUE_ENABLE)), (error as i32, torque), "{error:?}");
    }
}

/// The example of the e-manual's Bus Watchdog(98), but for its first step.
#[test]
fn the_watchdog_stops_a_servo_that_nobody_speaks_to() {
    let mut bench = Bench::new(vec![ServoSettings::new(1, Model::Xm540W270).with(item::OPERATING_MODE, 1)]);
    bench.write(1, item::TORQUE_ENABLE, 1);
    bench.write(1, item::GOAL_VELOCITY, 50);
    bench.write(1, item::BUS_WATCHDOG, 100);
    bench.0.advance(1.9);
    assert!(bench.item(1, item::PRESENT_VELOCITY) > 45);
    bench.send(9, instruction::PING, &[]);
    bench.0.advance(1.9);
    assert!(bench.item(1, item::PRESENT_VELOCITY) > 45, "a packet for another servo is heard too");
    bench.0.advance(0.5);
    assert_eq!((bench.item(1, item::PRESENT_VELOCITY), bench.item(1, item::BUS_WATCHDOG)), (0, 255));
    assert_eq!(bench.try_write(1, item::GOAL_VELOCITY, 100), 4, "goals are read-only");
    assert_eq!(bench.try_write(1, item::BUS_WATCHDOG, 100), 4, "only 0 takes the error away");
    assert_eq!(bench.item(1, item::BUS_WATCHDOG), 255);
    bench.write(1, item::BUS_WATCHDOG, 0);
    bench.write(1, item::GOAL_VELOCITY, 100);
    bench.0.advance(2.0);
    assert!(bench.item(1, item::PRESENT_VELOCITY) > 95);
}

#[test]
fn the_watchdog_wants_whole_instructions() {
    let packet = |instruction| Packet { id: 1, instruction, parameters: vec![0] }.encode();
    let broken = [&packet(instruction::PING)[..10], &[0]].concat();
    for (bytes, stops) in [(broken, 255), (packet(instruction::STATUS), 255), (packet(instruction::PING), 10)] {
        let mut bench = holding();
        bench.write(1, item::BUS_WATCHDOG, 10);
        // More than the 200 ms in which it wants to hear something.
        for _ in 0..30 {
            bench.0.advance(0.01);
            bench.0.receive(&bytes);
        }
        assert_eq!(bench.item(1, item::BUS_WATCHDOG), stops, "{bytes:02X?}");
    }
}

#[test]
fn a_factory_reset_keeps_what_it_is_told_to_keep() {
    let settings = || ServoSettings::new(7, Model::Xl430W250).with(item::BAUD_RATE, 3).with(item::SHUTDOWN, 0);
    for (option, id, baud_rate) in [(0xFF, 1, 1), (0x01, 7, 1), (0x02, 7, 3)] {
        let mut bench = Bench::new(vec![settings()]);
        assert_eq!(bench.ask(7, instruction::FACTORY_RESET, &[option]), [0], "the answer is by the old name");
        bench.0.advance(0.5);
        assert_eq!((bench.item(id, item::BAUD_RATE), bench.item(id, item::SHUTDOWN)), (baud_rate, 52));
    }
    let mut bench = Bench::new(vec![settings()]);
    bench.send(BROADCAST_ID, instruction::FACTORY_RESET, &[0xFF]);
    assert_eq!(bench.item(7, item::SHUTDOWN), 0, "not all servos at once");
    assert_eq!(bench.ask(7, instruction::FACTORY_RESET, &[0x03]), [4]);
}

#[test]
fn a_backup_brings_eeprom_back_and_ram_where_that_is_configured() {
    const BACKUP: [u8; 5] = [0x01, 0x43, 0x54, 0x52, 0x4C];
    const RESTORE: [u8; 5] = [0x02, 0x43, 0x54, 0x52, 0x4C];
    let mut bench = Bench::with_ids(&[1]);
    let back_up = |bench: &mut Bench, what: &[u8]| bench.ask(1, instruction::CONTROL_TABLE_BACKUP, what)[0];
    assert_eq!(back_up(&mut bench, &RESTORE), 1, "there is nothing yet");
    bench.write(1, item::STARTUP_CONFIGURATION, 2);
    bench.write(1, item::HOMING_OFFSET, 77);
    bench.write(1, item::POSITION_P_GAIN, 900);
    bench.write(1, item::LED, 1);
    assert_eq!(back_up(&mut bench, &BACKUP), 0);
    assert_eq!(bench.item(1, item::BACKUP_READY), 1);
    bench.write(1, item::HOMING_OFFSET, 0);
    bench.write(1, item::POSITION_P_GAIN, 100);
    bench.write(1, item::TORQUE_ENABLE, 1);
    assert_eq!(back_up(&mut bench, &RESTORE), 1, "not with the torque on");
    bench.write(1, item::TORQUE_ENABLE, 0);
    assert_eq!(back_up(&mut bench, &RESTORE), 0);
    bench.0.advance(0.5);
    let items = [item::HOMING_OFFSET, item::POSITION_P_GAIN, item::LED, item::BACKUP_READY];
    assert_eq!(items.map(|item| bench.item(1, item)), [77, 900, 0, 1]);
}

#[test]
fn firmware_before_45_knows_neither_backups_nor_fast_reads() {
    let old = |id| ServoSettings::new(id, Model::Xm540W270).with(item::FIRMWARE_VERSION, 44);
    let mut bench = Bench::new(vec![old(1), old(2)]);
    assert_eq!(bench.ask(1, instruction::CONTROL_TABLE_BACKUP, &[0x01, 0x43, 0x54, 0x52, 0x4C]), [2]);
    assert_eq!(bench.send(BROADCAST_ID, instruction::FAST_SYNC_READ, &[132, 0, 4, 0, 1, 2]), []);
    assert_eq!(bench.send(BROADCAST_ID, instruction::SYNC_READ, &[132, 0, 4, 0, 1, 2]).len(), 2);
}

#[test]
fn a_registered_write_obeys_the_rules_of_the_moment_of_its_action() {
    let mut bench = Bench::with_ids(&[1]);
    assert_eq!(bench.ask(1, instruction::REG_WRITE, &write(item::LED, 9)), [4], "it is checked at once");
    assert_eq!(bench.ask(1, instruction::REG_WRITE, &write(item::HOMING_OFFSET, 9)), [0]);
    bench.write(1, item::TORQUE_ENABLE, 1);
    assert_eq!(bench.ask(1, instruction::ACTION, &[]), [7], "and again");
    assert_eq!(bench.ask(1, instruction::ACTION, &[]), [2], "once");
    // By the broadcast ID all act, and nobody answers.
    assert_eq!(bench.ask(1, instruction::REG_WRITE, &write(item::LED, 1)), [0]);
    assert_eq!(bench.send(BROADCAST_ID, instruction::ACTION, &[]), []);
    assert_eq!(bench.item(1, item::LED), 1);
}

#[test]
fn voltage_and_temperature_are_measured_before_anything_happens() {
    let bench = Bench::with_ids(&[1]);
    assert_eq!(bench.item(1, item::PRESENT_INPUT_VOLTAGE), 120);
    assert_eq!(bench.item(1, item::PRESENT_TEMPERATURE), 25);
}

#[test]
fn the_realtime_tick_begins_anew_with_a_reboot() {
    let mut bench = Bench::with_ids(&[1]);
    bench.0.advance(2.0);
    assert!((1999..=2001).contains(&bench.item(1, item::REALTIME_TICK)), "{}", bench.item(1, item::REALTIME_TICK));
    assert_eq!(bench.ask(1, instruction::REBOOT, &[]), [0]);
    bench.0.advance(0.5);
    assert!(bench.item(1, item::REALTIME_TICK) < 500, "{}", bench.item(1, item::REALTIME_TICK));
}
