//! Decompression that a few bytes cannot make endless.

use std::io::{self, Read};

/// Larger than any message of poses (4 million of them), small enough to be held.
pub(crate) const MAX_MESSAGE_BYTES: u64 = 256 << 20;
/// So many bytes may always come of a compressed piece.
const UNSUSPICIOUS_BYTES: u64 = 16 << 20;
/// Recordings shrink to a fifth or so, idle ones to a hundredth; zstd makes 1 of 20,000 zeros.
const MAX_RATIO: u64 = 1024;

/// Whether so many bytes out of so few can only be meant to exhaust the reader.
pub(crate) fn is_bomb(unpacked: u64, packed: u64) -> bool {
    unpacked > UNSUSPICIOUS_BYTES && unpacked / MAX_RATIO > packed
}

/// A message that was compressed by itself.
pub(crate) fn unpack_message(packed: &[u8], unpacked: &mut Vec<u8>) -> io::Result<()> {
    unpacked.clear();
    let most = (MAX_RATIO * packed.len() as u64).clamp(UNSUSPICIOUS_BYTES, MAX_MESSAGE_BYTES);
    let mut decoder = zstd::stream::read::Decoder::with_buffer(packed)?;
    decoder.by_ref().take(most + 1).read_to_end(unpacked)?;
    if unpacked.len() as u64 > most {
        Err(io::Error::other(format!("it unpacks to more than {most} bytes")))
    } else {
        Ok(())
    }
}

/// Copies a file that was compressed as a whole.
pub(crate) fn unpack_file(packed: &mut impl Read, packed_len: u64, unpacked: &mut impl io::Write) -> io::Result<u64> {
    let most = packed_len.saturating_mul(MAX_RATIO).max(UNSUSPICIOUS_BYTES);
    let mut decoder = zstd::stream::read::Decoder::new(packed)?;
    let copied = io::copy(&mut decoder.by_ref().take(most + 1), unpacked)?;
    if copied > most { Err(io::Error::other(format!("it unpacks to more than {most} bytes"))) } else { Ok(copied) }
}
