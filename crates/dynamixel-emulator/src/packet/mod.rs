//! Packets of [Protocol 2.0](https://emanual.robotis.com/docs/en/dxl/protocol2/) as bytes on the wire.
//!
//! ```text
//! FF FF FD 00 │ id │ length, LSB first │ instruction │ parameters … │ CRC, LSB first
//!                                      └── length counts these ──────────────────┘
//! ```

mod crc;
mod parser;
mod stuffing;

pub use crc::crc16;
pub use parser::{Heard, Parser};
pub use stuffing::{stuff, unstuff};

/// What every packet begins with.
pub const HEADER: [u8; 4] = [0xFF, 0xFF, 0xFD, 0x00];
/// The ID that every servo listens to.
pub const BROADCAST_ID: u8 = 0xFE;
/// The greatest ID of a servo.
pub const MAX_ID: u8 = 252;

/// Values of the instruction field.
pub mod instruction {
    #![allow(missing_docs)]
    pub const PING: u8 = 0x01;
    pub const READ: u8 = 0x02;
    pub const WRITE: u8 = 0x03;
    pub const REG_WRITE: u8 = 0x04;
    pub const ACTION: u8 = 0x05;
    pub const FACTORY_RESET: u8 = 0x06;
    pub const REBOOT: u8 = 0x08;
    pub const CLEAR: u8 = 0x10;
    pub const CONTROL_TABLE_BACKUP: u8 = 0x20;
    pub const STATUS: u8 = 0x55;
    pub const SYNC_READ: u8 = 0x82;
    pub const SYNC_WRITE: u8 = 0x83;
    pub const FAST_SYNC_READ: u8 = 0x8A;
    pub const BULK_READ: u8 = 0x92;
    pub const BULK_WRITE: u8 = 0x93;
    pub const FAST_BULK_READ: u8 = 0x9A;
}

/// A packet without what only its transport needs: header, length, stuffing and CRC.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packet {
    /// Whom it is for; of a status packet, whom it is from.
    pub id: u8,
    /// One of [`instruction`].
    pub instruction: u8,
    /// What the instruction needs. The first parameter of a status packet is its error field.
    pub parameters: Vec<u8>,
}

impl Packet {
    /// The bytes on the wire.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut body = Vec::with_capacity(self.parameters.len() + 1);
        body.push(self.instruction);
        body.extend_from_slice(&self.parameters);
        let body = stuff(&body);
        // A table has 662 bytes: nothing that is encoded here comes near the greatest length.
        let length = u16::try_from(body.len() + 2).unwrap_or(u16::MAX);
        let mut bytes = Vec::with_capacity(body.len() + 9);
        bytes.extend_from_slice(&HEADER);
        bytes.push(self.id);
        bytes.extend_from_slice(&length.to_le_bytes());
        bytes.extend_from_slice(&body);
        let crc = crc16(0, &bytes);
        bytes.extend_from_slice(&crc.to_le_bytes());
        bytes
    }
}

/// Why a servo does not do what it was told: the error number of a status packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[repr(u8)]
pub enum Refusal {
    /// The instruction could not be carried out.
    #[error("the instruction failed")]
    ResultFail = 1,
    /// There is no such instruction, or an action without a registered write.
    #[error("there is no such instruction, or nothing is registered")]
    Instruction = 2,
    /// The CRC of the instruction does not fit its bytes.
    #[error("the CRC is wrong")]
    Crc = 3,
    /// A value outside of what the item can hold.
    #[error("the value is outside of the item's range")]
    DataRange = 4,
    /// Fewer bytes than the item has.
    #[error("the data has fewer bytes than the item")]
    DataLength = 5,
    /// A value outside of the limit that another item sets.
    #[error("the value is outside of the configured limit")]
    DataLimit = 6,
    /// A write to what is read-only, undefined, or locked while the torque is on; a read of what is undefined.
    #[error("the address is read-only, locked or undefined")]
    Access = 7,
}
