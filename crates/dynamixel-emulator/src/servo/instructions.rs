//! What a servo does on an instruction that is for it alone or for all.

use super::Servo;
use super::goals::is_tuning;
use crate::item::{self, Item};
use crate::packet::{Packet, Refusal, instruction};
use crate::table::RAM;

/// By which name a servo was called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Addressed {
    /// Its ID.
    Own,
    /// Its secondary ID: it obeys, but for the EEPROM, and does not answer.
    Secondary,
    /// The broadcast ID.
    All,
}

/// First parameters that guard against doing it by accident.
const CLEAR_MULTI_TURN: [u8; 5] = [0x01, 0x44, 0x58, 0x4C, 0x22];
const BACKUP: [u8; 5] = [0x01, 0x43, 0x54, 0x52, 0x4C];
const RESTORE: [u8; 5] = [0x02, 0x43, 0x54, 0x52, 0x4C];

/// Firmware from which the servo knows Control Table Backup and the fast reads.
const WITH_FAST_READS: i32 = 45;

/// Whether an item is part of a backup.
pub(super) fn is_backed_up(item: Item) -> bool {
    let is_indirect_address = (168..224).contains(&item.address) || (578..634).contains(&item.address);
    item.address < RAM || is_tuning(item) || is_indirect_address
}

impl Servo {
    /// Executes an instruction; what it gives are the parameters of the status packet.
    pub(crate) fn execute(&mut self, packet: &Packet, addressed: Addressed) -> Result<Vec<u8>, Refusal> {
        let parameters = packet.parameters.as_slice();
        match packet.instruction {
            instruction::PING => {
                let [low, high, ..] = self.item(item::MODEL_NUMBER).to_le_bytes();
                return Ok(vec![low, high, self.item(item::FIRMWARE_VERSION) as u8]);
            }
            instruction::READ => {
                let [a, b, c, d] = *parameters else { return Err(Refusal::DataLength) };
                return self.read(word(a, b), word(c, d));
            }
            instruction::WRITE => {
                let (address, data) = address_and_data(parameters)?;
                self.write(address, data, addressed)?;
            }
            instruction::REG_WRITE => {
                let (address, data) = address_and_data(parameters)?;
                self.check(address, data, addressed)?;
                self.registered = Some((address, data.to_vec()));
                self.memory.set(item::REGISTERED_INSTRUCTION, 1);
            }
            instruction::ACTION => {
                let (address, data) = self.registered.take().ok_or(Refusal::Instruction)?;
                self.memory.set(item::REGISTERED_INSTRUCTION, 0);
                self.write(address, &data, addressed)?;
            }
            instruction::FACTORY_RESET => self.factory_reset(parameters, addressed)?,
            instruction::REBOOT => self.reboot(),
            instruction::CLEAR => self.clear(parameters)?,
            instruction::CONTROL_TABLE_BACKUP if self.knows_fast_reads() => self.back_up(parameters, addressed)?,
            _ => return Err(Refusal::Instruction),
        }
        Ok(Vec::new())
    }

    /// Whether Status Return Level wants an answer.
    pub(crate) fn answers(&self, to: u8) -> bool {
        let least = match to {
            instruction::PING => 0,
            instruction::READ
            | instruction::SYNC_READ
            | instruction::BULK_READ
            | instruction::FAST_SYNC_READ
            | instruction::FAST_BULK_READ => 1,
            _ => 2,
        };
        self.item(item::STATUS_RETURN_LEVEL) >= least
    }

    /// The error field: the refusal, and the alert bit while a hardware error is latched.
    pub(crate) fn error_field(&self, refusal: Option<Refusal>) -> u8 {
        let alert = if self.item(item::HARDWARE_ERROR_STATUS) == 0 { 0 } else { 0x80 };
        alert | refusal.map_or(0, |refusal| refusal as u8)
    }

    /// The status packet for what an instruction gave.
    pub(crate) fn status(&self, id: u8, result: Result<Vec<u8>, Refusal>) -> Packet {
        let mut parameters = vec![self.error_field(result.as_ref().err().copied())];
        parameters.extend(result.unwrap_or_default());
        Packet { id, instruction: instruction::STATUS, parameters }
    }

    pub(crate) fn knows_fast_reads(&self) -> bool {
        self.item(item::FIRMWARE_VERSION) >= WITH_FAST_READS
    }

    fn factory_reset(&mut self, parameters: &[u8], addressed: Addressed) -> Result<(), Refusal> {
        let kept: &[Item] = match parameters {
            _ if addressed == Addressed::Secondary => return Err(Refusal::Access),
            [0xFF] if addressed == Addressed::All => return Err(Refusal::Instruction),
            [0xFF] => &[],
            [0x01] => &[item::ID],
            [0x02] => &[item::ID, item::BAUD_RATE],
            _ => return Err(Refusal::DataRange),
        };
        self.memory.reset(|item| item.address < RAM && !kept.contains(&item));
        self.reboot();
        Ok(())
    }

    fn clear(&mut self, parameters: &[u8]) -> Result<(), Refusal> {
        if parameters != CLEAR_MULTI_TURN {
            return Err(Refusal::DataRange);
        }
        if self.item(item::MOVING) != 0 {
            return Err(Refusal::ResultFail);
        }
        self.forget_turns();
        self.seat_position();
        Ok(())
    }

    fn back_up(&mut self, parameters: &[u8], addressed: Addressed) -> Result<(), Refusal> {
        if parameters != BACKUP && parameters != RESTORE {
            return Err(Refusal::DataRange);
        }
        if self.has_torque() {
            return Err(Refusal::ResultFail);
        }
        if parameters == BACKUP {
            self.backup = Some(self.memory.copy());
            self.memory.set(item::BACKUP_READY, 1);
            return Ok(());
        }
        if addressed == Addressed::Secondary {
            return Err(Refusal::Access);
        }
        let backup = self.backup.as_ref().ok_or(Refusal::ResultFail)?;
        self.memory.restore(backup, |item| item.address < RAM);
        self.reboot();
        Ok(())
    }
}

fn word(low: u8, high: u8) -> usize {
    usize::from(u16::from_le_bytes([low, high]))
}

fn address_and_data(parameters: &[u8]) -> Result<(usize, &[u8]), Refusal> {
    let [low, high, data @ ..] = parameters else { return Err(Refusal::DataLength) };
    Ok((word(*low, *high), data))
}
