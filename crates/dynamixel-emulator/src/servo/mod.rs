//! One servo: what it remembers and how it starts.

mod control;
mod encoder;
mod goals;
mod instructions;
mod motor;
mod profile;
mod protection;

use crate::error::Error;
use crate::item::{self, Item};
use crate::memory::{Allowed, Memory, WATCHDOG_ERROR};
use crate::model::Model;
use crate::packet::Refusal;
use crate::plant::Shaft;
use crate::table::RAM;
use crate::units::{BAUD_RATES, CENTRE, RETURN_DELAY_S};
pub(crate) use control::PERIOD_S;
pub(crate) use instructions::Addressed;
use motor::{Motor, Overload};
use profile::Profile;
pub use protection::HardwareError;
pub(crate) use protection::Surroundings;

/// How long a servo is deaf after a reboot. Assumed; the e-manual has no figure.
pub(crate) const BOOT_S: f64 = 0.2;

/// A servo as it is put on the bus.
#[derive(Debug, Clone)]
pub struct ServoSettings {
    /// Its ID, 0 to 252.
    pub id: u8,
    /// Its model.
    pub model: Model,
    /// Items that somebody has set before, such as Baud Rate or Drive Mode; read-only ones such as Firmware Version too.
    pub items: Vec<(Item, i32)>,
}

impl ServoSettings {
    /// A servo as the factory sends it, but for the ID: 57,600 baud, 500 µs of return delay, position mode.
    #[must_use]
    pub fn new(id: u8, model: Model) -> Self {
        Self { id, model, items: Vec::new() }
    }

    /// Sets an item.
    #[must_use]
    pub fn with(mut self, item: Item, value: i32) -> Self {
        self.items.push((item, value));
        self
    }
}

/// A servo on the bus.
#[derive(Debug, Clone)]
pub struct Servo {
    model: Model,
    memory: Memory,
    backup: Option<Vec<u8>>,
    registered: Option<(usize, Vec<u8>)>,
    /// Deaf and without torque until then.
    booting_s: f64,
    is_shut_down: bool,
    /// Since the power came on, or the last reboot.
    clock_s: f64,
    silence_s: f64,
    shaft: Shaft,
    /// Whole turns that Present Position does not count, in pulses.
    forgotten_turns: i32,
    motor: Motor,
    overload: Overload,
    pwm: f64,
    integral: f64,
    profile: Profile,
    ramp: Ramp,
}

/// The velocity trajectory of velocity mode, in pulses/s.
#[derive(Debug, Clone, Copy, Default)]
struct Ramp {
    velocity: f64,
    acceleration: f64,
}

impl Servo {
    pub(crate) fn new(settings: &ServoSettings) -> Result<Self, Error> {
        let mut servo = Self {
            model: settings.model,
            memory: Memory::new(settings.model)?,
            backup: None,
            registered: None,
            booting_s: 0.0,
            is_shut_down: false,
            clock_s: 0.0,
            silence_s: 0.0,
            shaft: Shaft::default(),
            forgotten_turns: 0,
            motor: Motor::new(settings.model),
            overload: Overload::default(),
            pwm: 0.0,
            integral: 0.0,
            profile: Profile::at_rest(f64::from(CENTRE)),
            ramp: Ramp::default(),
        };
        for (item, value) in [(item::ID, i32::from(settings.id))].iter().chain(&settings.items) {
            let refused = |refusal| Error::Setting { id: settings.id, address: item.address, value: *value, refusal };
            servo.memory.preset(*item, *value).map_err(refused)?;
        }
        Ok(servo)
    }

    /// Takes the shaft as it is when the power comes on for the first time.
    pub(crate) fn settle(&mut self, shaft: Shaft, surroundings: Surroundings) {
        self.shaft = shaft;
        self.sense(surroundings);
        self.forget_turns();
        self.set_goals_aside();
        self.set_bounds(|_| true);
        self.publish();
    }

    /// The servo's model.
    #[must_use]
    pub fn model(&self) -> Model {
        self.model
    }

    /// Its ID at the moment.
    #[must_use]
    pub fn id(&self) -> u8 {
        self.item(item::ID) as u8
    }

    /// The value of an item, as a master would read it.
    #[must_use]
    pub fn item(&self, item: Item) -> i32 {
        self.memory.get(item)
    }

    /// Torque of the motor at the output shaft in N m.
    #[must_use]
    pub fn torque_n_m(&self) -> f64 {
        self.motor.torque_n_m()
    }

    /// Whether the motor is driven.
    #[must_use]
    pub fn has_torque(&self) -> bool {
        self.item(item::TORQUE_ENABLE) == 1
    }

    pub(crate) fn is_deaf(&self) -> bool {
        self.booting_s > 0.0
    }

    pub(crate) fn baud_rate(&self) -> u32 {
        BAUD_RATES.get(self.item(item::BAUD_RATE) as usize).copied().unwrap_or(BAUD_RATES[1])
    }

    pub(crate) fn return_delay_s(&self) -> f64 {
        f64::from(self.item(item::RETURN_DELAY_TIME)) * RETURN_DELAY_S
    }

    /// An instruction was heard, whomever it is for, which is all that the watchdog wants.
    pub(crate) fn hear(&mut self) {
        self.silence_s = 0.0;
    }

    /// Makes the servo say that it is another model than it is.
    pub(crate) fn pretend(&mut self, model_number: Option<u16>) {
        let own = self.memory.initial(item::MODEL_NUMBER);
        self.memory.set(item::MODEL_NUMBER, model_number.map_or(own, i32::from));
    }

    pub(crate) fn reboot(&mut self) {
        self.memory.set(item::TORQUE_ENABLE, 0);
        self.booting_s = BOOT_S;
    }

    /// Starts: RAM as Startup Configuration says, errors forgotten, position within a turn.
    fn start(&mut self) {
        let configuration = self.item(item::STARTUP_CONFIGURATION);
        let is_ram = |item: Item| item.address >= RAM;
        self.memory.reset(is_ram);
        self.memory.set(item::HARDWARE_ERROR_STATUS, 0);
        self.memory.set(item::REGISTERED_INSTRUCTION, 0);
        if let Some(backup) = self.backup.as_ref().filter(|_| configuration & 2 != 0) {
            self.memory.restore(backup, |item| is_ram(item) && instructions::is_backed_up(item));
        }
        self.memory.set(item::BACKUP_READY, i32::from(self.backup.is_some()));
        self.registered = None;
        self.is_shut_down = false;
        self.clock_s = 0.0;
        self.overload = Overload::default();
        self.forget_turns();
        self.set_goals_aside();
        self.set_bounds(|_| true);
        if configuration & 1 != 0 {
            self.memory.set(item::TORQUE_ENABLE, 1);
        }
    }

    /// Takes the shaft as it is, and what the items say of it.
    pub(crate) fn look(&mut self, shaft: Shaft) {
        self.shaft = shaft;
        self.publish();
    }

    fn has_watchdog_error(&self) -> bool {
        self.item(item::BUS_WATCHDOG) == WATCHDOG_ERROR
    }

    /// A master's write.
    pub(crate) fn write(&mut self, address: usize, data: &[u8], addressed: Addressed) -> Result<(), Refusal> {
        let allowed = self.check(address, data, addressed)?;
        self.apply(&allowed);
        Ok(())
    }

    fn check(&self, address: usize, data: &[u8], addressed: Addressed) -> Result<Allowed, Refusal> {
        let allowed = self.memory.check(address, data)?;
        if addressed == Addressed::Secondary && allowed.writes_eeprom() {
            return Err(Refusal::Access);
        }
        Ok(allowed)
    }

    /// A master's read.
    pub(crate) fn read(&self, address: usize, length: usize) -> Result<Vec<u8>, Refusal> {
        self.memory.read(address, length)
    }
}
