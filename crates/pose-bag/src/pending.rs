//! Output that appears whole or not at all.

use std::fs::{self, File};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::BagError;

/// A file or folder in the making, inside a hidden temporary folder beside its destination (so that the last step is a rename
/// within one file system). Dropped before [`Pending::commit`], it vanishes.
pub(crate) struct Pending {
    folder: TempDir,
    inside: PathBuf,
    destination: PathBuf,
    /// Of the folder: held as long as someone writes here.
    _lock: File,
}

const PREFIX: &str = ".pose-bag-";

/// A new folder, locked. One that is removed as abandoned before it is locked is made again.
fn locked_folder(parent: &Path) -> std::io::Result<(TempDir, File)> {
    loop {
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(parent)?;
        let lock = match File::open(folder.path()) {
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            opened => opened?,
        };
        // Where the file system knows no locks, nothing is ever removed as abandoned either.
        if lock.lock().is_err() || folder.path().exists() {
            return Ok((folder, lock));
        }
    }
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
            let opened = if is_ours { File::open(&path).ok() } else { None };
            // The lock is kept until it is gone.
            if let Some(_lock) = opened.filter(|lock| lock.try_lock().is_ok()) {
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
        let (folder, lock) = locked_folder(parent).map_err(BagError::io(label()))?;
        let inside = folder.path().join(name);
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
