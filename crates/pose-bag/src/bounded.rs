//! Decompression that a few bytes cannot make endless.

use std::io::{self, Read};

/// Larger than any message of poses (4 million of them), small enough to be held.
pub(crate) const MAX_MESSAGE_BYTES: u64 = 256 << 20;
/// So many bytes may always come of a file.
const UNSUSPICIOUS_BYTES: u64 = 16 << 20;
/// Recordings shrink to a fifth or so, idle ones to a hundredth; zstd makes 1 of 20,000 zeros.
const MAX_RATIO: u64 = 1024;

/// How much may come of the compressed pieces of a file, all together: many small bombs are one.
#[derive(Default)]
pub(crate) struct Budget {
    packed: u64,
    unpacked: u64,
}

impl Budget {
    /// With a further piece of so many bytes.
    fn with(&mut self, packed: u64) -> u64 {
        self.packed = self.packed.saturating_add(packed);
        UNSUSPICIOUS_BYTES.saturating_add(self.packed.saturating_mul(MAX_RATIO)).saturating_sub(self.unpacked)
    }

    /// Whether a further piece may claim to hold so many bytes; they count if so.
    pub(crate) fn allows(&mut self, packed: u64, claimed: u64) -> bool {
        let is_allowed = claimed <= self.with(packed);
        self.unpacked += if is_allowed { claimed } else { 0 };
        is_allowed
    }

    /// A message that was compressed by itself.
    pub(crate) fn unpack_message(&mut self, packed: &[u8], unpacked: &mut Vec<u8>) -> io::Result<()> {
        unpacked.clear();
        let most = self.with(packed.len() as u64).min(MAX_MESSAGE_BYTES);
        let mut decoder = zstd::stream::read::Decoder::with_buffer(packed)?;
        let read = decoder.by_ref().take(most + 1).read_to_end(unpacked);
        // What ends in an error was work too.
        self.unpacked += unpacked.len() as u64;
        read?;
        if unpacked.len() as u64 > most { Err(too_much(most)) } else { Ok(()) }
    }
}

/// Copies a file that was compressed as a whole.
pub(crate) fn unpack_file(packed: &mut impl Read, packed_len: u64, unpacked: &mut impl io::Write) -> io::Result<()> {
    let most = Budget::default().with(packed_len);
    let mut decoder = zstd::stream::read::Decoder::new(packed)?;
    let copied = io::copy(&mut decoder.by_ref().take(most + 1), unpacked)?;
    if copied > most { Err(too_much(most)) } else { Ok(()) }
}

fn too_much(most: u64) -> io::Error {
    io::Error::other(format!("it unpacks to more than {most} bytes"))
}
