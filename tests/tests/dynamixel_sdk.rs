//! ROBOTIS's own SDK as a master of the emulated bus, and as a judge of its packets.
#![allow(clippy::unwrap_used, missing_docs)]

#[path = "../../crates/dynamixel-emulator/tests/suite/mod.rs"]
mod suite;

use dynamixel_emulator::packet::{Packet, instruction};
use end_to_end::root;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use suite::{Answer, Failure, Master};

/// The SDK's result code for an answer that did not come.
const COMM_RX_TIMEOUT: i64 = -3001;

/// The SDK in a Python process.
struct Robotis {
    process: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Robotis {
    fn start(arguments: &[&str]) -> Self {
        let mut python = Command::new(root().join(".deps/venv/bin/python"));
        python.arg("tests/peers/dynamixel_master.py").args(arguments).current_dir(root());
        let mut process = python.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (to, from) = (process.stdin.take().unwrap(), BufReader::new(process.stdout.take().unwrap()));
        Self { process, to, from }
    }

    fn open(path: &Path, baud: u32) -> Self {
        Self::start(&[path.to_str().unwrap(), &baud.to_string()])
    }

    fn call(&mut self, call: &Value) -> Result<Value, Failure> {
        writeln!(self.to, "{call}").unwrap();
        let mut line = String::new();
        self.from.read_line(&mut line).unwrap();
        let answer: Value = serde_json::from_str(&line).unwrap_or_else(|error| panic!("{call}: {line:?}: {error}"));
        if let Some(number) = answer["refused"].as_u64() {
            return Err(Failure::Refused(number as u8));
        }
        match answer["failed"].as_i64() {
            None => Ok(answer["value"].clone()),
            Some(COMM_RX_TIMEOUT) => Err(Failure::Silent),
            Some(code) => Err(Failure::Other(code.to_string())),
        }
    }

    fn value<T: serde::de::DeserializeOwned>(&mut self, call: &Value) -> Answer<T> {
        Some(self.call(call).map(|value| serde_json::from_value(value).unwrap()))
    }
}

impl Drop for Robotis {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Master for Robotis {
    fn ping(&mut self, id: u8) -> Answer<u16> {
        self.value(&json!(["ping", id]))
    }

    fn read(&mut self, id: u8, address: u16, length: u16) -> Answer<Vec<u8>> {
        self.value(&json!(["read", id, address, length]))
    }

    fn write(&mut self, id: u8, address: u16, data: &[u8]) -> Answer<()> {
        self.value(&json!(["write", id, address, data]))
    }

    fn sync_read(&mut self, ids: &[u8], address: u16, length: u16) -> Answer<Vec<Vec<u8>>> {
        self.value(&json!(["sync_read", ids, address, length]))
    }

    fn sync_write(&mut self, address: u16, data: &[(u8, Vec<u8>)]) -> Answer<()> {
        self.value(&json!(["sync_write", address, data]))
    }

    fn reboot(&mut self, id: u8) -> Answer<()> {
        self.value(&json!(["reboot", id]))
    }

    fn factory_reset_but_id_and_baud(&mut self, id: u8) -> Answer<()> {
        self.value(&json!(["factory_reset_but_id_and_baud", id]))
    }

    fn scan(&mut self) -> Answer<Vec<u8>> {
        self.value(&json!(["scan"]))
    }

    fn reg_write(&mut self, id: u8, address: u16, data: &[u8]) -> Answer<()> {
        self.value(&json!(["reg_write", id, address, data]))
    }

    fn action(&mut self, id: u8) -> Answer<()> {
        self.value(&json!(["action", id]))
    }

    fn clear(&mut self, id: u8) -> Answer<()> {
        self.value(&json!(["clear", id]))
    }

    // Its `txPacket` (4.1.0) drops what its `addStuffing` returns, so that nothing is stuffed that it sends. A servo goes by length and
    // CRC, and minds only where it takes out what was never put in.
    fn stuffs(&self, data: &[u8]) -> bool {
        !data.windows(4).any(|four| four == [0xFF, 0xFF, 0xFD, 0xFD])
    }

    fn fast_sync_read(&mut self, ids: &[u8], address: u16, length: u16) -> Answer<Vec<Vec<u8>>> {
        self.value(&json!(["fast_sync_read", ids, address, length]))
    }

    fn bulk_read(&mut self, reads: &[(u8, u16, u16)]) -> Answer<Vec<Vec<u8>>> {
        self.value(&json!(["bulk_read", reads]))
    }

    fn fast_bulk_read(&mut self, reads: &[(u8, u16, u16)]) -> Answer<Vec<Vec<u8>>> {
        self.value(&json!(["fast_bulk_read", reads]))
    }

    fn bulk_write(&mut self, writes: &[(u8, u16, Vec<u8>)]) -> Answer<()> {
        self.value(&json!(["bulk_write", writes]))
    }
}

#[test]
fn the_sdk_passes_the_suite() {
    assert_eq!(suite::run(Robotis::open), [""; 0], "the SDK has every call");
}

#[test]
fn ten_thousand_packets_are_those_of_the_sdk() {
    let (mut sdk, mut random) = (Robotis::start(&[]), fastrand::Rng::with_seed(3));
    let instructions = [instruction::WRITE, instruction::SYNC_WRITE, instruction::BULK_READ, instruction::CLEAR];
    for _ in 0..20 {
        let packets: Vec<_> = (0..500)
            .map(|_| Packet {
                id: random.u8(..=252),
                instruction: random.choice(instructions).unwrap(),
                parameters: suite::parameters(&mut random, 0),
            })
            .collect();
        let asked: Vec<_> = packets.iter().map(|p| json!([p.id, p.instruction, p.parameters])).collect();
        let theirs: Vec<String> = sdk.value(&json!(["encode", asked])).unwrap().unwrap();
        assert_eq!(theirs.len(), packets.len());
        for (packet, theirs) in packets.iter().zip(theirs) {
            let ours: String = packet.encode().iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!(theirs, ours, "{packet:?}");
        }
    }
}
