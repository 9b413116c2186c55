//! What is written to servos before they move, and that a servo which holds goes on holding.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use std::collections::BTreeMap;

use dynamixel_hil::emulator::item;
use dynamixel_hil::planner::Arm;
use dynamixel_hil::register::{HOMING_OFFSET, MAX_POSITION_LIMIT, SECONDARY_ID};
use dynamixel_hil::{Bus, joint_position};
use support::{Lockstep, START, config, robot, simulation, swing};

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

/// Before and after Drive Mode is set, which mirrors what a servo tells.
#[test]
fn joints_are_where_the_arm_will_see_them() {
    let simulation = simulation();
    for _ in 0..2 {
        let mut bus = Bus::open(&simulation.path(), 1_000_000, 5.0, BTreeMap::new()).unwrap();
        let (config, robot) = (config(), robot());
        let truth = simulation.view().now().position;
        for servo in &config.servos {
            let found = joint_position(&mut bus, servo).unwrap();
            let place =
                servo.joint.as_ref().and_then(|joint| robot.chain.joint_names().iter().position(|n| n == joint));
            assert_eq!(found.is_some(), place.is_some(), "servo {}", servo.id);
            if let Some((found, place)) = found.zip(place) {
                // A pulse is 0.0015 rad; gears and links give some more under the arm's weight.
                assert!((found - truth[place]).abs() < 0.03, "servo {}: {found}, {}", servo.id, truth[place]);
            }
        }
        drop(bus);
        Lockstep::on(simulation.clone()).unwrap().run(0.1);
    }
}

/// Drive Mode cannot be written under torque: an arm that another driver left holding must not fall because of ours.
#[test]
fn an_arm_that_holds_with_other_settings_is_not_dropped() {
    let mut bench = Lockstep::new();
    bench.run(0.5);
    let Lockstep { arm, simulation, .. } = bench;
    drop(arm);
    let mut bus = Bus::open(&simulation.path(), 1_000_000, 5.0, BTreeMap::new()).unwrap();
    bus.set_torque(3, false).unwrap();
    bus.write(3, SECONDARY_ID, 2).unwrap();
    bus.set_torque(3, true).unwrap();
    drop(bus);
    let before = simulation.view().now().position;
    let why = Lockstep::on(simulation.clone()).err().unwrap().to_string();
    let words = "servo 3 (shoulder_shadow) holds the arm, and its Secondary(Shadow) ID of 2 has to be 255";
    assert!(why.starts_with(words), "{why}");
    simulation.with_bus(|bus| bus.advance(0.5));
    let after = simulation.view().now().position;
    assert!(before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 0.01), "{before:?} {after:?}");
}

#[test]
fn two_servos_of_a_joint_that_disagree_get_no_torque() {
    let simulation = simulation();
    let mut bus = Bus::open(&simulation.path(), 1_000_000, 5.0, BTreeMap::new()).unwrap();
    // As after an exchange of servos, without a calibration.
    bus.write(5, HOMING_OFFSET, 100).unwrap();
    drop(bus);
    let why = Lockstep::on(simulation.clone()).err().unwrap().to_string();
    let words = "servo 4 (elbow) and servo 5 (elbow_shadow) move the same joint and are 0.15";
    assert!(why.starts_with(words), "{why}");
    assert!(simulation.with_bus(|bus| bus.servos().iter().all(|servo| !servo.has_torque())).unwrap());
}

/// Servos refuse goals beyond their own limits, and nobody answers a group's write: goals end at what all servos of the joint take.
#[test]
fn goals_keep_within_the_servos_own_limits() {
    let simulation = simulation();
    let mut bus = Bus::open(&simulation.path(), 1_000_000, 5.0, BTreeMap::new()).unwrap();
    // Where the waist stands, and a little to one side.
    bus.write(1, MAX_POSITION_LIMIT, 2048 + 100).unwrap();
    drop(bus);
    let mut bench = Lockstep::on(simulation).unwrap();
    let mut to = START;
    to[0] += 0.4;
    bench.arm.play(None, swing(&START, &to)).unwrap();
    let words = bench.until_fault(3.0);
    assert!(words.starts_with("joint waist is 0."), "{words}");
    let goal = bench.simulation.with_bus(|bus| bus.servo(1).unwrap().item(item::GOAL_POSITION)).unwrap();
    assert_eq!(goal, 2148);
}

#[test]
fn two_masters_on_one_port_are_one_too_many() {
    let bench = Lockstep::new();
    let why = Bus::open(&bench.simulation.path(), 1_000_000, 5.0, BTreeMap::new()).err().unwrap().to_string();
    assert!(why.contains("cannot be opened at 1000000 baud") && why.contains("lock"), "{why}");
}

#[test]
fn what_breaks_limits_is_not_taken_up() {
    let mut bench = Lockstep::new();
    let present = bench.run(0.2);
    let whole = swing(&present.goal, &support::elsewhere(&present.goal));
    let mut hasty = whole.clone();
    // A trajectory that is slow, but for its end: 0.1 rad/s from rest within a millisecond.
    for (index, point) in hasty.points.iter_mut().enumerate() {
        point.time_s = if index == 0 { 0.0 } else { 0.001 + 4.0 * point.time_s };
        point.velocities.iter_mut().for_each(|v| *v *= 0.25);
        point.accelerations.iter_mut().for_each(|a| *a *= 0.0625);
    }
    let second = hasty.points[1].clone();
    hasty.points[1].velocities[0] = 0.1;
    assert!(second.time_s < 0.1);
    let why = bench.arm.play(None, hasty).unwrap_err().to_string();
    assert!(why.contains("its acceleration is"), "{why}");
    let mut far = whole;
    let last = far.points.len() - 1;
    far.points[last].positions[1] = 2.5;
    far.points[last].time_s += 20.0;
    let why = bench.arm.play(None, far).unwrap_err().to_string();
    assert!(why.contains("beyond the position limit of a joint") || why.contains("times"), "{why}");
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
