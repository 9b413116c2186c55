//! Independent masters in Rust against the emulated bus: `dynamixel2` of Robohouse Delft and `rustypot` of Pollen Robotics.
#![allow(clippy::unwrap_used, missing_docs)]

mod suite;

use dynamixel_emulator::item;
use dynamixel_emulator::packet::{Packet, crc16, instruction};
use nix::pty::openpty;
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};
use rustypot::DynamixelProtocolHandler;
use serialport::SerialPort;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Duration;
use suite::{Answer, BAUD, Failure, Master};

/// A header behind one more FF.
const RUN: [u8; 4] = [0xFF, 0xFF, 0xFF, 0xFD];

struct Robohouse(dynamixel2::Bus<Vec<u8>, Vec<u8>>);

impl Robohouse {
    fn open(path: &Path, baud: u32) -> Self {
        Self(dynamixel2::Bus::open_with_buffers(path, baud, vec![0; 1024], vec![0; 1024]).unwrap())
    }
}

fn failure(error: dynamixel2::ReadError) -> Failure {
    match error {
        dynamixel2::ReadError::MotorError(error) => Failure::Refused(error.raw & 0x7F),
        dynamixel2::ReadError::Io(error) if error.kind() == std::io::ErrorKind::TimedOut => Failure::Silent,
        error => Failure::Other(error.to_string()),
    }
}

fn data<T>(answer: Result<dynamixel2::Response<T>, dynamixel2::TransferError>) -> Answer<T> {
    Some(answer.map(|response| response.data).map_err(|error| match error {
        dynamixel2::TransferError::ReadError(error) => failure(error),
        dynamixel2::TransferError::WriteError(error) => Failure::Other(error.to_string()),
    }))
}

fn written(result: Result<(), dynamixel2::WriteError>) -> Answer<()> {
    Some(result.map_err(|error| Failure::Other(error.to_string())))
}

impl Master for Robohouse {
    fn ping(&mut self, id: u8) -> Answer<u16> {
        data(self.0.ping(id)).map(|ping| ping.map(|ping| ping.model))
    }

    fn read(&mut self, id: u8, address: u16, length: u16) -> Answer<Vec<u8>> {
        data(self.0.read(id, address, length))
    }

    fn write(&mut self, id: u8, address: u16, bytes: &[u8]) -> Answer<()> {
        data(self.0.write(id, address, bytes))
    }

    fn sync_read(&mut self, ids: &[u8], address: u16, length: u16) -> Answer<Vec<Vec<u8>>> {
        let mut all = Ok(Vec::new());
        let each = |response: Result<dynamixel2::Response<&[u8]>, _>| match (response, &mut all) {
            (Ok(response), Ok(all)) => all.push(response.data.to_vec()),
            (Err(error), _) => all = Err(failure(error)),
            _ => {}
        };
        written(self.0.sync_read_cb(ids, address, length, each))?.ok().map(|()| all)
    }

    fn sync_write(&mut self, address: u16, data: &[(u8, Vec<u8>)]) -> Answer<()> {
        let data: Vec<_> = data
            .iter()
            .map(|(id, data)| dynamixel2::instructions::SyncWriteData { motor_id: *id, data: data.as_slice() })
            .collect();
        written(self.0.sync_write(address, data[0].data.len() as u16, &data))
    }

    fn reboot(&mut self, id: u8) -> Answer<()> {
        data(self.0.reboot(id))
    }

    fn factory_reset_but_id_and_baud(&mut self, id: u8) -> Answer<()> {
        data(self.0.factory_reset(id, dynamixel2::instructions::FactoryResetKind::KeepIdAndBaudRate))
    }

    fn scan(&mut self) -> Answer<Vec<u8>> {
        let found = self.0.scan().unwrap();
        Some(found.into_iter().map(|ping| ping.map(|ping| ping.motor_id).map_err(failure)).collect())
    }

    fn reg_write(&mut self, id: u8, address: u16, bytes: &[u8]) -> Answer<()> {
        data(self.0.reg_write(id, address, bytes))
    }

    fn action(&mut self, id: u8) -> Answer<()> {
        data(self.0.action(id))
    }

    fn clear(&mut self, id: u8) -> Answer<()> {
        data(self.0.clear_revolution_counter(id))
    }

    // It (0.9.1) misses the header in FF FF FF FD, where the manual and the SDK see one.
    fn stuffs(&self, data: &[u8]) -> bool {
        !data.windows(4).any(|four| four == RUN)
    }

    fn unstuffs(&self, data: &[u8]) -> bool {
        self.stuffs(data)
    }

    // Its bulk read (0.9.1) writes the entries of several servos over one another, so that only one can be read.

    fn bulk_write(&mut self, writes: &[(u8, u16, Vec<u8>)]) -> Answer<()> {
        let writes: Vec<_> = writes
            .iter()
            .map(|(id, address, data)| dynamixel2::instructions::BulkWriteData {
                motor_id: *id,
                address: *address,
                data: data.as_slice(),
            })
            .collect();
        written(self.0.bulk_write(&writes))
    }
}

struct Pollen {
    port: Box<dyn SerialPort>,
    handler: DynamixelProtocolHandler,
}

impl Pollen {
    fn open(path: &Path, baud: u32) -> Self {
        let port = serialport::new(path.to_str().unwrap(), baud).timeout(Duration::from_millis(300)).open().unwrap();
        Self { port, handler: DynamixelProtocolHandler::v2() }
    }
}

fn heard<T>(result: Result<T, Box<dyn std::error::Error>>) -> Result<T, Failure> {
    result.map_err(|error| match error.downcast_ref::<std::io::Error>().map(std::io::Error::kind) {
        Some(std::io::ErrorKind::TimedOut) => Failure::Silent,
        _ => Failure::Other(error.to_string()),
    })
}

fn accepted<T>(result: Result<(T, rustypot::StatusError), Box<dyn std::error::Error>>) -> Answer<T> {
    Some(heard(result).and_then(|(data, error)| match error.v2_instruction_error() {
        0 => Ok(data),
        number => Err(Failure::Refused(number)),
    }))
}

impl Master for Pollen {
    fn knows_models(&self) -> bool {
        false
    }

    fn ping(&mut self, id: u8) -> Answer<u16> {
        let found = self.handler.ping(self.port.as_mut(), id);
        Some(heard(found).and_then(|found| if found { Ok(0) } else { Err(Failure::Silent) }))
    }

    fn read(&mut self, id: u8, address: u16, length: u16) -> Answer<Vec<u8>> {
        accepted(self.handler.read_with_error(self.port.as_mut(), id, address as u8, length as u8))
    }

    fn write(&mut self, id: u8, address: u16, data: &[u8]) -> Answer<()> {
        let error = self.handler.write_with_error(self.port.as_mut(), id, address as u8, data);
        accepted(error.map(|error| ((), error)))
    }

    fn sync_read(&mut self, ids: &[u8], address: u16, length: u16) -> Answer<Vec<Vec<u8>>> {
        Some(heard(self.handler.sync_read(self.port.as_mut(), ids, address as u8, length as u8)))
    }

    fn sync_write(&mut self, address: u16, data: &[(u8, Vec<u8>)]) -> Answer<()> {
        let (ids, data): (Vec<u8>, Vec<Vec<u8>>) = data.iter().cloned().unzip();
        Some(heard(self.handler.sync_write(self.port.as_mut(), &ids, address as u8, &data)))
    }

    fn reboot(&mut self, id: u8) -> Answer<()> {
        let done = self.handler.reboot(self.port.as_mut(), id);
        Some(heard(done).and_then(|done| if done { Ok(()) } else { Err(Failure::Silent) }))
    }

    fn factory_reset_but_id_and_baud(&mut self, id: u8) -> Answer<()> {
        Some(heard(self.handler.factory_reset(self.port.as_mut(), id, false, true)))
    }

    fn scan(&mut self) -> Answer<Vec<u8>> {
        Some(heard(self.handler.broadcast_ping(self.port.as_mut())))
    }

    fn fast_sync_read(&mut self, ids: &[u8], address: u16, length: u16) -> Answer<Vec<Vec<u8>>> {
        Some(heard(self.handler.fast_sync_read(self.port.as_mut(), ids, address as u8, length as u8)))
    }
}

#[test]
fn dynamixel2_passes_the_suite() {
    assert_eq!(suite::run(Robohouse::open), ["fast sync read", "bulk read", "fast bulk read"]);
}

#[test]
fn rustypot_passes_the_suite() {
    let unknown = ["action", "bulk write", "bulk read", "fast bulk read", "clear"];
    assert_eq!(suite::run(Pollen::open), unknown);
}

#[test]
fn items_are_where_rustypot_has_them() {
    let theirs = rustypot::servo::dynamixel::xl430::DEFINITION.registers;
    let mut compared = 0;
    for register in theirs {
        let named = item::ALL.iter().find(|(name, _)| name.eq_ignore_ascii_case(register.name));
        if let Some((name, ours)) = named {
            assert_eq!((ours.address, ours.size), (register.addr.into(), register.size.into()), "{name}");
            compared += 1;
        }
    }
    // All but Present Load, which it calls by the name of the other models.
    assert_eq!(compared, item::ALL.len() - 1);
}

/// A port whose far end is read by the test.
fn listened_port() -> (File, PathBuf, std::os::fd::OwnedFd) {
    let pty = openpty(None, None).unwrap();
    let mut settings = tcgetattr(&pty.slave).unwrap();
    cfmakeraw(&mut settings);
    tcsetattr(&pty.slave, SetArg::TCSANOW, &settings).unwrap();
    let path = nix::unistd::ttyname(&pty.slave).unwrap();
    (File::from(pty.master), path, pty.slave)
}

fn assert_sent(listener: &mut File, expected: &Packet) {
    let expected = expected.encode();
    let mut sent = vec![0; expected.len()];
    listener.read_exact(&mut sent).unwrap();
    assert_eq!(sent, expected);
}

#[test]
fn ten_thousand_packets_are_those_of_dynamixel2() {
    let (mut listener, path, _slave) = listened_port();
    let (mut theirs, mut random) = (Robohouse::open(&path, BAUD), fastrand::Rng::with_seed(1));
    for _ in 0..10_000 {
        let instruction = random.choice([instruction::WRITE, instruction::SYNC_WRITE, instruction::BULK_READ]).unwrap();
        let mut packet = Packet { id: random.u8(..=252), instruction, parameters: suite::parameters(&mut random, 0) };
        while let Some(i) = packet.parameters.windows(4).position(|four| four == RUN) {
            packet.parameters[i] = 0;
        }
        let fill = |buffer: &mut [u8]| buffer.copy_from_slice(&packet.parameters);
        theirs.0.write_instruction(packet.id, packet.instruction, packet.parameters.len(), fill).unwrap();
        assert_sent(&mut listener, &packet);
        let bytes = packet.encode();
        assert_eq!(crc16(0, &bytes), dynamixel2::checksum::calculate_checksum(0, &bytes));
    }
}

#[test]
fn ten_thousand_packets_are_those_of_rustypot() {
    let (mut listener, path, _slave) = listened_port();
    let (mut theirs, mut random) = (Pollen::open(&path, BAUD), fastrand::Rng::with_seed(2));
    for _ in 0..10_000 {
        let (id, address, data) = (random.u8(..=252), random.u8(..), suite::parameters(&mut random, 1));
        theirs.handler.sync_write(theirs.port.as_mut(), &[id], address, std::slice::from_ref(&data)).unwrap();
        let head = [address, 0, data.len() as u8, 0, id];
        let parameters = [&head[..], &data].concat();
        assert_sent(&mut listener, &Packet { id: 0xFE, instruction: instruction::SYNC_WRITE, parameters });
    }
}
