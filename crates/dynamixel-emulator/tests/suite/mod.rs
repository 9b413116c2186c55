//! What every master must see of the emulated bus. One suite for all masters: those in Rust run it in this crate, the SDK in Python in
//! the crate of the tests that need more than Rust.
#![allow(clippy::unwrap_used, dead_code, missing_docs, unreachable_pub)]

use dynamixel_emulator::packet::{Packet, instruction};
use dynamixel_emulator::{Bus, EmulatedPort, FreeShafts, Item, Model, ServoSettings, Timing, item};
use std::path::Path;

pub const BAUD: u32 = 1_000_000;
const MODELS: [Model; 3] = [Model::Xm540W270, Model::Xm430W350, Model::Xl430W250];
const IDS: [u8; 3] = [1, 2, 3];

/// Why a master got no answer that it wanted.
#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// Nobody said anything.
    Silent,
    /// The error number of the status packet.
    Refused(u8),
    /// What the master makes of it otherwise.
    Other(String),
}

/// None where the master has no such call.
pub type Answer<T> = Option<Result<T, Failure>>;

/// A master's calls, as plain as they come.
pub trait Master {
    /// Whether its ping gives the model number; else that is 0.
    fn knows_models(&self) -> bool {
        true
    }
    fn ping(&mut self, id: u8) -> Answer<u16>;
    fn read(&mut self, id: u8, address: u16, length: u16) -> Answer<Vec<u8>>;
    fn write(&mut self, id: u8, address: u16, data: &[u8]) -> Answer<()>;
    fn sync_read(&mut self, ids: &[u8], address: u16, length: u16) -> Answer<Vec<Vec<u8>>>;
    fn sync_write(&mut self, address: u16, data: &[(u8, Vec<u8>)]) -> Answer<()>;
    fn reboot(&mut self, id: u8) -> Answer<()>;
    fn factory_reset_but_id_and_baud(&mut self, id: u8) -> Answer<()>;
    fn scan(&mut self) -> Answer<Vec<u8>>;
    /// Whether its stuffing is right for these bytes.
    fn stuffs(&self, _data: &[u8]) -> bool {
        true
    }
    /// Whether it takes the stuffing out of these bytes.
    fn unstuffs(&self, _data: &[u8]) -> bool {
        true
    }
    fn reg_write(&mut self, _id: u8, _address: u16, _data: &[u8]) -> Answer<()> {
        None
    }
    fn action(&mut self, _id: u8) -> Answer<()> {
        None
    }
    fn clear(&mut self, _id: u8) -> Answer<()> {
        None
    }
    fn fast_sync_read(&mut self, _ids: &[u8], _address: u16, _length: u16) -> Answer<Vec<Vec<u8>>> {
        None
    }
    fn bulk_read(&mut self, _reads: &[(u8, u16, u16)]) -> Answer<Vec<Vec<u8>>> {
        None
    }
    fn fast_bulk_read(&mut self, _reads: &[(u8, u16, u16)]) -> Answer<Vec<Vec<u8>>> {
        None
    }
    fn bulk_write(&mut self, _writes: &[(u8, u16, Vec<u8>)]) -> Answer<()> {
        None
    }
}

/// A master at a port, and what it could not do.
struct Suite<M> {
    port: EmulatedPort,
    master: M,
    unknown: Vec<&'static str>,
}

/// Runs the suite, and names the calls that the master does not have.
pub fn run<M: Master>(open: impl FnOnce(&Path, u32) -> M) -> Vec<&'static str> {
    let settings =
        |(id, model)| ServoSettings::new(id, model).with(item::BAUD_RATE, 3).with(item::RETURN_DELAY_TIME, 0);
    let servos = IDS.into_iter().zip(MODELS).map(settings).collect();
    let bus = Bus::new(servos, Box::new(FreeShafts::new(&MODELS))).unwrap();
    let port = EmulatedPort::open(bus, Timing::BusTime).unwrap();
    let master = open(port.path(), BAUD);
    let mut suite = Suite { port, master, unknown: Vec::new() };
    suite.finds_servos();
    suite.reads_and_writes();
    suite.gets_errors();
    suite.survives_stuffing();
    suite.registers_writes();
    suite.addresses_many();
    suite.resets();
    suite.unknown
}

impl<M: Master> Suite<M> {
    fn item(&self, id: u8, item: Item) -> i32 {
        self.port.with_bus(|bus| bus.servo(id).unwrap().item(item))
    }

    fn wait(&self, seconds: f64) {
        self.port.with_bus(|bus| bus.advance(seconds));
    }

    /// Notes what a master cannot do.
    fn known<T>(&mut self, name: &'static str, answer: Answer<T>) -> Option<Result<T, Failure>> {
        if answer.is_none() {
            self.unknown.push(name);
        }
        answer
    }

    fn finds_servos(&mut self) {
        for (id, model_number) in IDS.into_iter().zip([1120, 1020, 1060]) {
            let found = self.master.ping(id).unwrap().unwrap();
            assert_eq!(found, if self.master.knows_models() { model_number } else { 0 }, "servo {id}");
        }
        assert_eq!(self.master.ping(9), Some(Err(Failure::Silent)));
        assert_eq!(self.master.scan(), Some(Ok(IDS.to_vec())));
    }

    fn reads_and_writes(&mut self) {
        assert_eq!(self.master.read(1, 0, 2).unwrap(), Ok(vec![0x60, 0x04]));
        for value in [1, 0] {
            assert_eq!(self.master.write(2, 65, &[value]).unwrap(), Ok(()));
            assert_eq!(self.item(2, item::LED), i32::from(value));
        }
        assert_eq!(self.master.write(1, 116, &[0x39, 0x05, 0, 0]).unwrap(), Ok(()));
        assert_eq!(self.master.read(1, 116, 4).unwrap(), Ok(vec![0x39, 0x05, 0, 0]));
        // Torque that comes on takes the position as it is for the goal.
        assert_eq!(self.master.write(1, 64, &[1]).unwrap(), Ok(()));
        assert_eq!(self.master.read(1, 116, 4).unwrap(), Ok(vec![0, 8, 0, 0]));
        assert_eq!(self.master.write(1, 116, &[0x39, 0x05, 0, 0]).unwrap(), Ok(()));
        self.wait(2.0);
        let position = self.master.read(1, 132, 4).unwrap().unwrap();
        let position = i32::from_le_bytes(position.try_into().unwrap());
        assert!((position - 0x539).abs() <= 5, "{position}");
    }

    fn gets_errors(&mut self) {
        let refused = |number| Some(Err(Failure::Refused(number)));
        assert_eq!(self.master.write(1, 65, &[7]), refused(4), "out of range");
        assert_eq!(self.master.write(1, 116, &[0, 1]), refused(5), "too short");
        assert_eq!(self.master.write(1, 116, &[0, 16, 0, 0]), refused(6), "beyond the limit");
        assert_eq!(self.master.write(1, 132, &[0; 4]), refused(7), "read-only");
        assert_eq!(self.master.write(1, 9, &[1]), refused(7), "locked by the torque");
        assert_eq!(self.master.write(1, 64, &[0]).unwrap(), Ok(()));
        assert_eq!(self.master.write(1, 9, &[1]).unwrap(), Ok(()));
        assert_eq!(self.master.write(1, 9, &[0]).unwrap(), Ok(()));
    }

    /// Indirect data hold any bytes: headers, stuffed headers, headers to and fro.
    fn survives_stuffing(&mut self) {
        for data in [
            &[0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x01][..],
            &[0xFF, 0xFF, 0xFD, 0xFD, 0xFD],
            &[0xFF, 0xFF, 0xFF, 0xFD],
            &[0xFF, 0xFF, 0xFD, 0xFF, 0xFF, 0xFD],
        ] {
            if self.master.stuffs(data) {
                assert_eq!(self.master.write(2, 224, data).unwrap(), Ok(()));
            } else {
                let parameters = [&[224, 0], data].concat();
                let packet = Packet { id: 2, instruction: instruction::WRITE, parameters };
                self.port.with_bus(|bus| assert_eq!(bus.receive(&packet.encode()).len(), 1));
            }
            if self.master.unstuffs(data) {
                assert_eq!(self.master.read(2, 224, data.len() as u16).unwrap().as_deref(), Ok(data));
            }
        }
    }

    fn registers_writes(&mut self) {
        let answer = self.master.action(2);
        if self.known("action", answer) != Some(Err(Failure::Refused(2))) {
            assert!(self.unknown.contains(&"action"), "an action without a registered write");
            return;
        }
        assert_eq!(self.master.reg_write(2, 65, &[1]), Some(Ok(())));
        assert_eq!((self.item(2, item::LED), self.item(2, item::REGISTERED_INSTRUCTION)), (0, 1));
        assert_eq!(self.master.action(2), Some(Ok(())));
        assert_eq!((self.item(2, item::LED), self.item(2, item::REGISTERED_INSTRUCTION)), (1, 0));
    }

    fn addresses_many(&mut self) {
        let bytes = |value: i32| value.to_le_bytes().to_vec();
        let goals = IDS.map(|id| (id, bytes(2000 + i32::from(id))));
        let written = || goals.iter().map(|(_, data)| data.clone()).collect::<Vec<_>>();
        assert_eq!(self.master.sync_write(116, &goals), Some(Ok(())));
        assert_eq!(self.master.sync_read(&IDS, 116, 4), Some(Ok(written())));
        let answer = self.master.fast_sync_read(&IDS, 116, 4);
        assert!(self.known("fast sync read", answer).is_none_or(|goals| goals == Ok(written())));
        let writes = [(1, 116, bytes(1111)), (2, 65, vec![0]), (3, 112, bytes(77))];
        let answer = self.master.bulk_write(&writes);
        if self.known("bulk write", answer).is_some() {
            for (id, address, data) in writes {
                assert_eq!(self.master.read(id, address, data.len() as u16), Some(Ok(data)));
            }
        }
        // No address or length is an ID: the SDK (4.1.0) looks for IDs among all parameters of its fast bulk read.
        let reads = [(1, 0, 6), (2, 7, 1), (3, 48, 4)];
        let expected = || Ok(vec![vec![0x60, 0x04, 0, 0, 0, 0], vec![2], bytes(4095)]);
        let answer = self.master.bulk_read(&reads);
        assert!(self.known("bulk read", answer).is_none_or(|read| read == expected()));
        let answer = self.master.fast_bulk_read(&reads);
        assert!(self.known("fast bulk read", answer).is_none_or(|read| read == expected()));
    }

    fn resets(&mut self) {
        let answer = self.master.clear(1);
        assert!(self.known("clear", answer).is_none_or(|cleared| cleared == Ok(())));
        assert_eq!(self.master.write(3, 65, &[1]), Some(Ok(())));
        assert_eq!(self.master.write(3, 20, &[5, 0, 0, 0]), Some(Ok(())));
        assert_eq!(self.master.reboot(3), Some(Ok(())));
        assert_eq!(self.master.ping(3), Some(Err(Failure::Silent)), "while it boots");
        self.wait(0.5);
        assert!(self.master.ping(3).unwrap().is_ok());
        assert_eq!((self.item(3, item::LED), self.item(3, item::HOMING_OFFSET)), (0, 5), "RAM is reset, EEPROM is not");
        assert_eq!(self.master.factory_reset_but_id_and_baud(3), Some(Ok(())));
        self.wait(0.5);
        assert!(self.master.ping(3).unwrap().is_ok());
        assert_eq!((self.item(3, item::RETURN_DELAY_TIME), self.item(3, item::HOMING_OFFSET)), (250, 0));
    }
}

/// Parameters in which headers and halves of headers are common.
pub fn parameters(random: &mut fastrand::Rng, least: usize) -> Vec<u8> {
    let count = random.usize(least..120);
    let byte = |random: &mut fastrand::Rng| match random.u8(..4) {
        0 => 0xFD,
        1 | 2 => 0xFF,
        _ => random.u8(..),
    };
    (0..count).map(|_| byte(random)).collect()
}
