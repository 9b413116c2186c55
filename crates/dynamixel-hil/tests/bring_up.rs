//! What is written to servos before they move, and that a servo which holds goes on holding.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use std::collections::BTreeMap;

use dynamixel_hil::Bus;
use dynamixel_hil::emulator::item;
use dynamixel_hil::planner::Arm;
use dynamixel_hil::register::{HOMING_OFFSET, SECONDARY_ID};
use support::{Lockstep, START, simulation};

#[test]
fn servos_are_set_up_whatever_they_were_before() {
    let simulation = simulation();
    let mut bus = Bus::open(&simulation.path(), 1_000_000, 5.0, BTreeMap::new()).unwrap();
    // As the manufacturer sells it: the shadow obeys the other servo of its joint, and so would take over that one's Drive Mode.
    bus.write(3, SECONDARY_ID, 2).unwrap();
    // Somebody's calibration is nobody else's business.
    bus.write(6, HOMING_OFFSET, 10).unwrap();
    drop(bus);
    let mut bench = Lockstep::on(simulation).unwrap();
    bench.run(0.3);
    let of = |id: u8, items: &[item::Item]| -> Vec<i32> {
        let bus = |bus: &mut dynamixel_hil::emulator::Bus| {
            items.iter().map(|item| bus.servo(id).unwrap().item(*item)).collect()
        };
        bench.simulation.with_bus(bus).unwrap()
    };
    let kept = [item::DRIVE_MODE, item::OPERATING_MODE, item::RETURN_DELAY_TIME, item::SECONDARY_ID];
    assert_eq!(of(2, &kept), [1, 3, 0, 255]);
    assert_eq!(of(3, &kept), [0, 3, 0, 255]);
    assert_eq!(of(6, &[item::HOMING_OFFSET]), [10]);
    // 2 rad/s in units of 0.229 rev/min.
    let others = [item::POSITION_P_GAIN, item::PROFILE_VELOCITY, item::PROFILE_ACCELERATION, item::TORQUE_ENABLE];
    assert_eq!(of(7, &others), [800, 84, 0, 1]);
}

#[test]
fn an_arm_that_holds_goes_on_holding_when_it_is_opened_again() {
    let mut bench = Lockstep::new();
    bench.run(0.5);
    let Lockstep { arm, simulation, .. } = bench;
    drop(arm);
    let before = simulation.view().now().position;
    let mut again = Lockstep::on(simulation).unwrap();
    let present = again.run(0.5);
    let moved = present.position.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // A fall of a tenth of a second would be 0.05 m, on an arm of half a metre 0.1 rad.
    assert!(moved < 0.01 && again.fastest_rad_s < 0.2, "{moved} {}", again.fastest_rad_s);
    assert!(present.position.iter().zip(&START).all(|(a, b)| (a - b).abs() < 0.02));
    again.arm.release().unwrap();
    assert!(again.arm.present().fault.is_none());
    again.run(0.5);
    let words = again.arm.present().fault.expect("an arm without torque does not stand");
    assert_eq!(words, "servo 1 (waist) has no torque: it has started anew, or somebody has switched it off");
}
