//! Everything that goes wrong with a bus: what the user is told, and that the arm never jumps.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use dynamixel_hil::emulator::{Connection, HardwareError, Rates};
use dynamixel_hil::planner::{Arm, Refused};
use support::{Lockstep, START, elsewhere, simulation, swing};

/// The bound of the shipped configuration, and what a joint swings beyond it.
const FASTEST_RAD_S: f64 = 2.0 * 1.1;

/// A swing there and back on a bus whose packets are hurt: it goes on, follows, and is never faster than it may be.
fn swings_through(rates: Rates, worst_rad: f64) {
    let mut bench = Lockstep::new();
    bench.run(0.1);
    bench.hurt(rates);
    let trajectory = swing(&START, &elsewhere(&START));
    bench.arm.play(None, trajectory.clone()).unwrap();
    let present = bench.run(trajectory.duration_s() + 0.3);
    let hurt = bench.simulation.with_bus(|bus| bus.faults().hurt).unwrap();
    println!("{rates:?}: {:.4} rad, {:.2} rad/s, {hurt} hurt", bench.worst_rad, bench.fastest_rad_s);
    assert_eq!(present.fault, None);
    assert!(bench.worst_rad < worst_rad && bench.fastest_rad_s < FASTEST_RAD_S);
    assert!(hurt > 0);
}

/// Chances of the issue, and how far a joint may then be off: where every fifth goal is lost, a joint lags by what it should have gone
/// in some steps, at 2 rad/s 0.01 rad each.
const CHANCES: [(f64, f64); 3] = [(0.01, 0.04), (0.05, 0.05), (0.2, 0.08)];

#[test]
fn dropped_packets() {
    for (dropped, worst_rad) in CHANCES {
        swings_through(Rates { dropped, ..Rates::default() }, worst_rad);
    }
}

#[test]
fn corrupted_packets() {
    for (corrupted, worst_rad) in CHANCES {
        swings_through(Rates { corrupted, ..Rates::default() }, worst_rad);
    }
}

#[test]
fn truncated_packets() {
    for (truncated, worst_rad) in CHANCES {
        swings_through(Rates { truncated, ..Rates::default() }, worst_rad);
    }
}

#[test]
fn delayed_packets() {
    for (delayed, worst_rad) in CHANCES {
        swings_through(Rates { delayed, delay_s: 0.02, ..Rates::default() }, worst_rad);
    }
}

#[test]
fn an_arm_comes_up_on_a_bus_that_loses_every_fifth_packet() {
    let simulation = simulation();
    simulation.with_bus(|bus| {
        bus.faults_mut().seed(3);
        (bus.faults_mut().to_servos.dropped, bus.faults_mut().to_host.dropped) = (0.2, 0.2);
    });
    let mut bench = Lockstep::on(simulation).unwrap();
    assert_eq!(bench.run(0.2).fault, None);
    assert!(bench.arm.counters().retries > 10);
}

#[test]
fn a_servo_that_disappears_and_comes_back() {
    let mut bench = Lockstep::new();
    bench.half_way();
    bench.simulation.with_bus(|bus| bus.faults_mut().servos[3].connection = Connection::NoData);
    // Who it is is asked between goals, one question a step: no goal comes late for it.
    let mut searched = false;
    let words = (0..100).find_map(|_| {
        let before = bench.arm.counters().sent;
        let present = bench.step();
        let fault = present.fault;
        if fault.is_none() && bench.arm.recover().is_err() {
            // Meanwhile nothing is over, and nothing else is taken up.
            searched = true;
            assert!(present.ends_at_s > present.now_s);
            let refused = bench.arm.play(None, swing(&present.goal, &START)).unwrap_err();
            assert_eq!(refused, Refused::Faulty("the servos did not all answer".into()));
            bench.arm.stop();
        }
        assert!(bench.arm.counters().sent - before <= 2, "more than goals and a question in one step");
        fault
    });
    assert_eq!(words.unwrap(), "servo 4 (elbow) does not answer");
    assert!(searched);
    let present = bench.arm.present();
    assert!(present.desired[1].iter().any(|v| *v != 0.0), "it is still led to rest");
    bench.run(1.0);
    bench.simulation.with_bus(|bus| bus.faults_mut().servos[3].connection = Connection::Whole);
    goes_on(&mut bench);
}

#[test]
fn a_servo_that_loses_its_power_for_a_moment() {
    let mut bench = Lockstep::new();
    bench.half_way();
    bench.simulation.with_bus(|bus| bus.faults_mut().servos[2].connection = Connection::Unplugged);
    assert_eq!(bench.until_fault(0.5), "servo 3 (shoulder_shadow) does not answer");
    let stopped = bench.run(0.5);
    bench.simulation.with_bus(|bus| bus.faults_mut().servos[2].connection = Connection::Whole);
    // It has forgotten everything; the other one goes on holding the joint where it stopped.
    let present = bench.run(0.5);
    assert_eq!(present.goal, stopped.goal);
    goes_on(&mut bench);
}

#[test]
fn something_in_the_way() {
    let mut bench = Lockstep::new();
    bench.half_way();
    // A little more than both servos of the shoulder have.
    let push = |torque: f64| {
        move |bus: &mut dynamixel_hil::emulator::Bus| {
            bus.faults_mut().servos[1].load_torque_n_m = -torque;
            bus.faults_mut().servos[2].load_torque_n_m = torque;
        }
    };
    bench.simulation.with_bus(push(12.0));
    let words = bench.until_fault(2.0);
    assert!(
        words.starts_with("joint shoulder is 0.") && words.ends_with("or servo 2 (shoulder) is too weak"),
        "{words}"
    );
    let here = bench.arm.present().goal;
    assert_eq!(bench.arm.play(None, swing(&here, &START)), Err(Refused::Faulty(words)));
    // The arm gives way, so that it does not leap when it is let go.
    bench.run(0.5);
    bench.fastest_rad_s = 0.0;
    bench.simulation.with_bus(push(0.0));
    goes_on(&mut bench);
}

#[test]
fn overload_in_the_midst_of_a_motion() {
    let mut bench = Lockstep::new();
    bench.half_way();
    bench.simulation.with_bus(|bus| bus.faults_mut().servos[3].hardware_error = Some(HardwareError::Overload));
    assert_eq!(bench.until_fault(0.5), "servo 4 (elbow) reports that it is overloaded");
    goes_on(&mut bench);
}

#[test]
fn low_voltage() {
    let mut bench = Lockstep::new();
    bench.half_way();
    bench.simulation.with_bus(|bus| bus.faults_mut().supply_v = 9.0);
    let words = bench.until_fault(1.0);
    assert_eq!(words, "servo 1 (waist) reports that its input voltage is out of range");
    let present = bench.run(1.0);
    assert!(present.ends_at_s < present.now_s);
    assert!(bench.fastest_rad_s < FASTEST_RAD_S);
    // Low voltage leaves the torque on, and only starting anew forgets it: that would drop the arm.
    bench.simulation.with_bus(|bus| bus.faults_mut().supply_v = 12.0);
    let why = bench.meanwhile(|arm| arm.recover()).unwrap_err().to_string();
    assert!(
        why.contains("servo 1 (waist) holds the arm, and only starting anew clears that its input voltage"),
        "{why}"
    );
    let before = bench.simulation.view().now().position;
    bench.run(0.3);
    let after = bench.simulation.view().now().position;
    assert!(before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 0.01), "{before:?} {after:?}");
}

#[test]
fn a_host_that_pauses() {
    let mut bench = Lockstep::new();
    bench.half_way();
    let before = bench.arm.present();
    bench.simulation.with_bus(|bus| bus.advance(0.5));
    let present = bench.step();
    assert_eq!(present.fault.unwrap(), "this computer paused for 0.50 s in the midst of a motion");
    // What is wanted does not go on to where the motion would be by now.
    let gone: f64 = present.desired[0].iter().zip(&before.desired[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(gone < 0.2 && present.desired[1] == vec![0.0; 6], "{gone}");
    goes_on(&mut bench);
}

#[test]
fn an_unplugged_port() {
    let mut bench = Lockstep::new();
    bench.half_way();
    bench.simulation.unplug();
    let words = bench.until_fault(0.5);
    assert!(
        words.starts_with("port /dev/pts/") && words.contains("is gone, is the cable still plugged in?"),
        "{words}"
    );
    let why = bench.arm.recover().unwrap_err().to_string();
    assert!(why.contains("cannot be opened"), "{why}");
}

#[test]
fn a_port_that_is_plugged_in_again() {
    // As udev gives an adapter a name that stays, whatever the system calls it this time.
    let folder = tempfile::tempdir().unwrap();
    let name = folder.path().join("arm");
    let simulation = simulation();
    std::os::unix::fs::symlink(simulation.path(), &name).unwrap();
    let mut bench = Lockstep::at(simulation, name.to_str().unwrap()).unwrap();
    bench.half_way();
    bench.simulation.unplug();
    bench.until_fault(0.5);
    assert!(bench.arm.recover().is_err(), "nothing is plugged in");
    let port = bench.simulation.plug_in().unwrap();
    std::fs::remove_file(&name).unwrap();
    std::os::unix::fs::symlink(port, &name).unwrap();
    goes_on(&mut bench);
}

#[test]
fn a_servo_of_another_model() {
    let simulation = simulation();
    simulation.with_bus(|bus| bus.faults_mut().servos[7].model_number = Some(1060));
    let why = Lockstep::on(simulation).err().unwrap().to_string();
    assert_eq!(why, "servo 8 (wrist_rotate) is a XL430-W250, but the configuration says XM430-W350");
}

#[test]
fn two_servos_with_one_id() {
    let simulation = simulation();
    simulation.with_bus(|bus| bus.faults_mut().servos[8].id = Some(5));
    let why = Lockstep::on(simulation).err().unwrap().to_string();
    assert!(
        why.starts_with(
            "what servo 5 (elbow_shadow) answers arrives damaged time and again: another servo has the same ID"
        ),
        "{why}"
    );
}

#[test]
fn a_bus_without_power() {
    let simulation = simulation();
    simulation
        .with_bus(|bus| bus.faults_mut().servos.iter_mut().for_each(|servo| servo.connection = Connection::Unplugged));
    let why = Lockstep::on(simulation).err().unwrap().to_string();
    assert!(why.starts_with("no servo answers on port /dev/pts/") && why.contains("1000000 baud"), "{why}");
}

/// After the cause is gone the arm goes on from where it stands, and was never faster than it may be.
fn goes_on(bench: &mut Lockstep) {
    bench.run(0.5);
    assert!(bench.arm.present().fault.is_some(), "a fault stays until somebody has seen it");
    assert_eq!(bench.meanwhile(|arm| arm.recover()), Ok(()));
    let present = bench.run(0.3);
    assert_eq!(present.fault, None);
    bench.arm.play(None, swing(&present.goal, &START)).unwrap();
    let present = bench.run(3.0);
    let off: f64 = present.position.iter().zip(&START).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 0.03 && present.fault.is_none(), "{off}");
    assert!(bench.fastest_rad_s < FASTEST_RAD_S, "{} rad/s", bench.fastest_rad_s);
}
