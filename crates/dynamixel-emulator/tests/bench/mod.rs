//! A bus on free shafts, and a master that speaks to it without a port.
#![allow(clippy::unwrap_used, dead_code, missing_docs, unreachable_pub)]

use dynamixel_emulator::packet::{BROADCAST_ID, Heard, Packet, Parser, instruction};
use dynamixel_emulator::{Bus, FreeShafts, Item, Model, Servo, ServoSettings, item};

pub struct Bench(pub Bus);

impl Bench {
    /// Servos that answer without a delay.
    pub fn new(settings: Vec<ServoSettings>) -> Self {
        let shafts = FreeShafts::new(&settings.iter().map(|servo| servo.model).collect::<Vec<_>>());
        let settings = settings.into_iter().map(|servo| servo.with(item::RETURN_DELAY_TIME, 0)).collect();
        Self(Bus::new(settings, Box::new(shafts)).unwrap())
    }

    /// Large servos with these IDs.
    pub fn with_ids(ids: &[u8]) -> Self {
        Self::new(ids.iter().map(|id| ServoSettings::new(*id, Model::Xm540W270)).collect())
    }

    /// What is heard of the answers to a packet.
    pub fn send(&mut self, id: u8, instruction: u8, parameters: &[u8]) -> Vec<Heard> {
        heard(&self.0.receive(&Packet { id, instruction, parameters: parameters.to_vec() }.encode()))
    }

    /// The parameters of the one answer: the error field, and the data.
    pub fn ask(&mut self, id: u8, instruction: u8, parameters: &[u8]) -> Vec<u8> {
        match self.send(id, instruction, parameters).as_slice() {
            [Heard::Packet(status)] if status.id == id => status.parameters.clone(),
            other => panic!("{other:?} in answer to {instruction:#x}"),
        }
    }

    /// Writes an item, and gives the error field.
    pub fn try_write(&mut self, id: u8, item: Item, value: i32) -> u8 {
        self.ask(id, instruction::WRITE, &write(item, value))[0]
    }

    pub fn write(&mut self, id: u8, item: Item, value: i32) {
        assert_eq!(self.try_write(id, item, value), 0, "{item:?} = {value}");
    }

    pub fn servo(&self, id: u8) -> &Servo {
        self.0.servo(id).unwrap()
    }

    pub fn item(&self, id: u8, item: Item) -> i32 {
        self.servo(id).item(item)
    }

    /// The IDs that answer a broadcast ping.
    pub fn scan(&mut self) -> Vec<u8> {
        let id = |heard| match heard {
            Heard::Packet(status) => status.id,
            broken => panic!("{broken:?}"),
        };
        self.send(BROADCAST_ID, instruction::PING, &[]).into_iter().map(id).collect()
    }
}

/// The parameters of a write.
pub fn write(item: Item, value: i32) -> Vec<u8> {
    [&item.address.to_le_bytes()[..], &value.to_le_bytes()[..usize::from(item.size)]].concat()
}

pub fn heard(answers: &[dynamixel_emulator::Transmission]) -> Vec<Heard> {
    let mut parser = Parser::default();
    answers.iter().for_each(|answer| parser.push(&answer.bytes));
    std::iter::from_fn(|| parser.next_heard()).collect()
}
