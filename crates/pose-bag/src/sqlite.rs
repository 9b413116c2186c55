//! Messages of an SQLite file (`.db3`), the storage of rosbag2 before MCAP.
//!
//! The file is not trusted: what looks like its tables could be views that never end. They have to be tables, rows have to come in
//! the order of their numbers and to hold no more bytes than the file and its log, and the work is limited by its size.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};

use rusqlite::limits::Limit;
use rusqlite::{Connection, ErrorCode, OpenFlags};
use tempfile::TempDir;

use crate::bounded::{Budget, MAX_MESSAGE_BYTES};
use crate::channel::{BagMessage, Channel, Counts, Schema, Visit};
use crate::mcap_records::Fault;

/// What every SQLite file begins with.
pub(crate) const MAGIC: &[u8] = b"SQLite format 3\0";

/// Name of a copy.
const COPY: &str = "copy.db3";
const MAX_TOPICS: usize = 10_000;
/// Steps of SQLite's machine between two looks at how many there were.
const STEPS_AT_ONCE: i32 = 10_000;
/// A scan takes ten steps a row, and a row takes ten bytes at least.
const STEPS_PER_BYTE: u64 = 16;
const STEPS_ALWAYS: u64 = 10_000_000;

/// Hands on every message, in the order of recording; as [`read_mcap`](crate::mcap_messages::read_mcap). With `packed_messages` each
/// is compressed by itself.
pub(crate) fn read_sqlite(
    path: &Path,
    packed_messages: bool,
    file: &str,
    counts: &mut Counts,
    visit: &mut Visit<'_>,
    lost: &mut dyn FnMut(u64, Fault),
) -> Result<(), Fault> {
    let mut reader = Reader { file, packed_messages, messages_read: 0, visit, lost };
    match reader.read(path, counts) {
        Err(fault @ Fault::Corrupt(_)) => {
            (reader.lost)(reader.messages_read, fault);
            Ok(())
        }
        read => read,
    }
}

struct Reader<'a, 'v> {
    file: &'a str,
    packed_messages: bool,
    messages_read: u64,
    visit: &'a mut Visit<'v>,
    lost: &'a mut dyn FnMut(u64, Fault),
}

impl Reader<'_, '_> {
    fn read(&mut self, path: &Path, counts: &mut Counts) -> Result<(), Fault> {
        let main_size = fs::metadata(path)?.len();
        let whole_pages = whole_pages(path, main_size)?;
        // What a killed recorder wrote is in its log for the most part.
        let size = main_size.saturating_add(log_size(path));
        let copy = whole_pages.as_ref().map(|folder| folder.path().join(COPY));
        let database = open(copy.as_deref().unwrap_or(path), size)?;
        for table in ["topics", "messages"] {
            // A virtual table has no page of its own.
            let is_table = "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND rootpage > 0 AND name = ?1";
            let found: i64 = database.query_row(is_table, [table], |row| row.get(0))?;
            if found != 1 {
                return Err(Fault::Corrupt(format!("there is no table {table}")));
            }
        }
        let channels = channels(&database, counts)?;
        let mut statement = database.prepare("SELECT rowid, topic_id, timestamp, data FROM messages NOT INDEXED")?;
        let mut rows = statement.query([])?;
        let (mut last, mut bytes) = (i64::MIN, 0);
        let (mut budget, mut unpacked) = (Budget::default(), Vec::new());
        while let Some(row) = rows.next()? {
            let (number, topic, time_ns): (i64, i64, i64) = (row.get(0)?, row.get(1)?, row.get(2)?);
            let data =
                row.get_ref(3)?.as_blob().map_err(|_| Fault::Corrupt(format!("message {number} holds no bytes")))?;
            bytes += data.len() as u64;
            if number < last || bytes > size {
                return Err(Fault::Corrupt("its pages contradict each other".into()));
            }
            last = number;
            let Some(channel) = channels.get(&topic) else {
                return Err(Fault::Corrupt(format!("a message belongs to the unknown topic {topic}")));
            };
            let data = if self.packed_messages {
                if let Err(error) = budget.unpack_message(data, &mut unpacked) {
                    let why = format!("message {number} cannot be decompressed: {error}");
                    (self.lost)(self.messages_read, Fault::Corrupt(why));
                    continue;
                }
                &unpacked
            } else {
                data
            };
            let log_time_ns = u64::try_from(time_ns).unwrap_or(0);
            BagMessage { file: self.file, channel, log_time_ns, data }.hand_to(self.visit)?;
            self.messages_read += 1;
        }
        // Where it held a message that is missed, that was said already.
        if whole_pages.is_some() {
            (self.lost)(self.messages_read, Fault::Corrupt("its last page is cut off".into()));
        }
        Ok(())
    }
}

/// A folder with a copy without the last page where that is cut: SQLite would fill it up with zeros, and a message with it.
/// The log is beside it, where SQLite looks for it.
fn whole_pages(path: &Path, size: u64) -> Result<Option<TempDir>, Fault> {
    let mut file = File::open(path)?;
    let mut start = [0; MAGIC.len() + 2];
    if size == 0 {
        return Err(Fault::Corrupt("it is empty".into()));
    }
    if size < start.len() as u64 {
        return Err(Fault::Corrupt("it is not an SQLite file".into()));
    }
    file.read_exact(&mut start)?;
    // 1 stands for 65536, which two bytes do not hold.
    let page = match u16::from_be_bytes([start[MAGIC.len()], start[MAGIC.len() + 1]]) {
        1 => 1 << 16,
        page => u64::from(page).max(512),
    };
    if size.is_multiple_of(page) {
        return Ok(None);
    }
    file.rewind()?;
    let folder = tempfile::tempdir()?;
    let copy = folder.path().join(COPY);
    io::copy(&mut file.take(size / page * page), &mut File::create(&copy)?)?;
    if log_size(path) > 0 {
        fs::copy(log_of(path), log_of(&copy))?;
    }
    Ok(Some(folder))
}

/// The write-ahead log beside a file.
fn log_of(path: &Path) -> PathBuf {
    let mut log = path.as_os_str().to_owned();
    log.push("-wal");
    log.into()
}

fn log_size(path: &Path) -> u64 {
    fs::metadata(log_of(path)).map_or(0, |log| log.len())
}

fn open(path: &Path, size: u64) -> Result<Connection, Fault> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
    // Immutable, nothing is written beside the file. A log that a recorder could not merge any more is read along with it.
    // What follows two slashes would be taken for a host.
    let mut name = String::from(if path.is_absolute() { "file://" } else { "file:" });
    for &byte in path.as_os_str().as_encoded_bytes() {
        // SQLite takes names as they are but for what has a meaning in a URI.
        match byte {
            b'%' | b'?' | b'#' | 0x80.. => name += &format!("%{byte:02x}"),
            plain => name.push(plain.into()),
        }
    }
    name += if log_size(path) > 0 { "?mode=ro" } else { "?immutable=1" };
    let mut database = Connection::open_with_flags(name, flags)?;
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, MAX_MESSAGE_BYTES as i32)?;
    // With a schema that may be written, here for reading only, a file that is cut off is read up to where it ends.
    database.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA writable_schema = ON;")?;
    let (mut steps, most) = (0, STEPS_ALWAYS.saturating_add(size.saturating_mul(STEPS_PER_BYTE)));
    let is_too_much = move || {
        steps += STEPS_AT_ONCE.unsigned_abs() as u64;
        steps > most
    };
    database.progress_handler(STEPS_AT_ONCE, Some(is_too_much))?;
    Ok(database)
}

fn channels(database: &Connection, counts: &mut Counts) -> Result<HashMap<i64, Channel>, Fault> {
    let schemas = schemas(database)?;
    let mut statement = database.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let mut rows = statement.query([])?;
    let mut channels = HashMap::new();
    while let Some(row) = rows.next()? {
        if channels.len() == MAX_TOPICS {
            return Err(Fault::Corrupt(format!("it has more than {MAX_TOPICS} topics")));
        }
        let (id, topic, message_type, encoding): (i64, String, String, String) =
            (row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?);
        let bare = Schema::new(message_type, "", "")?;
        let schema = schemas.get(&bare.message_type).unwrap_or(&bare);
        channels.insert(id, counts.channel(topic, encoding, schema)?);
    }
    Ok(channels)
}

/// The definitions by type, which bags before ROS 2 Iron do not hold.
fn schemas(database: &Connection) -> Result<HashMap<String, Schema>, Fault> {
    let mut schemas = HashMap::new();
    let definitions = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions";
    let Ok(mut statement) = database.prepare(definitions) else { return Ok(schemas) };
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()?.filter(|_| schemas.len() < MAX_TOPICS) {
        let (message_type, language, text): (String, String, String) = (row.get(0)?, row.get(1)?, row.get(2)?);
        let schema = Schema::new(message_type, &language, &text)?;
        schemas.insert(schema.message_type.clone(), schema);
    }
    Ok(schemas)
}

impl From<rusqlite::Error> for Fault {
    fn from(error: rusqlite::Error) -> Self {
        Self::Corrupt(match error.sqlite_error_code() {
            Some(ErrorCode::OperationInterrupted) => "reading it takes more work than its size explains".into(),
            Some(ErrorCode::DatabaseCorrupt) => "its pages are damaged or missing".into(),
            Some(ErrorCode::NotADatabase) => "it is not an SQLite file".into(),
            Some(ErrorCode::SystemIoFailure | ErrorCode::DiskFull | ErrorCode::CannotOpen) => {
                return Self::Io(io::Error::other(error));
            }
            _ => error.to_string(),
        })
    }
}
