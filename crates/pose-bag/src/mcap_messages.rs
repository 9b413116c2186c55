//! Messages of an MCAP file, linked to their topics.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use mcap::records::op;

use crate::BagError;
use crate::mcap_records::{Fault, read_file};

/// Where messages come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Channel {
    pub(crate) topic: String,
    /// Name of the schema, empty for a channel without one.
    pub(crate) message_type: String,
    pub(crate) encoding: String,
}

/// One recorded message.
pub(crate) struct RawMessage<'a> {
    pub(crate) channel: &'a Channel,
    pub(crate) log_time_ns: u64,
    pub(crate) data: &'a [u8],
}

/// Whether a file begins like MCAP, or `None` where it is too short to tell.
pub(crate) fn has_magic(start: &[u8]) -> bool {
    start.starts_with(mcap::MAGIC)
}

/// Calls `visit` with every message, in file order.
pub(crate) fn for_each_message(
    path: &Path,
    visit: &mut dyn FnMut(RawMessage<'_>) -> Result<(), BagError>,
) -> Result<(), BagError> {
    let file = path.display().to_string();
    let mut source = BufReader::with_capacity(1 << 16, File::open(path).map_err(BagError::io(&file))?);
    let mut start = Vec::new();
    source.by_ref().take(mcap::MAGIC.len() as u64).read_to_end(&mut start).map_err(BagError::io(&file))?;
    if start.is_empty() {
        return Err(BagError::Empty { file });
    }
    if !mcap::MAGIC.starts_with(&start) {
        return Err(BagError::NotMcap { file });
    }
    let mut linker = Linker::default();
    let read = if start.len() < mcap::MAGIC.len() {
        Err(Fault::Cut)
    } else {
        read_file(&mut source, &mut |opcode, body| linker.record(opcode, body, visit))
    };
    let messages_read = linker.messages_read;
    read.map_err(|fault| match fault {
        Fault::Cut => BagError::Truncated { file, messages_read },
        Fault::Corrupt(reason) => BagError::Corrupt { file, messages_read, reason },
        Fault::Io(source) => BagError::Io { file, source },
        Fault::Visit(error) => error,
    })
}

#[derive(Default)]
struct Linker {
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
    messages_read: u64,
}

impl Linker {
    fn record(
        &mut self,
        opcode: u8,
        body: &[u8],
        visit: &mut dyn FnMut(RawMessage<'_>) -> Result<(), BagError>,
    ) -> Result<(), Fault<BagError>> {
        let corrupt = |reason: &str| Fault::Corrupt(reason.to_owned());
        let mut fields = Fields(body);
        match opcode {
            op::SCHEMA => {
                let (id, name) = fields.schema().ok_or_else(|| corrupt("a schema record is too short"))?;
                self.schemas.insert(id, name);
            }
            op::CHANNEL => {
                let (id, schema_id, topic, encoding) =
                    fields.channel().ok_or_else(|| corrupt("a channel record is too short"))?;
                let message_type = match (schema_id, self.schemas.get(&schema_id)) {
                    (0, _) => String::new(),
                    (_, Some(name)) => name.clone(),
                    (_, None) => {
                        return Err(Fault::Corrupt(format!("topic {topic} has the unknown schema {schema_id}")));
                    }
                };
                let channel = Channel { topic, message_type, encoding };
                if self.channels.get(&id).is_some_and(|known| *known != channel) {
                    return Err(Fault::Corrupt(format!("channel {id} is defined twice, as different topics")));
                }
                self.channels.insert(id, channel);
            }
            _ => {
                let (id, log_time_ns) = fields.message().ok_or_else(|| corrupt("a message record is too short"))?;
                let Some(channel) = self.channels.get(&id) else {
                    return Err(Fault::Corrupt(format!("a message belongs to the unknown channel {id}")));
                };
                visit(RawMessage { channel, log_time_ns, data: fields.0 }).map_err(Fault::Visit)?;
                self.messages_read += 1;
            }
        }
        Ok(())
    }
}

/// The little-endian fields of a record, taken from its front; `None` where the bytes do not suffice.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*head)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn string(&mut self) -> Option<String> {
        let len = u32::from_le_bytes(self.array()?);
        let (head, rest) = self.0.split_at_checked(len.try_into().ok()?)?;
        self.0 = rest;
        Some(String::from_utf8_lossy(head).into_owned())
    }

    /// Identifier and name.
    fn schema(&mut self) -> Option<(u16, String)> {
        Some((self.u16()?, self.string()?))
    }

    /// Identifier, identifier of the schema, topic, encoding.
    fn channel(&mut self) -> Option<(u16, u16, String, String)> {
        Some((self.u16()?, self.u16()?, self.string()?, self.string()?))
    }

    /// Identifier of the channel and log time; what is left is the data.
    fn message(&mut self) -> Option<(u16, u64)> {
        let channel = self.u16()?;
        let _sequence = self.array::<4>()?;
        let log_time_ns = u64::from_le_bytes(self.array()?);
        let _publish_time_ns = self.array::<8>()?;
        Some((channel, log_time_ns))
    }
}
