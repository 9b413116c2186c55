//! Messages of an MCAP file, linked to their topics.

use std::collections::{HashMap, HashSet};
use std::io::Read;

use mcap::records::op;

use crate::bounded::Budget;
use crate::channel::{BagMessage, Channel, Counts, Schema, Visit};
use crate::mcap_records::{Fault, Records, read_file};

/// Whether a file begins like MCAP.
pub(crate) fn has_magic(start: &[u8]) -> bool {
    start.starts_with(mcap::MAGIC)
}

/// Hands on every message, in file order. `lost` is told how many messages came before what is lost, and why it is. With
/// `packed_messages` each is compressed by itself.
pub(crate) fn read_mcap(
    source: &mut impl Read,
    packed_messages: bool,
    file: &str,
    counts: &mut Counts,
    visit: &mut Visit<'_>,
    lost: &mut dyn FnMut(u64, Fault),
) -> Result<(), Fault> {
    let (schemas, channels, unknown) = (HashMap::new(), HashMap::new(), HashSet::new());
    let unpack = packed_messages.then(Default::default);
    let mut linker =
        Linker { file, unpack, counts, visit, lost, schemas, channels, unknown, messages_read: 0, message_records: 0 };
    let mut start = Vec::new();
    source.by_ref().take(mcap::MAGIC.len() as u64).read_to_end(&mut start)?;
    if start.is_empty() {
        return Err(Fault::Empty);
    }
    if !mcap::MAGIC.starts_with(&start) {
        return Err(Fault::NotMcap);
    }
    let read = if start.len() < mcap::MAGIC.len() { Err(Fault::Cut) } else { read_file(source, &mut linker) };
    match read {
        Err(fault @ (Fault::Cut | Fault::Corrupt(_))) => {
            (linker.lost)(linker.messages_read, fault);
            Ok(())
        }
        read => read,
    }
}

struct Linker<'a, 'v> {
    file: &'a str,
    /// Where messages are decompressed, if they are compressed.
    unpack: Option<(Budget, Vec<u8>)>,
    counts: &'a mut Counts,
    visit: &'a mut Visit<'v>,
    lost: &'a mut dyn FnMut(u64, Fault),
    schemas: HashMap<u16, Schema>,
    channels: HashMap<u16, Channel>,
    /// Channels of which it was said that their messages are lost.
    unknown: HashSet<u16>,
    messages_read: u64,
    /// All there are, also those that belong to no channel.
    message_records: u64,
}

impl Records for Linker<'_, '_> {
    fn record(&mut self, opcode: u8, body: &[u8]) -> Result<(), Fault> {
        let mut fields = Fields(body);
        let read = match opcode {
            op::SCHEMA => fields.schema().map(|(id, schema)| {
                self.schemas.insert(id, schema?);
                Ok(())
            }),
            op::CHANNEL => {
                fields.channel().map(|(id, schema, topic, encoding)| self.add_channel(id, schema, topic, encoding))
            }
            op::STATISTICS => fields.array().map(|count| {
                self.compare(u64::from_le_bytes(count));
                Ok(())
            }),
            _ => {
                self.message_records += 1;
                fields.message().map(|(id, log_time_ns)| self.message(id, log_time_ns, fields.0))
            }
        };
        read.unwrap_or_else(|| {
            let kind = match opcode {
                op::SCHEMA => "schema",
                op::CHANNEL => "channel",
                op::STATISTICS => "statistics",
                _ => "message",
            };
            Err(Fault::Corrupt(format!("a {kind} record is too short")))
        })
    }

    fn lost(&mut self, why: String) {
        (self.lost)(self.messages_read, Fault::Corrupt(why));
    }
}

impl Linker<'_, '_> {
    fn add_channel(&mut self, id: u16, schema_id: u16, topic: String, encoding: String) -> Result<(), Fault> {
        let none = Schema::default();
        let Some(schema) = self.schemas.get(&schema_id).or(Some(&none).filter(|_| schema_id == 0)) else {
            // The record that defined it is lost; those of others are as good as before.
            self.lost(format!("a topic has the unknown schema {schema_id}"));
            return Ok(());
        };
        let channel = self.counts.channel(topic, encoding, schema)?;
        let is_same = |known: &Channel| {
            known.topic == channel.topic
                && known.encoding == channel.encoding
                && known.message_type == channel.message_type
        };
        match self.channels.get(&id) {
            Some(known) if is_same(known) => {}
            Some(_) => return Err(Fault::Corrupt(format!("channel {id} is defined twice, as different topics"))),
            None => {
                self.channels.insert(id, channel);
            }
        }
        Ok(())
    }

    /// What was taken for something else than a message, or a chunk of them, shows in the number. Some tools copy chunks and count nothing.
    fn compare(&mut self, counted: u64) {
        let found = self.message_records;
        if found < counted {
            self.lost(format!("there are {found} messages where its statistics count {counted}"));
        }
    }

    fn message(&mut self, id: u16, log_time_ns: u64, data: &[u8]) -> Result<(), Fault> {
        let Some(channel) = self.channels.get(&id) else {
            if self.unknown.insert(id) {
                self.lost(format!("messages belong to the unknown channel {id}"));
            }
            return Ok(());
        };
        let data = match &mut self.unpack {
            None => data,
            Some((budget, unpacked)) => {
                if let Err(error) = budget.unpack_message(data, unpacked) {
                    self.lost(format!("a message cannot be decompressed: {error}"));
                    return Ok(());
                }
                unpacked
            }
        };
        BagMessage { file: self.file, channel, log_time_ns, data }.hand_to(self.visit)?;
        self.messages_read += 1;
        Ok(())
    }
}

/// The little-endian fields of a record, taken from its front; `None` where the bytes do not suffice.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*head)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn bytes(&mut self) -> Option<&'a [u8]> {
        let len = u32::from_le_bytes(self.array()?);
        let (head, rest) = self.0.split_at_checked(len.try_into().ok()?)?;
        self.0 = rest;
        Some(head)
    }

    fn string(&mut self) -> Option<String> {
        self.bytes().map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    /// Identifier, and the schema.
    fn schema(&mut self) -> Option<(u16, Result<Schema, Fault>)> {
        let id = self.u16()?;
        let (message_type, language, text) = (self.string()?, self.string()?, self.bytes()?);
        Some((id, Schema::new(message_type, &language, &String::from_utf8_lossy(text))))
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
