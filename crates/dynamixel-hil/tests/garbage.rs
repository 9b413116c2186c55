//! Whatever comes back on the wire, the driver takes it for an answer only where it is one, and never falls over.
//!
//! A sample of `cargo xtask soak fuzz-driver SECONDS`.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::os::fd::AsFd;
use std::time::{Duration, Instant};

use dynamixel_hil::emulator::packet::crc16;
use dynamixel_hil::register::{PRESENT_POSITION, PRESENT_TEMPERATURE};
use dynamixel_hil::{Bus, HilError};
use nix::pty::openpty;
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};

/// Seconds, where nobody asks for more.
const SECONDS: u64 = 4;

/// Bytes that look more or less like a status packet of servo 1.
fn garbage(random: &mut fastrand::Rng) -> Vec<u8> {
    let length = random.usize(..24);
    let mut parameters: Vec<u8> = (0..length).map(|_| random.u8(..)).collect();
    if random.bool() {
        parameters.iter_mut().for_each(|byte| *byte = [0xFF, 0xFD, 0x00, 0x55][usize::from(*byte % 4)]);
    }
    let stated = if random.u8(..4) == 0 { random.u16(..) } else { length as u16 + 3 + random.u16(..3) };
    let id = [1, 1, 1, 0xFE, random.u8(..)][random.usize(..5)];
    let mut packet = vec![0xFF, 0xFF, 0xFD, 0x00, id];
    packet.extend(stated.to_le_bytes());
    packet.push(if random.u8(..4) == 0 { random.u8(..) } else { 0x55 });
    packet.extend(parameters);
    if random.bool() {
        let sum = crc16(0, &packet);
        packet.extend(sum.to_le_bytes());
    }
    if random.u8(..4) == 0 {
        packet.truncate(random.usize(..=packet.len()));
    }
    packet
}

#[test]
fn garbage_is_no_answer() {
    let pty = openpty(None, None).unwrap();
    let mut settings = tcgetattr(&pty.slave).unwrap();
    cfmakeraw(&mut settings);
    tcsetattr(&pty.slave, SetArg::TCSANOW, &settings).unwrap();
    let path = nix::unistd::ttyname(pty.slave.as_fd()).unwrap().display().to_string();
    let mut master = std::fs::File::from(pty.master);
    std::thread::spawn(move || {
        let (mut random, mut asked) = (fastrand::Rng::with_seed(11), [0; 256]);
        while master.read(&mut asked).is_ok_and(|count| count > 0) {
            let packets = random.usize(..3);
            for _ in 0..=packets {
                if master.write_all(&garbage(&mut random)).is_err() {
                    return;
                }
            }
        }
    });
    let mut bus = Bus::open(&path, 1_000_000, 0.5, BTreeMap::new()).unwrap();
    let group = loop {
        // Garbage may pass for answers to a group, too.
        if let Ok(group) = bus.group_read(&[1, 2], PRESENT_POSITION.address, 4) {
            break group;
        }
    };
    let seconds = std::env::var("REORDER_SOAK_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(SECONDS);
    let until = Instant::now() + Duration::from_secs(seconds);
    let mut asked = 0;
    while Instant::now() < until {
        asked += 1;
        let failed = [
            bus.group_get(&group).err(),
            bus.ping(1).err(),
            bus.read(1, PRESENT_TEMPERATURE).err(),
            bus.write(1, PRESENT_POSITION, 7).err(),
            bus.bulk_read(&[(1, PRESENT_POSITION), (2, PRESENT_TEMPERATURE)]).err(),
            bus.scan().err(),
        ];
        for why in failed.into_iter().flatten() {
            assert!(!matches!(why, HilError::PortLost { .. }), "what the SDK trips over is no lost port: {why}");
        }
    }
    println!("{asked} rounds, {:?}", bus.counters());
    assert!(bus.counters().corrupt > 0);
}
