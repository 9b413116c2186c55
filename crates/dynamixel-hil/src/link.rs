//! The open bus of an arm, and what is said on it in every step.

use std::collections::BTreeMap;

use crate::bring_up::{clear_errors, identify, set_up};
use crate::bus::{Bus, GroupRead, GroupWrite};
use crate::config::Config;
use crate::error::{HilError, Result};
use crate::register::{FIRST_INDIRECT_DATA, GOAL_POSITION, TORQUE_ENABLE};
use crate::servo_state::ServoState;

/// How often the torques are switched on, where the packet is lost.
const TRIES: usize = 50;

/// A bus whose servos are those of a configuration, and set up.
pub(crate) struct Link {
    pub(crate) bus: Bus,
    read: GroupRead,
    write: GroupWrite,
    /// What every servo told last, in the order of the configuration.
    pub(crate) states: Vec<ServoState>,
    /// How long goals and the question take on the wire, in s: then servos look where they are.
    pub(crate) asks_after_s: f64,
    /// The raw positions that each servo takes as goals, least and most.
    pub(crate) ranges: Vec<[i32; 2]>,
}

impl Link {
    pub(crate) fn open(config: &Config, port: &str) -> Result<Self> {
        let names: BTreeMap<_, _> = config.servos.iter().map(|servo| (servo.id, servo.name.clone())).collect();
        let mut bus = Bus::open(port, config.baud, config.latency_ms, names)?;
        identify(&mut bus, config)?;
        let ranges = set_up(&mut bus, config)?;
        let ids = config.ids();
        let read = bus.group_read(&ids, FIRST_INDIRECT_DATA, ServoState::length())?;
        let write = bus.group_write(&ids, GOAL_POSITION)?;
        // Ten bits a byte; 14 bytes a packet, with an ID and four bytes of goal for each servo in the one, and an ID in the other.
        let asks_after_s = 10.0 * (2 * 14 + 6 * ids.len()) as f64 / f64::from(config.baud);
        Ok(Self { bus, read, write, states: vec![ServoState::default(); ids.len()], asks_after_s, ranges })
    }

    /// Sets the servos up again after a fault, on a port that is opened again where it was lost.
    pub(crate) fn mend(&mut self, config: &Config, port_is_lost: bool) -> Result<()> {
        if port_is_lost {
            let port = self.bus.port().to_owned();
            *self = Self::open(config, &port)?;
            return Ok(());
        }
        identify(&mut self.bus, config)?;
        clear_errors(&mut self.bus, config)?;
        self.ranges = set_up(&mut self.bus, config)?;
        Ok(())
    }

    /// Sends goals.
    pub(crate) fn send(&mut self, goals: &[u32]) -> Result<()> {
        self.bus.group_set(&self.write, goals)
    }

    /// Takes in what the servos tell.
    pub(crate) fn hear(&mut self) -> Result<()> {
        let answers = self.bus.group_get(&self.read)?;
        for (state, bytes) in self.states.iter_mut().zip(&answers) {
            state.update(bytes).ok_or(HilError::GroupMissed)?;
        }
        Ok(())
    }

    /// The same, as often as it takes.
    pub(crate) fn hear_surely(&mut self) -> Result<()> {
        for _ in 1..TRIES {
            match self.hear() {
                Err(HilError::GroupMissed) => {}
                heard => return heard,
            }
        }
        self.hear()
    }

    /// Switches all torques on.
    pub(crate) fn torques_on(&mut self, config: &Config) -> Result<()> {
        let ids = config.ids();
        let torque = self.bus.group_write(&ids, TORQUE_ENABLE)?;
        for _ in 0..TRIES {
            // Nobody answers a group's write: what they tell says whether it came.
            self.bus.group_set(&torque, &vec![1; ids.len()])?;
            if self.hear().is_ok() && self.states.iter().all(|state| state.torque) {
                return Ok(());
            }
        }
        let limp = self.states.iter().position(|state| !state.torque).unwrap_or_default();
        let servo = config.servos[limp].label();
        Err(HilError::Refused { servo, what: "to switch its torque on".into(), why: "it stays off" })
    }
}
