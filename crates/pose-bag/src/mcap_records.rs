//! MCAP framing: magic, records (opcode, length, body), magic.
//!
//! The readers of crate `mcap` trust the lengths they find. In 0.26.0 a message that claims more than its chunk holds, a record
//! of 2⁶⁴ − 1 bytes and a short attachment panic, and a cut record of 4 GB allocates 4 GB. So records are framed here, over a
//! stream, where memory follows the bytes that are there, and chunks are decompressed on the fly: a cut file still yields every
//! message before the cut.

use std::io::{self, ErrorKind, Read};

use mcap::records::op;

/// Larger than any message of poses (4 million of them), small enough to be held.
const MAX_RECORD_BYTES: u64 = 256 << 20;

/// Why reading ended before the end.
pub(crate) enum Fault<E> {
    /// The file ends inside a record.
    Cut,
    /// The records contradict each other.
    Corrupt(String),
    /// The operating system refused.
    Io(io::Error),
    /// The visitor refused.
    Visit(E),
}

impl<E> From<io::Error> for Fault<E> {
    fn from(error: io::Error) -> Self {
        if error.kind() == ErrorKind::UnexpectedEof { Self::Cut } else { Self::Io(error) }
    }
}

/// Receives the bodies of schema, channel and message records, with their opcode, in file order.
pub(crate) type Visit<'a, E> = dyn FnMut(u8, &[u8]) -> Result<(), Fault<E>> + 'a;

/// Reads a file from behind its first magic to its end.
pub(crate) fn read_file<E>(source: &mut impl Read, visit: &mut Visit<'_, E>) -> Result<(), Fault<E>> {
    let mut in_data = true;
    let mut body = Vec::new();
    while let Some((opcode, len)) = record_head(source)? {
        match opcode {
            op::CHUNK if in_data => read_chunk(&mut source.by_ref().take(len), visit)?,
            // The summary repeats schemas and channels of the data section.
            op::SCHEMA | op::CHANNEL | op::MESSAGE if in_data => {
                read_body(source, len, &mut body)?;
                visit(opcode, &body)?;
            }
            op::FOOTER => {
                skip(source, len)?;
                return read_end(source);
            }
            _ => {
                in_data &= opcode != op::DATA_END;
                skip(source, len)?;
            }
        }
    }
    Err(Fault::Cut)
}

fn read_end<E>(source: &mut dyn Read) -> Result<(), Fault<E>> {
    let mut magic = [0; mcap::MAGIC.len()];
    source.read_exact(&mut magic)?;
    if magic != mcap::MAGIC {
        return Err(Fault::Corrupt("the footer is not followed by the MCAP magic".into()));
    }
    match source.read(&mut [0])? {
        0 => Ok(()),
        _ => Err(Fault::Corrupt("bytes follow the end of the file".into())),
    }
}

fn read_chunk<E>(chunk: &mut io::Take<impl Read>, visit: &mut Visit<'_, E>) -> Result<(), Fault<E>> {
    let mut times_and_size = [0; 24];
    chunk.read_exact(&mut times_and_size)?;
    let saved_crc = u32::from_le_bytes(read_array(chunk)?);
    let mut compression = Vec::new();
    let len = u32::from_le_bytes(read_array(chunk)?);
    chunk.by_ref().take(len.into()).read_to_end(&mut compression)?;
    let size = u64::from_le_bytes(read_array(chunk)?);
    let present = chunk.limit();
    if size > present {
        return Err(Fault::Corrupt(format!("a chunk claims {size} compressed bytes in a record with {present} left")));
    }
    let mut compressed = chunk.by_ref().take(size);
    let read = match compression.as_slice() {
        b"" => read_chunk_records(&mut compressed, saved_crc, visit),
        b"zstd" => {
            let mut decoder = zstd::stream::read::Decoder::new(&mut compressed)?;
            read_chunk_records(&mut decoder, saved_crc, visit)
        }
        b"lz4" => {
            let mut decoder = lz4::Decoder::new(&mut compressed)?;
            read_chunk_records(&mut decoder, saved_crc, visit)
        }
        other => {
            let name = String::from_utf8_lossy(other).chars().take(20).collect::<String>();
            Err(Fault::Corrupt(format!("a chunk is compressed by the unknown method {name:?}")))
        }
    };
    // A stream that ends early is the file's end if the file ends there, and a damaged chunk if it goes on.
    let unread = chunk.limit();
    match (read, skip(chunk, unread)) {
        (Err(Fault::Visit(error)), _) => Err(Fault::Visit(error)),
        (_, Err(end_of_file)) => Err(end_of_file),
        (Err(Fault::Cut), Ok(())) => Err(Fault::Corrupt("a record goes beyond the end of its chunk".into())),
        (Err(Fault::Io(error)), Ok(())) => Err(Fault::Corrupt(format!("a chunk cannot be decompressed: {error}"))),
        (read, Ok(())) => read,
    }
}

fn read_chunk_records<E>(records: &mut dyn Read, saved_crc: u32, visit: &mut Visit<'_, E>) -> Result<(), Fault<E>> {
    let mut records = Hashing { source: records, hasher: crc32fast::Hasher::new() };
    let mut body = Vec::new();
    while let Some((opcode, len)) = record_head(&mut records)? {
        if matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            read_body(&mut records, len, &mut body)?;
            visit(opcode, &body)?;
        } else {
            skip(&mut records, len)?;
        }
    }
    // Zero means that the writer computed none.
    if saved_crc != 0 && records.hasher.finalize() != saved_crc {
        return Err(Fault::Corrupt("the checksum of a chunk does not match its bytes".into()));
    }
    Ok(())
}

/// Opcode and length of the next record; `None` where the stream ends before it.
fn record_head<E>(source: &mut dyn Read) -> Result<Option<(u8, u64)>, Fault<E>> {
    let mut opcode = [0];
    match source.read_exact(&mut opcode) {
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(None),
        read => read?,
    }
    Ok(Some((opcode[0], u64::from_le_bytes(read_array(source)?))))
}

fn read_body<E>(source: &mut dyn Read, len: u64, body: &mut Vec<u8>) -> Result<(), Fault<E>> {
    if len > MAX_RECORD_BYTES {
        return Err(Fault::Corrupt(format!(
            "a record claims {len} bytes, more than the {MAX_RECORD_BYTES} that are read"
        )));
    }
    body.clear();
    let read = source.take(len).read_to_end(body)?;
    if (read as u64) < len { Err(Fault::Cut) } else { Ok(()) }
}

fn skip<E>(source: &mut dyn Read, len: u64) -> Result<(), Fault<E>> {
    let skipped = io::copy(&mut source.take(len), &mut io::sink())?;
    if skipped < len { Err(Fault::Cut) } else { Ok(()) }
}

fn read_array<const N: usize>(source: &mut dyn Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    source.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Passes bytes on and computes their CRC-32.
struct Hashing<'a> {
    source: &'a mut dyn Read,
    hasher: crc32fast::Hasher,
}

impl Read for Hashing<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.source.read(buffer)?;
        self.hasher.update(&buffer[..read]);
        Ok(read)
    }
}
