//! Writing bags.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufWriter, Read, Write};
use std::path::Path;

use mcap::records::MessageHeader;

use crate::BagError;
use crate::cdr::encode;
use crate::metadata::{Document, METADATA_FILE, Metadata, QosProfile, TopicCount, TopicMetadata};
use crate::msg::Message;
use crate::pending::Pending;

const ENCODING: &str = "cdr";

/// How the chunks of a bag are stored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Compression {
    /// As they are.
    None,
    /// By zstd.
    #[default]
    Zstd,
    /// By lz4.
    Lz4,
}

/// The quality of service a topic is recorded with; a player offers it again. Both are reliable.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum OfferedQos {
    /// Keep the last ten, for whoever listens.
    #[default]
    Volatile,
    /// Keep the last one, also for whoever comes later.
    TransientLocal,
}

impl OfferedQos {
    fn profiles(self) -> Vec<QosProfile> {
        vec![match self {
            Self::Volatile => QosProfile::reliable(10, "volatile"),
            Self::TransientLocal => QosProfile::reliable(1, "transient_local"),
        }]
    }
}

/// Writes a rosbag2 bag: the folder `NAME` with `NAME_0.mcap` and `metadata.yaml`, or one MCAP file where the path ends in
/// `.mcap`. Nothing is seen of it before [`BagWriter::finish`], and nothing stays where it is dropped without.
///
/// ```
/// use pose_bag::{BagWriter, msg::{Header, PoseArray, Time}, read_poses};
/// use se3_geom::pose_from_xyzw;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// let poses = [pose_from_xyzw([0.4, 0.1, 0.3], [1.0, 0.0, 0.0, 0.0])?];
/// let header = Header { stamp: Time { sec: 5, nanosec: 0 }, frame_id: "base_link".into() };
/// let path = folder.path().join("scan");
/// let mut bag = BagWriter::create(&path)?;
/// bag.write("/poses", 5_000_000_000, &PoseArray { header, poses: poses.iter().map(Into::into).collect() })?;
/// bag.finish()?;
/// assert_eq!(read_poses(&path, None)?[0].poses, poses);
/// # Ok(()) }
/// ```
pub struct BagWriter {
    pending: Pending,
    /// Name of the MCAP file inside the folder; `None` where the bag is that file alone.
    file_in_folder: Option<String>,
    writer: mcap::Writer<BufWriter<File>>,
    topics: Vec<Topic>,
    span_ns: Option<(u64, u64)>,
}

struct Topic {
    name: String,
    message_type: &'static str,
    type_hash: &'static str,
    qos: OfferedQos,
    channel_id: u16,
    messages: u32,
}

impl BagWriter {
    /// A new bag, its chunks compressed by zstd.
    ///
    /// # Errors
    /// Where the folder exists already (a single MCAP file is replaced) or cannot be made.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, BagError> {
        Self::create_with(path, Compression::default())
    }

    /// A new bag with the compression chosen.
    ///
    /// # Errors
    /// As [`BagWriter::create`].
    pub fn create_with(path: impl AsRef<Path>, compression: Compression) -> Result<Self, BagError> {
        Self::create_by(path, compression, None)
    }

    /// As [`BagWriter::create_with`]; the file's header names what wrote it, for [`library_of`].
    ///
    /// # Errors
    /// As [`BagWriter::create`].
    pub fn create_by(
        path: impl AsRef<Path>,
        compression: Compression,
        library: Option<&str>,
    ) -> Result<Self, BagError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let is_one_file = path.extension().is_some_and(|extension| extension == "mcap");
        if !is_one_file && path.exists() || path.is_dir() {
            return Err(BagError::AlreadyExists { file });
        }
        let pending = Pending::new(path)?;
        let (file_in_folder, mcap_path) = if is_one_file {
            (None, pending.path().to_path_buf())
        } else {
            fs::create_dir(pending.path()).map_err(BagError::io(&file))?;
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let file_name = format!("{name}_0.mcap");
            let mcap_path = pending.path().join(&file_name);
            (Some(file_name), mcap_path)
        };
        let opened = File::create(mcap_path).map_err(BagError::io(&file))?;
        let compression = match compression {
            Compression::None => None,
            Compression::Zstd => Some(mcap::Compression::Zstd),
            Compression::Lz4 => Some(mcap::Compression::Lz4),
        };
        // No worker threads: bags of poses are small.
        let mut options = mcap::WriteOptions::new().profile("ros2").compression(compression).compression_threads(0);
        if let Some(library) = library {
            options = options.library(library);
        }
        let writer = options.create(BufWriter::new(opened)).map_err(refused(&pending))?;
        Ok(Self { pending, file_in_folder, writer, topics: Vec::new(), span_ns: None })
    }

    /// Declares a topic, so that it is in the bag even without messages, or with another quality of service than
    /// [`OfferedQos::Volatile`]. Declaring it again changes nothing.
    ///
    /// # Errors
    /// [`BagError::TopicType`] where it is declared with another type already.
    pub fn add_topic<M: Message>(&mut self, topic: &str, qos: OfferedQos) -> Result<(), BagError> {
        self.topic_index::<M>(topic, qos).map(|_| ())
    }

    /// Writes a message, recorded at `log_time_ns` since the epoch, and declares its topic if need be.
    ///
    /// # Errors
    /// [`BagError::TopicType`] where the topic has another type, [`BagError::Write`] where the disk refuses.
    pub fn write<M: Message>(&mut self, topic: &str, log_time_ns: u64, message: &M) -> Result<(), BagError> {
        let index = self.topic_index::<M>(topic, OfferedQos::default())?;
        let data = encode(message).map_err(|error| refused(&self.pending)(error))?;
        let topic = &mut self.topics[index];
        let header = MessageHeader {
            channel_id: topic.channel_id,
            sequence: topic.messages,
            log_time: log_time_ns,
            publish_time: log_time_ns,
        };
        self.writer.write_to_known_channel(&header, &data).map_err(refused(&self.pending))?;
        topic.messages += 1;
        let (first, last) = self.span_ns.unwrap_or((log_time_ns, log_time_ns));
        self.span_ns = Some((first.min(log_time_ns), last.max(log_time_ns)));
        Ok(())
    }

    /// Completes the bag and puts it in its place.
    ///
    /// # Errors
    /// Where the disk refuses, or something has taken the place meanwhile.
    pub fn finish(mut self) -> Result<(), BagError> {
        self.writer.finish().map_err(refused(&self.pending))?;
        self.writer.into_inner().flush().map_err(BagError::io(self.pending.label()))?;
        if let Some(file_name) = self.file_in_folder {
            let topics = self.topics.iter().map(Topic::count).collect();
            let metadata = Metadata::of_one_file(file_name, self.span_ns, topics);
            let yaml = serde_yaml::to_string(&Document { rosbag2_bagfile_information: metadata })
                .map_err(refused(&self.pending))?;
            fs::write(self.pending.path().join(METADATA_FILE), yaml).map_err(BagError::io(self.pending.label()))?;
        }
        self.pending.commit()
    }

    fn topic_index<M: Message>(&mut self, name: &str, qos: OfferedQos) -> Result<usize, BagError> {
        if let Some(index) = self.topics.iter().position(|topic| topic.name == name) {
            let declared = self.topics[index].message_type;
            return if declared == M::TYPE {
                Ok(index)
            } else {
                Err(BagError::TopicType {
                    file: self.pending.label(),
                    topic: name.into(),
                    declared: declared.into(),
                    written: M::TYPE.into(),
                })
            };
        }
        let qos_yaml = serde_yaml::to_string(&qos.profiles()).map_err(refused(&self.pending))?;
        let metadata = BTreeMap::from([
            ("offered_qos_profiles".to_owned(), qos_yaml),
            ("topic_type_hash".to_owned(), M::TYPE_HASH.to_owned()),
        ]);
        let channel_id = self
            .writer
            .add_schema(M::TYPE, "ros2msg", M::DEFINITION.as_bytes())
            .and_then(|schema_id| self.writer.add_channel(schema_id, name, ENCODING, &metadata))
            .map_err(refused(&self.pending))?;
        self.topics.push(Topic {
            name: name.into(),
            message_type: M::TYPE,
            type_hash: M::TYPE_HASH,
            qos,
            channel_id,
            messages: 0,
        });
        Ok(self.topics.len() - 1)
    }
}

impl Topic {
    fn count(&self) -> TopicCount {
        TopicCount {
            topic_metadata: TopicMetadata {
                name: self.name.clone(),
                r#type: self.message_type,
                serialization_format: ENCODING,
                offered_qos_profiles: self.qos.profiles(),
                type_description_hash: self.type_hash,
            },
            message_count: self.messages.into(),
        }
    }
}

fn refused<E: std::fmt::Display>(pending: &Pending) -> impl FnOnce(E) -> BagError {
    let file = pending.label();
    move |error| BagError::Write { file, reason: error.to_string() }
}

/// What wrote an MCAP file, by the first bytes of it; `None` where it is no such file, or cannot be read.
pub fn library_of(path: impl AsRef<Path>) -> Option<String> {
    let mut start = Vec::new();
    File::open(path).ok()?.take(LONGEST_HEADER).read_to_end(&mut start).ok()?;
    // Behind the magic, the kind of the record and its length stand two strings, each behind its length: profile and library.
    let record = start.strip_prefix(mcap::MAGIC)?.strip_prefix(&[mcap::records::op::HEADER])?.get(8..)?;
    let (_, rest) = prefixed(record)?;
    let (library, _) = prefixed(rest)?;
    String::from_utf8(library.to_vec()).ok()
}

/// Far more than both strings of a header are.
const LONGEST_HEADER: u64 = 4096;

fn prefixed(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}
