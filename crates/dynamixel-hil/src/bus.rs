//! A bus of servos, through ROBOTIS's SDK.

use std::collections::BTreeMap;
use std::time::Duration;

use crate::error::{HardwareErrors, HilError, Result, ServoName, refusal};
use crate::register::{HARDWARE_ERROR_STATUS, Register, TORQUE_ENABLE};
use crate::sdk::{Miss, Sdk, SyncRead, SyncWrite, load};

/// How often a read, or a write that may be repeated, is tried again. Where every fifth packet is lost each way, 13 tries all fail
/// once in 600 000 times.
const RETRIES: u32 = 12;
/// After a miss, an answer that comes late after all must not be taken for that to the next question.
const SETTLE: Duration = Duration::from_millis(10);
/// The bit of a status packet's error that tells of a hardware error; what was asked for is done all the same.
const ALERT: u8 = 0x80;

/// What happened on the bus so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Instructions sent, retries included.
    pub sent: u64,
    /// Instructions sent again.
    pub retries: u64,
    /// Instructions without an answer in time.
    pub timeouts: u64,
    /// Instructions whose answer was no whole packet.
    pub corrupt: u64,
}

/// An open bus. Every method blocks until the answer is there, or none can be.
pub struct Bus {
    sdk: Sdk,
    port: String,
    baud: u32,
    names: BTreeMap<u8, String>,
    counters: Counters,
}

/// Bytes that are read of several servos at once.
pub struct GroupRead(SyncRead);

/// A register that is written to several servos at once.
pub struct GroupWrite(SyncWrite);

impl Bus {
    /// Opens a serial port. `latency_ms` is how long its adapter may keep bytes to itself; `names` is how sentences call the servos.
    ///
    /// # Errors
    /// Where the SDK is not there, or the port cannot be opened at this rate.
    pub fn open(port: &str, baud: u32, latency_ms: f64, names: BTreeMap<u8, String>) -> Result<Self> {
        let module = load().map_err(|reason| HilError::NoSdk { reason })?;
        let sdk = Sdk::open(module, port, baud, latency_ms).map_err(|reason| HilError::Port {
            port: port.to_owned(),
            baud,
            reason,
        })?;
        Ok(Self { sdk, port: port.to_owned(), baud, names, counters: Counters::default() })
    }

    /// Lets a port go that is gone: as long as anybody has it open, the system gives an adapter that comes back another name.
    pub(crate) fn close(&self) {
        self.sdk.close();
    }

    /// What happened so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// The port's name.
    pub fn port(&self) -> &str {
        &self.port
    }

    /// As sentences name it.
    pub fn label(&self, id: u8) -> ServoName {
        ServoName { id, name: self.names.get(&id).cloned().unwrap_or_default() }
    }

    /// IDs of all servos that answer a broadcast.
    ///
    /// # Errors
    /// Where none does, or the port is gone.
    pub fn scan(&mut self) -> Result<Vec<u8>> {
        self.counters.sent += 1;
        match self.sdk.broadcast_ping() {
            Ok(ids) if !ids.is_empty() => Ok(ids),
            Err(Miss::Port(reason)) => Err(self.lost(reason)),
            Ok(_) | Err(_) => Err(self.all_silent()),
        }
    }

    /// The model number of a servo.
    ///
    /// # Errors
    /// Where it does not answer, or what it answers is always damaged.
    pub fn ping(&mut self, id: u8) -> Result<u16> {
        self.persist(id, |sdk| sdk.ping(id))
    }

    /// The value of a register.
    ///
    /// # Errors
    /// As [`Bus::ping`], and where the servo refuses.
    pub fn read(&mut self, id: u8, register: Register) -> Result<u32> {
        let (value, error) = self.persist(id, |sdk| sdk.read(id, register))?;
        self.accepted(id, error, || format!("to be asked for its {}", register.name))?;
        Ok(value)
    }

    /// Writes a register; twice, where the answer is lost.
    ///
    /// # Errors
    /// As [`Bus::read`].
    pub fn write(&mut self, id: u8, register: Register, value: u32) -> Result<()> {
        let error = self.persist(id, |sdk| sdk.write(id, register, value))?;
        self.accepted(id, error, || format!("{value} as its {}", register.name))
    }

    /// Writes bytes from an address on.
    pub(crate) fn write_bytes(&mut self, id: u8, address: u16, bytes: &[u8]) -> Result<()> {
        let error = self.persist(id, |sdk| sdk.write_bytes(id, address, bytes))?;
        self.accepted(id, error, || format!("{} bytes at address {address}", bytes.len()))
    }

    /// Switches the torque of a servo.
    ///
    /// # Errors
    /// As [`Bus::write`].
    pub fn set_torque(&mut self, id: u8, on: bool) -> Result<()> {
        self.write(id, TORQUE_ENABLE, on.into())
    }

    /// Has a servo start anew, which clears what it has latched. It then is away for some tenths of a second.
    ///
    /// # Errors
    /// As [`Bus::ping`].
    pub fn reboot(&mut self, id: u8) -> Result<()> {
        self.persist(id, |sdk| sdk.reboot(id)).map(drop)
    }

    /// What a servo has latched.
    ///
    /// # Errors
    /// As [`Bus::read`].
    pub fn hardware_errors(&mut self, id: u8) -> Result<HardwareErrors> {
        self.read(id, HARDWARE_ERROR_STATUS).map(|bits| HardwareErrors(bits as u8))
    }

    /// Some registers of some servos in one exchange, each of another servo.
    ///
    /// # Errors
    /// Where not all answer.
    pub fn bulk_read(&mut self, wanted: &[(u8, Register)]) -> Result<Vec<u32>> {
        for _ in 0..RETRIES {
            let answer = self.sdk.bulk_read(wanted);
            if let Some(values) = self.once(answer)? {
                return Ok(values);
            }
            self.again();
        }
        Err(HilError::GroupMissed)
    }

    /// Writes a register of each of some servos, in one packet that nobody answers.
    ///
    /// # Errors
    /// Where the port is gone.
    pub fn bulk_write(&mut self, values: &[(u8, Register, u32)]) -> Result<()> {
        let sent = self.sdk.bulk_write(values);
        self.once(sent).map(drop)
    }

    /// Prepares to read `length` bytes from `address` on of some servos at once; in one packet for all, where they all can do so.
    ///
    /// # Errors
    /// Where the port is gone.
    pub fn group_read(&mut self, ids: &[u8], address: u16, length: u16) -> Result<GroupRead> {
        // Firmware before version 45 does not answer the fast instruction.
        for attempt in 0..=RETRIES {
            let group = self.sdk.sync_read_group(ids, address, length, attempt < RETRIES);
            let group = group.map_err(|miss| self.lost(format!("{miss:?}")))?;
            if !group.fast || self.group_get(&GroupRead(group)).is_ok() {
                let fast = attempt < RETRIES;
                let group = self.sdk.sync_read_group(ids, address, length, fast);
                return group.map(GroupRead).map_err(|miss| self.lost(format!("{miss:?}")));
            }
        }
        Err(HilError::GroupMissed)
    }

    /// The bytes of each servo of a group, in its order. Tried once: who reads all the time waits for the next time.
    ///
    /// # Errors
    /// [`HilError::GroupMissed`] where not all answer, and where the port is gone.
    pub fn group_get(&mut self, group: &GroupRead) -> Result<Vec<Vec<u8>>> {
        let answer = self.sdk.sync_read(&group.0);
        self.once(answer)?.ok_or(HilError::GroupMissed)
    }

    /// Prepares to write a register of some servos at once.
    ///
    /// # Errors
    /// Where the port is gone.
    pub fn group_write(&mut self, ids: &[u8], register: Register) -> Result<GroupWrite> {
        self.sdk.sync_write_group(ids, register).map(GroupWrite).map_err(|miss| self.lost(format!("{miss:?}")))
    }

    /// Writes a value to each servo of a group, in its order. Nobody answers.
    ///
    /// # Errors
    /// Where the port is gone.
    pub fn group_set(&mut self, group: &GroupWrite, values: &[u32]) -> Result<()> {
        let sent = self.sdk.sync_write(&group.0, values);
        self.once(sent).map(drop)
    }

    /// Whether all answers of a group come in one packet.
    pub fn is_fast(group: &GroupRead) -> bool {
        group.0.fast
    }

    /// Asks a servo once whether it is there, which takes a few milliseconds at most.
    ///
    /// # Errors
    /// Where the port is gone.
    pub(crate) fn answers(&mut self, id: u8) -> Result<bool> {
        let answer = self.sdk.ping(id);
        Ok(self.once(answer)?.is_some())
    }

    /// Counts one exchange; nothing where it missed.
    fn once<T>(&mut self, answer: std::result::Result<T, Miss>) -> Result<Option<T>> {
        self.counters.sent += 1;
        match answer {
            Ok(value) => Ok(Some(value)),
            Err(Miss::Port(reason)) => Err(self.lost(reason)),
            Err(Miss::Timeout) => {
                self.counters.timeouts += 1;
                Ok(None)
            }
            Err(Miss::Corrupt) => {
                self.counters.corrupt += 1;
                Ok(None)
            }
        }
    }

    fn again(&mut self) {
        self.counters.retries += 1;
        std::thread::sleep(SETTLE);
    }

    /// Asks one servo until it answers, within bounds.
    fn persist<T>(&mut self, id: u8, ask: impl Fn(&Sdk) -> std::result::Result<T, Miss>) -> Result<T> {
        let corrupt_before = self.counters.corrupt;
        for attempt in 0..=RETRIES {
            if attempt > 0 {
                self.again();
            }
            let answer = ask(&self.sdk);
            if let Some(value) = self.once(answer)? {
                return Ok(value);
            }
        }
        let servo = self.label(id);
        let mostly_corrupt = 2 * (self.counters.corrupt - corrupt_before) > u64::from(RETRIES);
        Err(if mostly_corrupt { HilError::Garbled { servo } } else { HilError::Silent { servo } })
    }

    fn accepted(&self, id: u8, error: u8, what: impl Fn() -> String) -> Result<()> {
        match error & !ALERT {
            0 => Ok(()),
            code => Err(HilError::Refused { servo: self.label(id), what: what(), why: refusal(code) }),
        }
    }

    pub(crate) fn all_silent(&self) -> HilError {
        HilError::AllSilent { port: self.port.clone(), baud: self.baud }
    }

    fn lost(&self, reason: String) -> HilError {
        HilError::PortLost { port: self.port.clone(), reason }
    }
}
