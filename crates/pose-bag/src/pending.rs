//! Output that appears whole or not at all.

use std::fs;
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
        let folder = tempfile::Builder::new()
            .prefix(".pose-bag-")
            .tempdir_in(parent)
            .map_err(BagError::io(destination.display().to_string()))?;
        Ok(Self { inside: folder.path().join(name), folder, destination: destination.to_path_buf() })
    }

    /// Where to write for now; has the name of the destination.
    pub(crate) fn path(&self) -> &Path {
        &self.inside
    }

    /// What to call it in an error.
    pub(crate) fn label(&self) -> String {
        self.destination.display().to_string()
    }

    pub(crate) fn commit(self) -> Result<(), BagError> {
        fs::rename(&self.inside, &self.destination).map_err(BagError::io(self.label()))?;
        let label = self.label();
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
