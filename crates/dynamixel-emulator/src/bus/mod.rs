//! The bus: bytes in, bytes out, time in. Nothing here reads a clock or a port.

mod dispatch;

use crate::error::Error;
use crate::faults::{Connection, Faults};
use crate::packet::{MAX_ID, Parser};
use crate::plant::Plant;
use crate::servo::{PERIOD_S, Servo, ServoSettings, Surroundings};
use crate::units::BAUD_RATES;
use dispatch::Slot;

/// Start bit, eight data bits, stop bit.
const BITS_A_BYTE: f64 = 10.0;
/// A pause in a packet after which servos wait for the next header.
const GREATEST_PAUSE_S: f64 = 1.5e-3;
/// More than what sums of times are off by, and far less than a bit.
const ROUNDING_S: f64 = 1e-9;

/// Bytes that come to the host.
#[derive(Debug, Clone, PartialEq)]
pub struct Transmission {
    /// Bus time at which the last of them has arrived.
    pub at_s: f64,
    /// The bytes; a servo's packet, or what noise and collisions left of it.
    pub bytes: Vec<u8>,
}

/// Servos on a half-duplex wire, and what their shafts drive.
pub struct Bus {
    servos: Vec<Servo>,
    plant: Box<dyn Plant>,
    faults: Faults,
    parser: Parser,
    host_baud: u32,
    echo: bool,
    now_s: f64,
    /// Time that has passed without making up a whole control period.
    remainder_s: f64,
    /// When the wire is free again.
    wire_free_s: f64,
    /// When the last byte of the host arrived.
    heard_s: f64,
    torques: Vec<f64>,
}

impl Bus {
    /// Puts servos on a bus and powers them.
    ///
    /// # Errors
    /// When an ID is no servo's or two servos have the same (make that a fault), or when a setting is refused.
    pub fn new(servos: Vec<ServoSettings>, plant: Box<dyn Plant>) -> Result<Self, Error> {
        for (index, ServoSettings { id, .. }) in servos.iter().enumerate() {
            let wrong = |why| Err(Error::Id { index, id: *id, why });
            if *id > MAX_ID {
                return wrong("is above 252");
            }
            if servos[..index].iter().any(|other| other.id == *id) {
                return wrong("another servo has too");
            }
        }
        let mut servos = servos.iter().map(Servo::new).collect::<Result<Vec<_>, _>>()?;
        let faults = Faults::new(servos.len());
        let surroundings = Surroundings { supply_v: faults.supply_v, temperature_c: None };
        servos.iter_mut().enumerate().for_each(|(i, servo)| servo.settle(plant.shaft(i), surroundings));
        let host_baud = servos.first().map_or(57_600, Servo::baud_rate);
        Ok(Self {
            faults,
            torques: vec![0.0; servos.len()],
            servos,
            plant,
            parser: Parser::default(),
            host_baud,
            echo: false,
            now_s: 0.0,
            remainder_s: 0.0,
            wire_free_s: 0.0,
            heard_s: 0.0,
        })
    }

    /// Takes bytes that the host sends now, and says what comes back. Simulated time goes on to the moment at which the last byte is on
    /// the wire, since only then do servos know what they were told.
    pub fn receive(&mut self, bytes: &[u8]) -> Vec<Transmission> {
        if self.host_baud < BAUD_RATES[0] {
            return Vec::new();
        }
        let (arriving, late_s) = self.faults.hurt(bytes.to_vec(), self.faults.to_servos);
        let at_s = self.now_s + late_s;
        // What the host itself has sent is over by now; what is not are answers.
        self.faults.talked_over += u64::from(at_s + ROUNDING_S < self.wire_free_s);
        let starts_s = at_s.max(self.wire_free_s);
        let ends_s = starts_s + self.wire_s(bytes.len());
        if self.parser.is_amid() && starts_s - self.heard_s > GREATEST_PAUSE_S {
            self.parser.reset();
        }
        self.advance(ends_s - self.now_s);
        (self.wire_free_s, self.heard_s) = (ends_s, ends_s);
        let echoed = self.echo.then(|| Transmission { at_s: ends_s, bytes: bytes.to_vec() });
        let mut transmissions: Vec<_> = echoed.into_iter().collect();
        self.parser.push(&arriving);
        while let Some(heard) = self.parser.next_heard() {
            for slot in self.dispatch(&heard) {
                transmissions.extend(self.transmit(slot));
            }
        }
        transmissions
    }

    /// Lets time pass: controllers, motors and plant go on in whole control periods, what remains is carried over.
    pub fn advance(&mut self, dt_s: f64) {
        if dt_s <= 0.0 || !dt_s.is_finite() {
            return;
        }
        self.now_s += dt_s;
        self.remainder_s += dt_s;
        while self.remainder_s >= PERIOD_S {
            self.remainder_s -= PERIOD_S;
            self.step();
        }
    }

    /// When the last byte that anybody sends is over, in s.
    pub(crate) fn wire_free_s(&self) -> f64 {
        self.wire_free_s
    }

    /// Servos wait for the next header.
    pub(crate) fn pause(&mut self) {
        self.parser.reset();
    }

    /// Simulated time since the bus was made, in s.
    #[must_use]
    pub fn now_s(&self) -> f64 {
        self.now_s
    }

    /// The servo that has an ID; the first, where several have it.
    #[must_use]
    pub fn servo(&self, id: u8) -> Option<&Servo> {
        self.servos.iter().find(|servo| servo.id() == id)
    }

    /// All servos in the order given.
    #[must_use]
    pub fn servos(&self) -> &[Servo] {
        &self.servos
    }

    /// What the servos drive.
    #[must_use]
    pub fn plant(&self) -> &dyn Plant {
        self.plant.as_ref()
    }

    /// What is wrong with the bus.
    #[must_use]
    pub fn faults(&self) -> &Faults {
        &self.faults
    }

    /// What is to go wrong from now on.
    pub fn faults_mut(&mut self) -> &mut Faults {
        &mut self.faults
    }

    /// The baud rate of the host's port; servos at another hear noise and stay silent. Below the least rate of a servo no time passes
    /// either, which at 50 baud would be a minute a packet.
    pub fn set_host_baud(&mut self, baud: u32) {
        self.host_baud = baud;
    }

    /// Whether the host hears itself, as through an adapter that does not switch its receiver off.
    pub fn set_echo(&mut self, echo: bool) {
        self.echo = echo;
    }

    fn wire_s(&self, bytes: usize) -> f64 {
        bytes as f64 * BITS_A_BYTE / f64::from(self.host_baud)
    }

    fn step(&mut self) {
        let supply_v = self.faults.supply_v;
        for (i, (servo, faults)) in self.servos.iter_mut().zip(&mut self.faults.servos).enumerate() {
            servo.pretend(faults.model_number);
            let surroundings = Surroundings { supply_v, temperature_c: faults.temperature_c };
            let torque = if faults.connection == Connection::Unplugged {
                servo.stay_dark(self.plant.shaft(i));
                0.0
            } else {
                if let Some(error) = faults.hardware_error.take() {
                    servo.raise(error);
                }
                servo.control(self.plant.shaft(i), surroundings)
            };
            self.torques[i] = torque + faults.load_torque_n_m;
        }
        self.plant.step(&self.torques, PERIOD_S);
        for (i, servo) in self.servos.iter_mut().enumerate() {
            servo.look(self.plant.shaft(i));
        }
    }

    /// What several servos that speak at once make of their answers.
    fn on_the_wire(&mut self, answers: Vec<Vec<u8>>) -> Option<Vec<u8>> {
        answers.into_iter().reduce(|a, b| self.faults.collide(&a, &b))
    }

    /// Puts what servos say at one time on the wire.
    fn transmit(&mut self, slot: Slot) -> Option<Transmission> {
        let bytes = self.on_the_wire(slot.answers)?;
        let (arriving, late_s) = self.faults.hurt(bytes.clone(), self.faults.to_host);
        self.wire_free_s += slot.delay_s + self.wire_s(bytes.len());
        // What is late waits in the adapter, not on the wire.
        (!arriving.is_empty()).then_some(Transmission { at_s: self.wire_free_s + late_s, bytes: arriving })
    }
}
