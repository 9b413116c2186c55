//! Output that appears whole or not at all.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::BagError;

/// A file or folder in the making, inside a hidden temporary folder beside its destination (so that the last step is a rename
/// within one file system). Dropped before [`Pending::commit`], it vanishes.
pub(crate) struct Pending {
    folder: TempDir,
    inside: PathBuf,
    destination: PathBuf,
    /// Held as long as someone writes here.
    _lock: File,
}

const PREFIX: &str = ".pose-bag-";
const LOCK: &str = "lock";

/// Locked before it has its name, so that nobody ever sees it unlocked while it is in use.
fn lock(folder: &Path) -> std::io::Result<File> {
    let unnamed = folder.join("locking");
    let lock = File::create(&unnamed)?;
    lock.lock()?;
    fs::rename(unnamed, folder.join(LOCK))?;
    Ok(lock)
}

/// Removes what processes that were killed left of their output in a folder.
///
/// # Errors
/// Where the folder cannot be read, or what was left not be removed.
pub fn remove_abandoned(folder: impl AsRef<Path>) -> Result<(), BagError> {
    let label = folder.as_ref().display().to_string();
    let remove = || {
        for entry in fs::read_dir(folder.as_ref())? {
            let path = entry?.path();
            let is_ours = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(PREFIX.as_bytes()));
            // Without a lock it is about to get one, or was left in that very moment.
            if is_ours && File::open(path.join(LOCK)).is_ok_and(|lock| lock.try_lock().is_ok()) {
                fs::remove_dir_all(path)?;
            }
        }
        Ok(())
    };
    remove().map_err(BagError::io(label))
}

impl Pending {
    pub(crate) fn new(destination: &Path) -> Result<Self, BagError> {
        let parent = match destination.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let name = destination.file_name().ok_or_else(|| BagError::Write {
            file: destination.display().to_string(),
            reason: "the path ends in no name".into(),
        })?;
        let label = || destination.display().to_string();
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(parent).map_err(BagError::io(label()))?;
        let lock = lock(folder.path()).map_err(BagError::io(label()))?;
        let inside = folder.path().join("whole").join(name);
        fs::create_dir(folder.path().join("whole")).map_err(BagError::io(label()))?;
        Ok(Self { inside, folder, destination: destination.to_path_buf(), _lock: lock })
    }

    /// Where to write for now; has the name of the destination.
    pub(crate) fn path(&self) -> &Path {
        &self.inside
    }

    /// What to call it in an error.
    pub(crate) fn label(&self) -> String {
        self.destination.display().to_string()
    }

    /// Puts it in its place once it is on the disk: neither a process that is killed nor a power cut leaves half of it there.
    pub(crate) fn commit(self) -> Result<(), BagError> {
        let label = self.label();
        let put = || {
            if self.inside.is_dir() {
                for entry in fs::read_dir(&self.inside)? {
                    File::open(entry?.path())?.sync_all()?;
                }
            }
            File::open(&self.inside)?.sync_all()?;
            fs::rename(&self.inside, &self.destination)?;
            let parent = self.folder.path().parent().unwrap_or(Path::new("."));
            File::open(parent)?.sync_all()
        };
        put().map_err(BagError::io(&label))?;
        self.folder.close().map_err(BagError::io(label))
    }
}

/// Writes a text file whole or not at all; an existing one is replaced.
pub(crate) fn write_text(
    destination: &Path,
    body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), BagError> {
    let pending = Pending::new(destination)?;
    let written = fs::File::create(pending.path()).and_then(|file| {
        let mut writer = BufWriter::new(file);
        body(&mut writer)?;
        writer.flush()
    });
    written.map_err(BagError::io(pending.label()))?;
    pending.commit()
}
