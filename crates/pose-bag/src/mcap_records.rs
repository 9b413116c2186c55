//! MCAP framing: magic, records (opcode, length, body), magic.
//!
//! The readers of crate `mcap` trust the lengths they find. In 0.26.0 a message that claims more than its chunk holds, a record
//! of 2⁶⁴ − 1 bytes and a short attachment panic, and a cut record of 4 GB allocates 4 GB. So records are framed here, over a
//! stream, where memory follows the bytes that are there. One chunk at a time is decompressed, and looked into only once its
//! checksum is known to be right; a cut one yields every message before the cut.

use std::io::{self, ErrorKind, Read};

use mcap::records::op;

use crate::BagError;
use crate::bounded::{Budget, MAX_MESSAGE_BYTES, undecodable};

/// Writers keep chunks to a few megabytes.
const MAX_CHUNK_BYTES: u64 = 128 << 20;
/// A checksum, which may be zero.
const DATA_END_BYTES: u64 = 4;
/// Applications may use this opcode and those above as they like; all others are MCAP's own.
const FIRST_PRIVATE_OPCODE: u8 = 0x80;

/// Why reading a file ended before its end.
pub(crate) enum Fault {
    /// There are no bytes.
    Empty,
    /// The file does not begin like MCAP.
    NotMcap,
    /// The file ends inside a record.
    Cut,
    /// The records contradict each other.
    Corrupt(String),
    /// The operating system refused.
    Io(io::Error),
    /// Whoever looks at the messages refused.
    Visit(BagError),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        if error.kind() == ErrorKind::UnexpectedEof { Self::Cut } else { Self::Io(error) }
    }
}

/// Who is told of the records of a file.
pub(crate) trait Records {
    /// A schema, channel, message or statistics record, in file order; statistics come behind all messages.
    fn record(&mut self, opcode: u8, body: &[u8]) -> Result<(), Fault>;
    /// A record is lost, wholly or from somewhere on; the file goes on behind it.
    fn lost(&mut self, why: String);
}

/// Reads a file from behind its first magic to its end.
pub(crate) fn read_file(source: &mut impl Read, records: &mut impl Records) -> Result<(), Fault> {
    let (mut in_data, mut is_first) = (true, true);
    let (mut body, mut chunk, mut budget) = (Vec::new(), Vec::new(), Budget::default());
    while let Some((opcode, len)) = record_head(source)? {
        match opcode {
            op::CHUNK if in_data => {
                if let Err(why) = read_chunk(&mut source.by_ref().take(len), &mut chunk, &mut budget, records)? {
                    records.lost(why);
                }
            }
            op::SCHEMA | op::CHANNEL | op::MESSAGE if in_data => {
                read_body(source, len, &mut body)?;
                records.record(opcode, &body)?;
            }
            op::STATISTICS if !in_data => {
                read_body(source, len, &mut body)?;
                records.record(opcode, &body)?;
            }
            // What claims another length is another record with a damaged opcode, and the data go on.
            op::DATA_END if in_data && len == DATA_END_BYTES => {
                in_data = false;
                skip(source, len)?;
            }
            op::MESSAGE_INDEX if in_data => {
                if !is_message_index(&mut source.by_ref().take(len))? {
                    records.lost(format!("a message index of {len} bytes claims to have another length"));
                }
            }
            op::FOOTER => {
                skip(source, len)?;
                return read_end(source);
            }
            _ => {
                skip(source, len)?;
                if let Some(why) = out_of_place(opcode, len, in_data, is_first) {
                    records.lost(why);
                }
            }
        }
        is_first = false;
    }
    Err(Fault::Cut)
}

/// Why a record that is not read tells of damage: a bit of an opcode may have flipped, and what it was is lost.
fn out_of_place(opcode: u8, len: u64, in_data: bool, is_first: bool) -> Option<String> {
    match opcode {
        op::HEADER if is_first => None,
        // Nothing in them is of use here, wherever they are.
        op::ATTACHMENT | op::METADATA | FIRST_PRIVATE_OPCODE.. => None,
        // The summary repeats schemas and channels of the data section.
        op::SCHEMA | op::CHANNEL | op::CHUNK_INDEX | op::ATTACHMENT_INDEX | op::METADATA_INDEX | op::SUMMARY_OFFSET
            if !in_data =>
        {
            None
        }
        op::DATA_END if in_data => Some(format!("the record that ends the data has {len} bytes instead of 4")),
        op::HEADER..=op::DATA_END => {
            let place = if in_data { "before" } else { "after" };
            Some(format!("a record of kind {opcode:#04x} {place} the end of the data is out of place"))
        }
        unknown => Some(format!("a record is of the unknown kind {unknown:#04x}")),
    }
}

/// Takes a message index to its end: a channel, and as many bytes as it says. Whether these are all.
fn is_message_index(index: &mut io::Take<impl Read>) -> Result<bool, Fault> {
    let len = index.limit();
    let claimed = if len < 6 { None } else { Some(read_array::<6>(index)?) };
    let unread = index.limit();
    skip(index, unread)?;
    Ok(claimed.is_some_and(|[_, _, size @ ..]| u64::from(u32::from_le_bytes(size)) == len - 6))
}

fn read_end(source: &mut impl Read) -> Result<(), Fault> {
    if read_array::<{ mcap::MAGIC.len() }>(source)? != mcap::MAGIC {
        return Err(Fault::Corrupt("the footer is not followed by the MCAP magic".into()));
    }
    match source.read(&mut [0])? {
        0 => Ok(()),
        _ => Err(Fault::Corrupt("bytes follow the end of the file".into())),
    }
}

/// The inner error is why the chunk is lost while the file goes on.
fn read_chunk(
    chunk: &mut io::Take<impl Read>,
    inside: &mut Vec<u8>,
    budget: &mut Budget,
    records: &mut impl Records,
) -> Result<Result<(), String>, Fault> {
    let unpacked = unpack_chunk(chunk, inside, budget);
    // A stream that ends early is the file's end if the file ends there, and a damaged chunk if it goes on.
    let unread = chunk.limit();
    let cut = skip(chunk, unread).err();
    let read = match unpacked {
        Ok(Ok(())) => chunk_records(inside, records),
        Ok(Err(why)) if cut.is_none() => Ok(Err(why)),
        Err(Fault::Cut) if cut.is_none() => Ok(Err("a chunk is shorter than its own header".into())),
        // Its checksum cannot be known; what is whole in it is.
        Ok(Err(_)) | Err(Fault::Cut) => chunk_records(inside, records),
        Err(fault) => return Err(fault),
    };
    match (read, cut) {
        (Err(fault), _) | (Ok(_), Some(fault)) => Err(fault),
        (Ok(read), None) => Ok(read),
    }
}

/// Decompresses the records of a chunk and checks them against its header.
fn unpack_chunk(
    chunk: &mut io::Take<impl Read>,
    inside: &mut Vec<u8>,
    budget: &mut Budget,
) -> Result<Result<(), String>, Fault> {
    inside.clear();
    let _times = read_array::<16>(chunk)?;
    let claimed = u64::from_le_bytes(read_array(chunk)?);
    let saved_crc = u32::from_le_bytes(read_array(chunk)?);
    let name_len = u32::from_le_bytes(read_array(chunk)?);
    let mut compression = Vec::new();
    chunk.by_ref().take(name_len.into()).take(32).read_to_end(&mut compression)?;
    if compression.len() as u64 != name_len.into() {
        return Ok(Err(format!("the compression of a chunk has a name of {name_len} bytes")));
    }
    let size = u64::from_le_bytes(read_array(chunk)?);
    let present = chunk.limit();
    if size > present {
        return Ok(Err(format!("a chunk claims {size} compressed bytes in a record with {present} left")));
    }
    if claimed > MAX_CHUNK_BYTES || !budget.allows(size, claimed) {
        return Ok(Err(format!("a chunk of {size} bytes claims to hold {claimed}, which is not believed")));
    }
    let compressed = chunk.by_ref().take(size);
    let unpacked = match compression.as_slice() {
        b"" => fill(compressed, claimed, inside),
        b"zstd" => zstd::stream::read::Decoder::new(compressed).and_then(|decoder| fill(decoder, claimed, inside)),
        b"lz4" => lz4::Decoder::new(compressed).and_then(|decoder| fill(decoder, claimed, inside)),
        other => {
            let name = String::from_utf8_lossy(other);
            return Ok(Err(format!("a chunk is compressed by the unknown method {name:?}")));
        }
    };
    match unpacked.map_err(|error| undecodable("a chunk cannot be decompressed", error)) {
        Ok(()) => {}
        Err(Fault::Corrupt(why)) => return Ok(Err(why)),
        Err(fault) => return Err(fault),
    }
    if inside.len() as u64 != claimed {
        let more = if inside.len() as u64 > claimed { "more than" } else { "less than" };
        return Ok(Err(format!("a chunk holds {more} the {claimed} bytes that it claims")));
    }
    // Zero means that the writer computed none.
    if saved_crc != 0 && crc32fast::hash(inside) != saved_crc {
        return Ok(Err("the checksum of a chunk does not match its bytes".into()));
    }
    Ok(Ok(()))
}

/// Up to one byte more than the claimed ones, so that more of them show.
fn fill(source: impl Read, claimed: u64, inside: &mut Vec<u8>) -> io::Result<()> {
    source.take(claimed + 1).read_to_end(inside).map(|_| ())
}

fn chunk_records(inside: &[u8], records: &mut impl Records) -> Result<Result<(), String>, Fault> {
    let (mut rest, mut read) = (inside, Ok(()));
    while let Some((head, after)) = rest.split_first_chunk::<9>() {
        let len = u64::from_le_bytes(std::array::from_fn(|i| head[i + 1]));
        let Some((body, after)) = usize::try_from(len).ok().and_then(|len| after.split_at_checked(len)) else { break };
        match head[0] {
            op::SCHEMA | op::CHANNEL | op::MESSAGE => match records.record(head[0], body) {
                Err(Fault::Corrupt(why)) => return Ok(Err(why)),
                other => other?,
            },
            FIRST_PRIVATE_OPCODE.. => {}
            other => read = read.and(Err(format!("a chunk holds a record of kind {other:#04x}"))),
        }
        rest = after;
    }
    Ok(if rest.is_empty() { read } else { Err("a record goes beyond the end of its chunk".into()) })
}

/// Opcode and length of the next record; `None` where the stream ends before it.
fn record_head(source: &mut impl Read) -> Result<Option<(u8, u64)>, Fault> {
    match read_array(source) {
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error.into()),
        Ok([opcode]) => Ok(Some((opcode, u64::from_le_bytes(read_array(source)?)))),
    }
}

fn read_body(source: &mut impl Read, len: u64, body: &mut Vec<u8>) -> Result<(), Fault> {
    if len > MAX_MESSAGE_BYTES {
        return Err(Fault::Corrupt(format!(
            "a record claims {len} bytes, more than the {MAX_MESSAGE_BYTES} that are read"
        )));
    }
    body.clear();
    let read = source.by_ref().take(len).read_to_end(body)?;
    if (read as u64) < len { Err(Fault::Cut) } else { Ok(()) }
}

fn skip(source: &mut impl Read, len: u64) -> Result<(), Fault> {
    let skipped = io::copy(&mut source.by_ref().take(len), &mut io::sink())?;
    if skipped < len { Err(Fault::Cut) } else { Ok(()) }
}

fn read_array<const N: usize>(source: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    source.read_exact(&mut bytes)?;
    Ok(bytes)
}
