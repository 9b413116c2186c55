//! The driver against emulated servos whose shafts are free: every way to ask and to tell, and what it says when something is refused.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeMap;

use dynamixel_hil::emulator::{self, EmulatedPort, FreeShafts, ServoSettings, Timing, item};
use dynamixel_hil::register::{
    DRIVE_MODE, GOAL_POSITION, HOMING_OFFSET, Mode, OPERATING_MODE, POSITION_P_GAIN, PRESENT_POSITION, PROFILE_VELOCITY,
};
use dynamixel_hil::{Bus, Model};

const MODELS: [Model; 3] = [Model::Xm540W270, Model::Xm430W350, Model::Xl430W250];

/// Servos 1, 2 and 3 at 1 Mbit/s.
fn bench() -> (EmulatedPort, Bus) {
    let models = MODELS.map(emulator::Model::from);
    let servo = |(id, model)| ServoSettings::new(id, model).with(item::BAUD_RATE, 3);
    let servos = (1..).zip(models).map(servo).collect();
    let bus = emulator::Bus::new(servos, Box::new(FreeShafts::new(&models))).unwrap();
    let port = EmulatedPort::open(bus, Timing::BusTime).unwrap();
    let names = BTreeMap::from([(1, "waist".to_owned())]);
    let bus = Bus::open(&port.path().display().to_string(), 1_000_000, 1.0, names).unwrap();
    (port, bus)
}

#[test]
fn servos_are_found_and_told_apart() {
    let (_port, mut bus) = bench();
    assert_eq!(bus.scan().unwrap(), [1, 2, 3]);
    for (id, model) in (1..).zip(MODELS) {
        assert_eq!(bus.ping(id).unwrap(), model.number());
    }
    assert_eq!(bus.ping(7).unwrap_err().to_string(), "servo 7 does not answer");
    let counters = bus.counters();
    assert!(counters.timeouts == counters.retries + 1 && counters.corrupt == 0, "{counters:?}");
}

#[test]
fn registers_are_written_and_read_back() {
    let (_port, mut bus) = bench();
    bus.write(1, HOMING_OFFSET, -100_i32 as u32).unwrap();
    assert_eq!(bus.read(1, HOMING_OFFSET).unwrap() as i32, -100);
    for mode in [Mode::Velocity, Mode::Position, Mode::ExtendedPosition, Mode::CurrentBasedPosition] {
        bus.write(2, OPERATING_MODE, mode as u32).unwrap();
        assert_eq!(bus.read(2, OPERATING_MODE).unwrap(), mode as u32);
    }
    bus.set_torque(1, true).unwrap();
    let why = bus.write(1, DRIVE_MODE, 1).unwrap_err().to_string();
    assert_eq!(why, "servo 1 (waist) refuses 1 as its Drive Mode: it is not accessible now");
    assert_eq!(bus.hardware_errors(1).unwrap().0, 0);
}

#[test]
fn groups_are_read_and_written_at_once() {
    let (port, mut bus) = bench();
    let group = bus.group_write(&[1, 2, 3], PROFILE_VELOCITY).unwrap();
    bus.group_set(&group, &[10, 20, 30]).unwrap();
    bus.group_set(&group, &[11, 21, 31]).unwrap();
    let read = bus.group_read(&[3, 1, 2], PROFILE_VELOCITY.address, 4).unwrap();
    assert!(Bus::is_fast(&read));
    assert_eq!(bus.group_get(&read).unwrap(), [[31, 0, 0, 0], [11, 0, 0, 0], [21, 0, 0, 0]]);
    bus.bulk_write(&[(1, GOAL_POSITION, 1000), (2, POSITION_P_GAIN, 640)]).unwrap();
    let wanted = [(1, GOAL_POSITION), (2, POSITION_P_GAIN), (3, PRESENT_POSITION)];
    assert_eq!(bus.bulk_read(&wanted).unwrap(), [1000, 640, 2048]);
    assert_eq!(port.with_bus(|bus| bus.servo(2).unwrap().item(item::POSITION_P_GAIN)), 640);
}

#[test]
fn servos_that_know_no_fast_read_are_read_one_by_one() {
    let models = [emulator::Model::Xm430W350; 2];
    let servo = |id| ServoSettings::new(id, models[0]).with(item::BAUD_RATE, 3).with(item::FIRMWARE_VERSION, 42);
    let bus = emulator::Bus::new(vec![servo(1), servo(2)], Box::new(FreeShafts::new(&models))).unwrap();
    let port = EmulatedPort::open(bus, Timing::BusTime).unwrap();
    let mut bus = Bus::open(&port.path().display().to_string(), 1_000_000, 1.0, BTreeMap::new()).unwrap();
    let read = bus.group_read(&[1, 2], PRESENT_POSITION.address, 4).unwrap();
    assert!(!Bus::is_fast(&read));
    assert_eq!(bus.group_get(&read).unwrap(), [[0, 8, 0, 0], [0, 8, 0, 0]]);
}

#[test]
fn ports_that_do_not_open_are_named() {
    let open = |port, baud| Bus::open(port, baud, 1.0, BTreeMap::new()).err().unwrap().to_string();
    let nowhere = open("/dev/ttyNOWHERE", 1_000_000);
    assert!(nowhere.starts_with("port /dev/ttyNOWHERE cannot be opened at 1000000 baud: "), "{nowhere}");
    assert!(!nowhere.contains('\n'));
    assert!(open("/dev/ttyNOWHERE", 12_345).contains("the SDK does not know 12345 baud"));
}
