//! Messages out of bags, one at a time.

use std::collections::BTreeMap;
use std::io::{self, BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use crate::BagError;
use crate::bounded::unpack_file;
use crate::channel::{BagMessage, Counts};
use crate::mcap_messages::{has_magic, read_mcap};
use crate::mcap_records::Fault;
use crate::metadata::{Packed, Storage, open_regular, stored_in};
use crate::sqlite::{self, read_sqlite};

/// Damages of a bag that are told one by one.
const MAX_LOSSES: usize = 100;

/// A bag: the folder of a rosbag2 bag (MCAP or SQLite, also split and compressed), one MCAP file, or one `.db3` file.
///
/// Whatever its size, one chunk or message of it is in memory at a time.
///
/// ```
/// use pose_bag::{BagReader, msg::PoseArray};
/// # fn main() -> Result<(), pose_bag::BagError> {
/// # let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/lasa_sine");
/// let bag = BagReader::open(folder)?;
/// let mut poses = 0;
/// let losses = bag.for_each(&mut |message| {
///     if message.message_type() == "geometry_msgs/msg/PoseArray" {
///         poses += message.decode::<PoseArray>()?.poses.len();
///     }
///     Ok(())
/// })?;
/// assert!(poses > 100 && losses.is_empty());
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct BagReader {
    name: String,
    files: Vec<PathBuf>,
    storage: Storage,
    packed: Packed,
}

impl BagReader {
    /// Looks at the folder's `metadata.yaml`, or the first bytes of the file.
    ///
    /// # Errors
    /// [`BagError`] where it is no bag.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, BagError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        if path.is_dir() {
            let stored = stored_in(path)?;
            return Ok(Self { name, files: stored.files, storage: stored.storage, packed: stored.packed });
        }
        let storage = match Self::storage_of(path)? {
            Some(storage) => storage,
            None if path.extension().is_some_and(|extension| extension == "mcap") => Storage::Mcap,
            None if path.extension().is_some_and(|extension| extension == "db3") => Storage::Sqlite,
            None => return Err(BagError::UnknownFormat { file: name }),
        };
        Ok(Self { name, files: vec![path.to_path_buf()], storage, packed: Packed::Nothing })
    }

    /// What the first bytes of a file say.
    pub(crate) fn storage_of(path: &Path) -> Result<Option<Storage>, BagError> {
        storage_in(path).map_err(BagError::io(path.display().to_string()))
    }

    /// What it was opened as.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its MCAP or SQLite files, in the order of recording.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Hands every message to `visit`, file after file, in the order in which they were recorded. What `visit` refuses ends it.
    ///
    /// What is damaged or cut off is passed over as far as the rest can be told apart from it; the answer says what was lost, and
    /// is empty for a whole bag. [`BagError::is_loss`] is true of all of it, and [`BagError::may_pass`] of what is not lost for good.
    ///
    /// # Errors
    /// What `visit` returned, or where the only file is no bag at all.
    pub fn for_each(
        &self,
        visit: &mut dyn FnMut(&BagMessage<'_>) -> Result<(), BagError>,
    ) -> Result<Vec<BagError>, BagError> {
        let mut counts = Counts::default();
        let mut losses = Vec::new();
        for path in &self.files {
            let file = path.display().to_string();
            let mut lost = |messages_read, fault| {
                let loss = named(&file, messages_read, fault);
                let is_known = losses.last().is_some_and(|last: &BagError| last.to_string() == loss.to_string());
                if losses.len() < MAX_LOSSES && !is_known {
                    losses.push(loss);
                }
            };
            match self.read_file(path, &file, &mut counts, visit, &mut lost) {
                Ok(()) => {}
                Err(Fault::Visit(error)) => return Err(error),
                // Of a split bag the other files are still worth something.
                Err(fault) if self.files.len() > 1 => lost(0, as_loss(fault)),
                Err(fault) => return Err(named(&file, 0, fault)),
            }
        }
        Ok(losses)
    }

    fn read_file(
        &self,
        path: &Path,
        file: &str,
        counts: &mut Counts,
        visit: &mut dyn FnMut(&BagMessage<'_>) -> Result<(), BagError>,
        lost: &mut dyn FnMut(u64, Fault),
    ) -> Result<(), Fault> {
        let opened = open_regular(path)?;
        let size = opened.metadata()?.len();
        let mut source = BufReader::with_capacity(1 << 16, opened);
        let packed_messages = self.packed == Packed::Messages;
        // rosbag2 leaves the last file of a recording that was killed as it is.
        let is_packed = self.packed == Packed::Files && storage_in(path)?.is_none();
        match (self.storage, is_packed) {
            (Storage::Mcap, false) => read_mcap(&mut source, packed_messages, file, counts, visit, lost),
            (Storage::Sqlite, false) => read_sqlite(path, packed_messages, file, counts, visit, lost),
            (storage, true) => {
                let mut whole = tempfile::NamedTempFile::new()?;
                let is_whole = match unpack_file(&mut source, size, &mut whole) {
                    Err(damage @ Fault::Corrupt(_)) => {
                        lost(0, damage);
                        false
                    }
                    unpacked => unpacked.map(|()| true)?,
                };
                whole.rewind()?;
                let read = match storage {
                    Storage::Mcap => read_mcap(&mut BufReader::new(whole), false, file, counts, visit, lost),
                    Storage::Sqlite => read_sqlite(whole.path(), false, file, counts, visit, lost),
                };
                match read {
                    // What came out before the damage need not even begin like a bag.
                    Err(Fault::NotMcap | Fault::Empty) if !is_whole => Ok(()),
                    read => read,
                }
            }
        }
    }

    /// Type of the messages of every topic that has messages, and what is lost, as [`BagReader::for_each`] says.
    ///
    /// # Errors
    /// As [`BagReader::for_each`].
    pub fn topics(&self) -> Result<(BTreeMap<String, String>, Vec<BagError>), BagError> {
        let mut topics = BTreeMap::new();
        let losses = self.for_each(&mut |message| {
            if message.index() == 0 {
                topics.insert(message.topic().to_owned(), message.message_type().to_owned());
            }
            Ok(())
        })?;
        Ok((topics, losses))
    }
}

fn storage_in(path: &Path) -> io::Result<Option<Storage>> {
    let mut start = Vec::new();
    open_regular(path)?.take(sqlite::MAGIC.len() as u64).read_to_end(&mut start)?;
    Ok(if has_magic(&start) {
        Some(Storage::Mcap)
    } else {
        start.starts_with(sqlite::MAGIC).then_some(Storage::Sqlite)
    })
}

/// A file of a bag that has others is damaged where it alone would be no bag.
fn as_loss(fault: Fault) -> Fault {
    match fault {
        Fault::Empty => Fault::Corrupt("it is empty".into()),
        Fault::NotMcap => Fault::Corrupt("its first bytes are not the MCAP magic".into()),
        other => other,
    }
}

fn named(file: &str, messages_read: u64, fault: Fault) -> BagError {
    let file = file.to_owned();
    match fault {
        Fault::Empty => BagError::Empty { file },
        Fault::NotMcap => BagError::NotMcap { file },
        Fault::Cut => BagError::Truncated { file, messages_read },
        Fault::Corrupt(reason) => BagError::Corrupt { file, messages_read, reason },
        Fault::Io(source) => BagError::Io { file, source },
        Fault::Visit(error) => error,
    }
}
