//! What goes wrong on purpose. All chances are drawn from one seeded generator, so that a run can be repeated.

use crate::servo::HardwareError;

/// How often packets of one direction are hurt: chances from 0 to 1, each drawn for every packet of a servo, and for whatever the host
/// sends at once.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rates {
    /// Lost altogether.
    pub dropped: f64,
    /// Flipped in one to three bits.
    pub corrupted: f64,
    /// Cut off behind some byte.
    pub truncated: f64,
    /// Late by [`Rates::delay_s`].
    pub delayed: f64,
    /// How late.
    pub delay_s: f64,
}

impl Rates {
    /// One chance for each of lost, corrupted and truncated.
    #[must_use]
    pub fn all(chance: f64) -> Self {
        Self { dropped: chance, corrupted: chance, truncated: chance, ..Self::default() }
    }
}

/// How a servo hangs on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Connection {
    /// As it should.
    #[default]
    Whole,
    /// Powered and doing what it was told last, but neither hearing nor heard.
    NoData,
    /// Neither power nor data, as when a cable of the chain is pulled. When it is put back, the servo starts afresh.
    Unplugged,
}

/// What is wrong with one servo.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ServoFaults {
    /// The cable.
    pub connection: Connection,
    /// Torque on the shaft that the plant does not know of, in N m counter-clockwise.
    pub load_torque_n_m: f64,
    /// Its temperature in °C, whatever its losses make of it.
    pub temperature_c: Option<f64>,
    /// The model number that it gives instead of its own.
    pub model_number: Option<u16>,
    /// An ID that it listens and answers to instead of its own: another servo's, say.
    pub id: Option<u8>,
    /// A hardware error that it detects now; taken when it is.
    pub hardware_error: Option<HardwareError>,
}

/// All that is wrong with a bus.
#[derive(Debug, Clone)]
pub struct Faults {
    /// What happens to packets of the host.
    pub to_servos: Rates,
    /// What happens to packets of the servos.
    pub to_host: Rates,
    /// The supply in V.
    pub supply_v: f64,
    /// By servo, in the order given to [`crate::Bus::new`].
    pub servos: Vec<ServoFaults>,
    /// How often a packet has been hurt.
    pub hurt: u64,
    /// How often the host has begun to send before the last answer to it was over. On a real bus the two garble each other; here what
    /// the host says waits until the wire is free.
    pub talked_over: u64,
    random: fastrand::Rng,
}

/// The supply that ROBOTIS recommends.
const SUPPLY_V: f64 = 12.0;

impl Faults {
    pub(crate) fn new(servos: usize) -> Self {
        Self {
            to_servos: Rates::default(),
            to_host: Rates::default(),
            supply_v: SUPPLY_V,
            servos: vec![ServoFaults::default(); servos],
            hurt: 0,
            talked_over: 0,
            random: fastrand::Rng::with_seed(0),
        }
    }

    /// Starts the generator anew.
    pub fn seed(&mut self, seed: u64) {
        self.random.seed(seed);
    }

    /// What becomes of a packet, and how late it is.
    pub(crate) fn hurt(&mut self, mut bytes: Vec<u8>, rates: Rates) -> (Vec<u8>, f64) {
        let intact = bytes.clone();
        if self.happens(rates.dropped) {
            bytes.clear();
        }
        if self.happens(rates.truncated) {
            bytes.truncate(self.random.usize(..=bytes.len()).saturating_sub(1));
        }
        if self.happens(rates.corrupted) && !bytes.is_empty() {
            for _ in 0..self.random.usize(1..=3) {
                let bit = self.random.usize(..bytes.len() * 8);
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
        }
        let late_s = if self.happens(rates.delayed) { rates.delay_s } else { 0.0 };
        self.hurt += u64::from(bytes != intact || late_s > 0.0);
        (bytes, late_s)
    }

    /// Two packets at once: a zero of either wins, and the clocks of the servos are never in step.
    pub(crate) fn collide(&mut self, a: &[u8], b: &[u8]) -> Vec<u8> {
        let shift = self.random.u32(1..8);
        let skewed = |i: usize| {
            let (before, now) = (i.checked_sub(1).and_then(|i| b.get(i)), b.get(i));
            let (before, now) = (before.copied().unwrap_or(0xFF), now.copied().unwrap_or(0xFF));
            (now << shift) | (before >> (8 - shift))
        };
        (0..a.len().max(b.len())).map(|i| a.get(i).copied().unwrap_or(0xFF) & skewed(i)).collect()
    }

    /// No draw where nothing can happen, so that faults of one kind do not shift those of another.
    fn happens(&mut self, chance: f64) -> bool {
        chance > 0.0 && self.random.f64() < chance
    }
}
