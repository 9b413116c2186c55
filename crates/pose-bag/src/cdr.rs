//! Messages as bytes: OMG CDR in the encapsulation that ROS 2 puts around it.
//!
//! Four bytes of encapsulation come first: the representation (0 = CDR big endian, 1 = CDR little endian) and two bytes of
//! options; alignment counts from the byte after them (DDSI-RTPS 2.5, section 10.5).

use byteorder::{BigEndian, LittleEndian};
use serde::{Serialize, de::DeserializeOwned};

const CDR_BIG_ENDIAN: [u8; 2] = [0, 0];
const CDR_LITTLE_ENDIAN: [u8; 2] = [0, 1];

/// A DDS payload is padded to a multiple of four bytes, so up to three may follow the message.
const MAX_PADDING: usize = 3;

/// Why bytes are not a message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CdrError {
    /// There is not even an encapsulation.
    #[error("the message has {len} bytes, too few for its 4-byte CDR header")]
    NoEncapsulation {
        /// Bytes that are there.
        len: usize,
    },
    /// The representation is not plain CDR.
    #[error("the CDR header names the unknown representation {representation:#06x}")]
    UnknownRepresentation {
        /// The identifier found.
        representation: u16,
    },
    /// The bytes end too early or a field is impossible.
    #[error("the message of {len} bytes does not follow its definition: {reason}")]
    Malformed {
        /// Bytes of the message, with its header.
        len: usize,
        /// What the decoder ran into.
        reason: String,
    },
    /// The message ends before its bytes do.
    #[error("the message has {len} bytes but its fields end after {used}")]
    TrailingBytes {
        /// Bytes of the message, with its header.
        len: usize,
        /// Bytes its fields take, with the header.
        used: usize,
    },
}

/// The message in the bytes, in either byte order.
///
/// # Errors
/// [`CdrError`] unless the bytes are one whole message of this type. Nothing is allocated on the word of a length field: the
/// bytes have to be there.
pub fn decode<M: DeserializeOwned>(bytes: &[u8]) -> Result<M, CdrError> {
    let len = bytes.len();
    let Some((&[high, low, _, _], body)) = bytes.split_first_chunk() else {
        return Err(CdrError::NoEncapsulation { len });
    };
    let decoded = match [high, low] {
        CDR_BIG_ENDIAN => cdr_encoding::from_bytes::<M, BigEndian>(body),
        CDR_LITTLE_ENDIAN => cdr_encoding::from_bytes::<M, LittleEndian>(body),
        other => return Err(CdrError::UnknownRepresentation { representation: u16::from_be_bytes(other) }),
    };
    let (message, used) = decoded.map_err(|error| CdrError::Malformed { len, reason: error.to_string() })?;
    if body.len() > used + MAX_PADDING {
        return Err(CdrError::TrailingBytes { len, used: len - body.len() + used });
    }
    Ok(message)
}

/// The bytes of the message, little endian.
///
/// # Errors
/// [`CdrError::Malformed`] where the type has no CDR form.
pub fn encode<M: Serialize>(message: &M) -> Result<Vec<u8>, CdrError> {
    let mut bytes = [CDR_LITTLE_ENDIAN, [0, 0]].concat();
    cdr_encoding::to_writer::<M, LittleEndian, _>(&mut bytes, message)
        .map_err(|error| CdrError::Malformed { len: 0, reason: error.to_string() })?;
    Ok(bytes)
}
