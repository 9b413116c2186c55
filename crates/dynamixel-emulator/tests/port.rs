//! The bus behind a pseudo-terminal, as a host sees it.
#![allow(clippy::unwrap_used, missing_docs)]

use dynamixel_emulator::packet::{HEADER, Packet, instruction};
use dynamixel_emulator::{
    Bus, Connection, EmulatedPort, FreeShafts, Model, Plant, Rates, ServoSettings, Shaft, Timing, item,
};
use serialport::SerialPort;
use std::io::{ErrorKind, Write};
use std::panic::AssertUnwindSafe;
use std::time::{Duration, Instant};

const STATUS_OF_PING: usize = 14;

fn port(timing: Timing) -> EmulatedPort {
    let model = Model::Xl430W250;
    let servos = vec![ServoSettings::new(1, model), ServoSettings::new(2, model).with(item::BAUD_RATE, 3)];
    EmulatedPort::open(Bus::new(servos, Box::new(FreeShafts::new(&[model; 2]))).unwrap(), timing).unwrap()
}

fn open(port: &EmulatedPort, baud: u32) -> Box<dyn SerialPort> {
    serialport::new(port.path().to_str().unwrap(), baud).timeout(Duration::from_millis(200)).open().unwrap()
}

fn ping(host: &mut dyn SerialPort, id: u8) -> std::io::Result<[u8; STATUS_OF_PING]> {
    host.write_all(&Packet { id, instruction: instruction::PING, parameters: vec![] }.encode())?;
    let mut status = [0; STATUS_OF_PING];
    host.read_exact(&mut status).map(|()| status)
}

#[test]
fn on_the_wall_clock_answers_take_as_long_as_on_a_wire() {
    let port = port(Timing::WallClock);
    let mut host = open(&port, 57_600);
    let started = Instant::now();
    (0..20).for_each(|_| assert_eq!(ping(host.as_mut(), 1).unwrap()[4], 1));
    // 24 bytes at 57,600 baud, and 500 µs of return delay. There is no upper bound: other programs run too.
    let least = Duration::from_secs_f64(20.0 * (24.0 * 10.0 / 57_600.0 + 500e-6));
    assert!(started.elapsed() >= least, "{:?} instead of {least:?}", started.elapsed());
    let (now_s, ran) = port.with_bus(|bus| (bus.now_s(), started.elapsed()));
    assert!(now_s >= least.as_secs_f64(), "{now_s} s on the bus in {ran:?}");
    assert_eq!(port.with_bus(|bus| bus.faults().talked_over), 0);
}

#[test]
fn on_the_wall_clock_the_bus_runs_ahead_by_no_more_than_a_portion() {
    let started = Instant::now();
    let port = port(Timing::WallClock);
    let mut host = open(&port, 57_600);
    // To nobody, so that there is no answer that is waited for.
    let packet = Packet { id: 9, instruction: instruction::PING, parameters: vec![] }.encode();
    let bytes = packet.repeat(400);
    host.write_all(&bytes).unwrap();
    let takes_s = |bytes: usize| bytes as f64 * 10.0 / 57_600.0;
    let mut now_s = 0.0;
    while now_s < takes_s(bytes.len()) {
        now_s = port.with_bus(|bus| bus.now_s());
        let ahead_s = now_s - started.elapsed().as_secs_f64();
        // Of 1024 bytes.
        assert!(ahead_s <= takes_s(1024), "{ahead_s} s");
        std::thread::yield_now();
    }
}

#[test]
fn in_bus_time_answers_come_at_once_and_only_traffic_makes_time_pass() {
    let port = port(Timing::BusTime);
    let mut host = open(&port, 57_600);
    (0..20).for_each(|_| assert_eq!(ping(host.as_mut(), 1).unwrap()[4], 1));
    let expected = 20.0 * (24.0 * 10.0 / 57_600.0 + 500e-6);
    assert!((port.with_bus(|bus| bus.now_s()) - expected).abs() < 1e-9);
    port.with_bus(|bus| bus.faults_mut().to_host = Rates { dropped: 1.0, ..Rates::default() });
    assert_eq!(ping(host.as_mut(), 1).unwrap_err().kind(), ErrorKind::TimedOut);
    assert_eq!(ping(host.as_mut(), 1).unwrap_err().kind(), ErrorKind::TimedOut);
    assert_eq!(
        port.with_bus(|bus| bus.faults().talked_over),
        0,
        "an answer that is lost is over before the host gives up"
    );
}

#[test]
fn in_bus_time_a_truncated_packet_does_not_take_the_next_one_with_it() {
    let port = port(Timing::BusTime);
    let mut host = open(&port, 57_600);
    let packet = Packet { id: 1, instruction: instruction::WRITE, parameters: vec![0; 100] }.encode();
    host.write_all(&packet[..12]).unwrap();
    assert_eq!(host.read(&mut [0]).unwrap_err().kind(), ErrorKind::TimedOut);
    assert_eq!(ping(host.as_mut(), 1).unwrap()[4], 1);
}

#[test]
fn the_rate_is_the_one_that_the_host_sets() {
    let port = port(Timing::BusTime);
    let mut host = open(&port, 1_000_000);
    assert_eq!(ping(host.as_mut(), 1).unwrap_err().kind(), ErrorKind::TimedOut);
    assert_eq!(ping(host.as_mut(), 2).unwrap()[4], 2);
    host.set_baud_rate(57_600).unwrap();
    assert_eq!(ping(host.as_mut(), 2).unwrap_err().kind(), ErrorKind::TimedOut);
    assert_eq!(ping(host.as_mut(), 1).unwrap()[4], 1);
}

#[test]
fn faults_are_injected_while_a_host_is_connected() {
    let port = port(Timing::BusTime);
    let mut host = open(&port, 57_600);
    assert!(ping(host.as_mut(), 1).is_ok());
    port.with_bus(|bus| bus.faults_mut().servos[0].connection = Connection::NoData);
    assert_eq!(ping(host.as_mut(), 1).unwrap_err().kind(), ErrorKind::TimedOut);
    port.with_bus(|bus| bus.faults_mut().servos[0].connection = Connection::Whole);
    assert!(ping(host.as_mut(), 1).is_ok());
}

#[test]
fn a_host_can_come_again() {
    let port = port(Timing::WallClock);
    for _ in 0..3 {
        assert!(ping(open(&port, 57_600).as_mut(), 1).is_ok());
    }
}

#[test]
fn unplugging_hangs_up_on_the_host() {
    let port = port(Timing::WallClock);
    let path = port.path().to_owned();
    let mut host = open(&port, 57_600);
    assert!(ping(host.as_mut(), 1).is_ok());
    let _bus = port.unplug();
    let error = ping(host.as_mut(), 1).unwrap_err();
    assert_ne!(error.kind(), ErrorKind::TimedOut, "it is told, not kept waiting");
    drop(host);
    assert!(!path.exists(), "{} is gone", path.display());
}

/// A plant that breaks.
struct Broken;

impl Plant for Broken {
    fn step(&mut self, _torques: &[f64], _dt_s: f64) {
        panic!("the plant is broken");
    }

    fn shaft(&self, _servo: usize) -> Shaft {
        Shaft::default()
    }
}

#[test]
fn a_panic_behind_the_port_comes_out_when_it_is_closed() {
    let bus = Bus::new(vec![ServoSettings::new(1, Model::Xl430W250)], Box::new(Broken)).unwrap();
    let port = EmulatedPort::open(bus, Timing::WallClock).unwrap();
    let mut host = open(&port, 57_600);
    let deadline = Instant::now() + Duration::from_secs(5);
    // The host is hung up on once the panic has been told.
    while ping(host.as_mut(), 1).unwrap_err().kind() == ErrorKind::TimedOut {
        assert!(Instant::now() < deadline);
    }
    let panic = std::panic::catch_unwind(AssertUnwindSafe(|| drop(port))).unwrap_err();
    assert_eq!(panic.downcast_ref(), Some(&"the plant is broken"));
}

#[test]
fn a_host_that_fetches_nothing_does_not_hold_the_bus_up() {
    let port = port(Timing::BusTime);
    let mut host = open(&port, 57_600);
    let packet = Packet { id: 1, instruction: instruction::PING, parameters: vec![] }.encode();
    (0..2000).for_each(|_| host.write_all(&packet).unwrap());
    host.clear(serialport::ClearBuffer::All).unwrap();
    let deadline = Instant::now() + Duration::from_secs(5);
    // What was on its way comes first, and may begin amid a packet.
    let is_answer = |status: [u8; STATUS_OF_PING]| status.starts_with(&HEADER) && status[4] == 1 && status[8] == 0;
    while !ping(host.as_mut(), 1).is_ok_and(is_answer) {
        assert!(Instant::now() < deadline);
    }
}
