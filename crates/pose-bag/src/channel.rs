//! Messages as they were recorded, with what is known about their topic.

use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;

use crate::BagError;
use crate::cdr::decode;
use crate::mcap_records::Fault;
use crate::msg::{Message, definition};
use crate::schema::difference;

/// Where messages come from.
pub(crate) struct Channel {
    pub(crate) topic: String,
    /// Name of the type, empty for a channel without one.
    pub(crate) message_type: String,
    pub(crate) encoding: String,
    /// How the bag's own definition of a type that is read here differs from ours.
    pub(crate) difference: Option<String>,
    /// Messages of the topic so far, in all files and channels.
    messages: Rc<Cell<usize>>,
}

/// The type of messages, as the bag defines it.
#[derive(Default)]
pub(crate) struct Schema {
    pub(crate) message_type: String,
    difference: Option<String>,
}

impl Schema {
    /// With the definition in the bag and the language that it is in.
    pub(crate) fn new(message_type: String, language: &str, text: &str) -> Result<Self, Fault> {
        let ours = definition(&message_type).filter(|_| language == "ros2msg" && !text.is_empty());
        let difference = ours.and_then(|ours| difference(&message_type, text, ours));
        Ok(Self { message_type: named(message_type)?, difference })
    }
}

/// Longer than any name in ROS; thousands of longer ones would fill the memory.
const MAX_NAME_BYTES: usize = 1024;

fn named(name: String) -> Result<String, Fault> {
    match name.len() {
        0..=MAX_NAME_BYTES => Ok(name),
        len => Err(Fault::Corrupt(format!("a topic, type or encoding has a name of {len} bytes"))),
    }
}

/// How often each topic spoke so far, over the files of a bag.
#[derive(Default)]
pub(crate) struct Counts(HashMap<String, Rc<Cell<usize>>>);

impl Counts {
    pub(crate) fn channel(&mut self, topic: String, encoding: String, schema: &Schema) -> Result<Channel, Fault> {
        let (topic, encoding) = (named(topic)?, named(encoding)?);
        let messages = self.0.entry(topic.clone()).or_default().clone();
        let Schema { message_type, difference } = schema;
        Ok(Channel { topic, message_type: message_type.clone(), encoding, difference: difference.clone(), messages })
    }
}

/// Who is handed the messages, in the order in which they were recorded.
pub(crate) type Visit<'a> = dyn FnMut(&BagMessage<'_>) -> Result<(), BagError> + 'a;

/// One recorded message.
pub struct BagMessage<'a> {
    pub(crate) file: &'a str,
    pub(crate) channel: &'a Channel,
    pub(crate) log_time_ns: u64,
    pub(crate) data: &'a [u8],
}

impl BagMessage<'_> {
    pub(crate) fn hand_to(&self, visit: &mut Visit<'_>) -> Result<(), Fault> {
        visit(self).map_err(Fault::Visit)?;
        self.channel.messages.set(self.index() + 1);
        Ok(())
    }

    /// The topic.
    pub fn topic(&self) -> &str {
        &self.channel.topic
    }

    /// Name of the type, such as `geometry_msgs/msg/PoseArray`.
    pub fn message_type(&self) -> &str {
        &self.channel.message_type
    }

    /// When it was recorded, in nanoseconds since the epoch.
    pub fn log_time_ns(&self) -> u64 {
        self.log_time_ns
    }

    /// Which message of its topic it is, from 0.
    pub fn index(&self) -> usize {
        self.channel.messages.get()
    }

    /// Its bytes, without compression.
    pub fn data(&self) -> &[u8] {
        self.data
    }

    /// The message in the bytes.
    ///
    /// # Errors
    /// Where it is of another type, its definition in the bag has other fields than `M`, or its bytes do not follow it.
    pub fn decode<M: Message>(&self) -> Result<M, BagError> {
        let (file, topic) = (self.file.to_owned(), self.topic().to_owned());
        let Channel { message_type, encoding, difference, .. } = self.channel;
        if encoding != "cdr" {
            return Err(BagError::MessageEncoding { file, topic, encoding: encoding.clone() });
        }
        if message_type != M::TYPE {
            return Err(BagError::WrongType { file, topic, expected: M::TYPE, found: message_type.clone() });
        }
        if let Some(difference) = difference {
            let (message_type, difference) = (message_type.clone(), difference.clone());
            return Err(BagError::OtherDefinition { file, topic, message_type, difference });
        }
        decode(self.data).map_err(|reason| BagError::Cdr { file, topic, message: self.index(), reason })
    }
}
