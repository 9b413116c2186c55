//! Who does what on a packet, and who answers when.

use super::Bus;
use crate::faults::Connection;
use crate::packet::{BROADCAST_ID, HEADER, Heard, MAX_ID, Packet, Refusal, crc16, instruction};
use crate::servo::{Addressed, Servo};

/// Servos of other rates than the host's by more than this hear noise: beyond it the tenth bit is sampled in its neighbour.
const BAUD_TOLERANCE: f64 = 0.04;

/// What servos say at one time; several answers at once collide.
pub(super) struct Slot {
    pub(super) delay_s: f64,
    pub(super) answers: Vec<Vec<u8>>,
}

/// One servo's part of a read that goes to several.
#[derive(Clone, Copy)]
struct Part {
    id: u8,
    address: usize,
    length: usize,
}

impl Bus {
    /// Executes what was heard; the slots follow one another on the wire.
    pub(super) fn dispatch(&mut self, heard: &Heard) -> Vec<Slot> {
        let packet = match heard {
            Heard::Packet(packet) => packet,
            Heard::WrongCrc { id } => return self.answer_wrong_crc(*id),
        };
        if packet.instruction == instruction::STATUS {
            return Vec::new();
        }
        self.listeners().for_each(|(_, servo)| servo.hear());
        match (packet.id, packet.instruction) {
            (BROADCAST_ID, instruction::PING) => self.broadcast_ping(packet),
            (BROADCAST_ID, instruction::SYNC_READ) => {
                self.read_many(sync_parts(&packet.parameters), packet.instruction)
            }
            (BROADCAST_ID, instruction::BULK_READ) => {
                self.read_many(bulk_parts(&packet.parameters), packet.instruction)
            }
            (BROADCAST_ID, instruction::FAST_SYNC_READ) => self.read_fast(&sync_parts(&packet.parameters)),
            (BROADCAST_ID, instruction::FAST_BULK_READ) => self.read_fast(&bulk_parts(&packet.parameters)),
            (BROADCAST_ID, instruction::SYNC_WRITE) => self.write_many(sync_writes(&packet.parameters)),
            (BROADCAST_ID, instruction::BULK_WRITE) => self.write_many(bulk_writes(&packet.parameters)),
            (BROADCAST_ID, _) => {
                self.listeners().for_each(|(_, servo)| drop(servo.execute(packet, Addressed::All)));
                Vec::new()
            }
            _ => self.execute(packet),
        }
    }

    /// Servos that hear the host, with the ID that they go by.
    fn listeners(&mut self) -> impl Iterator<Item = (u8, &mut Servo)> {
        let host_baud = f64::from(self.host_baud);
        let hears = move |servo: &Servo| {
            !servo.is_deaf() && (f64::from(servo.baud_rate()) / host_baud - 1.0).abs() < BAUD_TOLERANCE
        };
        let with_faults = self.servos.iter_mut().zip(&self.faults.servos);
        let heard = with_faults.filter(move |(servo, f)| f.connection == Connection::Whole && hears(servo));
        heard.map(|(servo, faults)| (faults.id.unwrap_or_else(|| servo.id()), servo))
    }

    fn execute(&mut self, packet: &Packet) -> Vec<Slot> {
        let mut slot = Slot { delay_s: f64::INFINITY, answers: Vec::new() };
        for (id, servo) in self.listeners() {
            let Some(addressed) = addressed(id, servo, packet.id) else { continue };
            if addressed == Addressed::Own {
                // The answer comes from who it was before, after the delay that it had before.
                let delay_s = servo.return_delay_s();
                let answers = servo.answers(packet.instruction);
                let result = servo.execute(packet, addressed);
                if answers {
                    slot.delay_s = slot.delay_s.min(delay_s);
                    slot.answers.push(servo.status(id, result).encode());
                }
            } else {
                drop(servo.execute(packet, addressed));
            }
        }
        vec![slot]
    }

    fn answer_wrong_crc(&mut self, wrong_id: u8) -> Vec<Slot> {
        let mut slots = Vec::new();
        for (id, servo) in self.listeners().filter(|(id, _)| *id == wrong_id) {
            if servo.answers(instruction::WRITE) {
                let answer = servo.status(id, Err(Refusal::Crc)).encode();
                slots.push(Slot { delay_s: servo.return_delay_s(), answers: vec![answer] });
            }
        }
        slots
    }

    /// All servos answer in the order of their IDs.
    fn broadcast_ping(&mut self, packet: &Packet) -> Vec<Slot> {
        let mut ids: Vec<_> = self.listeners().map(|(id, _)| id).collect();
        ids.sort_unstable();
        ids.dedup();
        ids.into_iter().flat_map(|id| self.execute(&Packet { id, ..packet.clone() })).collect()
    }

    /// Every servo answers when it has heard the one before it; behind one that is missing all are silent.
    fn read_many(&mut self, parts: Vec<Part>, instruction: u8) -> Vec<Slot> {
        let mut slots = Vec::new();
        for Part { id, address, length } in parts {
            let mut slot = Slot { delay_s: f64::INFINITY, answers: Vec::new() };
            for (_, servo) in self.listeners().filter(|(own, servo)| *own == id && servo.answers(instruction)) {
                slot.delay_s = slot.delay_s.min(servo.return_delay_s());
                slot.answers.push(servo.status(id, servo.read(address, length)).encode());
            }
            if slot.answers.is_empty() {
                break;
            }
            slots.push(slot);
        }
        slots
    }

    /// One status packet that all servos write on, each with the CRC of all before it. Nothing is stuffed. What a servo cannot read
    /// are zeros with the error. Behind one that is missing, or two that collide, all are silent.
    fn read_fast(&mut self, parts: &[Part]) -> Vec<Slot> {
        let length = 1 + parts.iter().map(|part| part.length + 4).sum::<usize>();
        let Ok(length) = u16::try_from(length) else { return Vec::new() };
        // The first servo writes the header too.
        let mut head = [&HEADER[..], &[BROADCAST_ID], &length.to_le_bytes(), &[instruction::STATUS]].concat();
        let (mut bytes, mut delay_s) = (Vec::new(), None);
        for Part { id, address, length } in parts {
            let mut answers = Vec::new();
            for (_, servo) in self.listeners().filter(|(own, _)| own == id) {
                if servo.knows_fast_reads() && servo.answers(instruction::FAST_SYNC_READ) {
                    delay_s.get_or_insert(servo.return_delay_s());
                    let data = servo.read(*address, *length);
                    let mut answer = head.clone();
                    answer.extend([servo.error_field(data.as_ref().err().copied()), *id]);
                    answer.extend(data.unwrap_or_else(|_| vec![0; *length]));
                    let crc = crc16(crc16(0, &bytes), &answer);
                    answer.extend_from_slice(&crc.to_le_bytes());
                    answers.push(answer);
                }
            }
            let is_alone = answers.len() == 1;
            bytes.extend(self.on_the_wire(answers).unwrap_or_default());
            if !is_alone {
                break;
            }
            head.clear();
        }
        delay_s.map(|delay_s| Slot { delay_s, answers: vec![bytes] }).into_iter().collect()
    }

    fn write_many(&mut self, writes: Vec<(u8, usize, &[u8])>) -> Vec<Slot> {
        for (id, address, data) in writes {
            for (own, servo) in self.listeners() {
                if let Some(addressed) = addressed(own, servo, id) {
                    let _ = servo.write(address, data, addressed);
                }
            }
        }
        Vec::new()
    }
}

/// By which of its names a servo that goes by `own` is called; what is above 252 is nobody's name, such as the factory's secondary ID.
fn addressed(own: u8, servo: &Servo, id: u8) -> Option<Addressed> {
    if id > MAX_ID {
        return None;
    }
    let is_secondary = i32::from(id) == servo.item(crate::item::SECONDARY_ID);
    if id == own { Some(Addressed::Own) } else { is_secondary.then_some(Addressed::Secondary) }
}

fn word(bytes: &[u8]) -> usize {
    usize::from(u16::from_le_bytes([bytes[0], bytes[1]]))
}

/// The first two words of a sync instruction, and the rest.
fn address_and_length(parameters: &[u8]) -> Option<(usize, usize, &[u8])> {
    let (head, rest) = parameters.split_at_checked(4)?;
    Some((word(&head[..2]), word(&head[2..]), rest))
}

fn sync_parts(parameters: &[u8]) -> Vec<Part> {
    let Some((address, length, ids)) = address_and_length(parameters) else { return Vec::new() };
    ids.iter().map(|id| Part { id: *id, address, length }).collect()
}

fn bulk_parts(parameters: &[u8]) -> Vec<Part> {
    let parts = parameters.chunks_exact(5);
    parts.map(|part| Part { id: part[0], address: word(&part[1..3]), length: word(&part[3..5]) }).collect()
}

fn sync_writes(parameters: &[u8]) -> Vec<(u8, usize, &[u8])> {
    let Some((address, length, data)) = address_and_length(parameters) else { return Vec::new() };
    data.chunks_exact(length + 1).map(|part| (part[0], address, &part[1..])).collect()
}

fn bulk_writes(mut parameters: &[u8]) -> Vec<(u8, usize, &[u8])> {
    let mut writes = Vec::new();
    while let Some((head, rest)) = parameters.split_at_checked(5) {
        let Some((data, rest)) = rest.split_at_checked(word(&head[3..5])) else { break };
        writes.push((head[0], word(&head[1..3]), data));
        parameters = rest;
    }
    writes
}
