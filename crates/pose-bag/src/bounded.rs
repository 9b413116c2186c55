//! Decompression that a few bytes cannot make endless.

use std::io::{self, Read};

use crate::mcap_records::Fault;

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

/// Copies a file that was compressed as a whole. What is wrong with it is [`Fault::Corrupt`]; that it cannot be read, or the copy
/// not be written, is no damage.
pub(crate) fn unpack_file(packed: &mut impl Read, packed_len: u64, unpacked: &mut impl io::Write) -> Result<(), Fault> {
    if packed_len == 0 {
        return Err(Fault::Empty);
    }
    let most = Budget::default().with(packed_len);
    let mut decoder = zstd::stream::read::Decoder::new(packed).map_err(Fault::Io)?.take(most + 1);
    let mut piece = vec![0; 1 << 16];
    let mut left = most;
    loop {
        let read = match decoder.read(&mut piece) {
            Ok(0) => return Ok(()),
            Ok(read) => read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(undecodable("it cannot be decompressed to its end", error)),
        };
        unpacked.write_all(&piece[..read]).map_err(Fault::Io)?;
        left = left
            .checked_sub(read as u64)
            .ok_or_else(|| undecodable("it cannot be decompressed to its end", too_much(most)))?;
    }
}

/// Why a decoder gave up: what has the number of the operating system comes from below it.
pub(crate) fn undecodable(what: &str, error: io::Error) -> Fault {
    match error.raw_os_error() {
        Some(_) => Fault::Io(error),
        None => Fault::Corrupt(format!("{what}: {error}")),
    }
}

fn too_much(most: u64) -> io::Error {
    io::Error::other(format!("it unpacks to more than {most} bytes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disk that fails.
    struct Failing;

    impl Read for Failing {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::from_raw_os_error(5))
        }
    }

    #[test]
    fn a_full_or_failing_disk_is_no_damage() {
        let packed = zstd::bulk::compress(&[7; 100_000], 1).unwrap();
        let mut full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let error = unpack_file(&mut packed.as_slice(), packed.len() as u64, &mut full);
        assert!(matches!(error, Err(Fault::Io(error)) if error.kind() == io::ErrorKind::StorageFull));
        let cut = packed[..20].chain(Failing);
        let error = unpack_file(&mut { cut }, packed.len() as u64, &mut Vec::new());
        assert!(matches!(error, Err(Fault::Io(error)) if error.raw_os_error() == Some(5)));
        let error = unpack_file(&mut &packed[..20], packed.len() as u64, &mut Vec::new());
        assert!(matches!(error, Err(Fault::Corrupt(why)) if why.starts_with("it cannot be decompressed to its end: ")));
    }
}
