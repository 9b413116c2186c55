//! Which bags are meant, and how it shows that one is another now.

use std::collections::HashSet;
use std::fs::{self, DirEntry};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};

use crate::error::ReplayError;

/// A bag, and what its output shall be called.
#[derive(Debug, Clone)]
pub struct Input {
    /// Where it lies: a file, or the folder of a rosbag2 bag.
    pub path: PathBuf,
    /// What its output is called, without the ending.
    pub name: String,
    /// What it consists of, by name.
    pub files: Vec<InputFile>,
}

/// What tells a file from what it was before.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Where it lies.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// When it was last changed, in ns since the epoch.
    pub changed_ns: u64,
}

impl Input {
    /// Its size on the disk.
    pub fn bytes(&self) -> u64 {
        self.files.iter().map(|file| file.bytes).sum()
    }

    /// The bag at `path` as it is now.
    pub fn new(path: PathBuf, name: String) -> Self {
        let inside =
            |folder: &Path| fs::read_dir(folder).map(|entries| entries.flatten().map(|entry| entry.path()).collect());
        // What SQLite has not yet moved into the database belongs to it.
        let log = |end: &str| {
            let mut name = path.clone().into_os_string();
            name.push(end);
            PathBuf::from(name)
        };
        let mut paths: Vec<PathBuf> = if path.is_dir() {
            inside(&path).unwrap_or_default()
        } else {
            vec![path.clone(), log("-wal"), log("-journal")]
        };
        // SQLite keeps its place in the log there, and changes it whenever it reads.
        paths.retain(|path| !path.as_os_str().as_encoded_bytes().ends_with(b"-shm"));
        paths.sort();
        // What cannot be looked at cannot be read either, which is then said of the bag.
        let files = paths.into_iter().filter_map(|path| {
            let found = fs::metadata(&path).ok()?;
            let changed = found.modified().ok()?.duration_since(UNIX_EPOCH).unwrap_or_default();
            let changed_ns = u64::try_from(changed.as_nanos()).unwrap_or(u64::MAX);
            Some(InputFile { path, bytes: found.len(), changed_ns })
        });
        Self { files: files.collect(), path, name }
    }
}

/// The bags among the paths, and those in folders that are none themselves, by name. Names are unique.
///
/// # Errors
/// [`ReplayError::NoBag`], [`ReplayError::SameName`], and [`ReplayError::Io`] for what cannot be looked at.
pub fn find(paths: &[PathBuf]) -> Result<Vec<Input>, ReplayError> {
    let mut found = Vec::new();
    for path in paths {
        let before = found.len();
        if path.is_dir() && !is_bag_folder(path) {
            collect(path, "", &mut HashSet::new(), &mut found)?;
            if found.len() == before {
                return Err(ReplayError::NoBag { folder: path.clone() });
            }
        } else {
            let absolute = fs::canonicalize(path).map_err(ReplayError::io(path))?;
            found.push(Input::new(path.clone(), stem(&absolute)));
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    if let Some(pair) = found.windows(2).find(|pair| pair[0].name == pair[1].name) {
        let bags = [&pair[0].path, &pair[1].path].map(PathBuf::clone);
        return Err(ReplayError::SameName { bags, name: pair[0].name.clone() });
    }
    Ok(found)
}

fn is_bag_folder(folder: &Path) -> bool {
    folder.join("metadata.yaml").exists()
}

/// Links to bags are followed, and each bag is taken once, by its own name if that is found; other links to folders may lead anywhere.
fn collect(
    folder: &Path,
    prefix: &str,
    seen: &mut HashSet<PathBuf>,
    found: &mut Vec<Input>,
) -> Result<(), ReplayError> {
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let mut entries = entries.map_err(ReplayError::io(folder))?;
    let is_link = |entry: &DirEntry| entry.file_type().is_ok_and(|kind| kind.is_symlink());
    entries.sort_by_key(|entry| (is_link(entry), entry.file_name()));
    for entry in entries {
        let path = entry.path();
        let name = format!("{prefix}{}", stem(&path));
        if entry.file_name().as_encoded_bytes().starts_with(b".") {
            continue;
        }
        let is_bag = path.extension().is_some_and(|extension| extension == "mcap" || extension == "db3");
        let is_folder = path.is_dir();
        if is_folder && is_bag_folder(&path) || !is_folder && is_bag {
            // A link to nothing is a broken bag, and no reason to leave the others.
            if seen.insert(fs::canonicalize(&path).unwrap_or_else(|_| path.clone())) {
                found.push(Input::new(path, name));
            }
        } else if is_folder && !is_link(&entry) {
            collect(&path, &format!("{name}_"), seen, found)?;
        }
    }
    Ok(())
}

/// The name without `.mcap` or `.db3`; folders may have points in theirs.
fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let bare = name.strip_suffix(".mcap").or_else(|| name.strip_suffix(".db3")).unwrap_or(&name);
    bare.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_database_has_in_its_log_makes_it_another_bag() -> std::io::Result<()> {
        let folder = std::env::temp_dir().join(format!("reorder-inputs-{}", std::process::id()));
        fs::create_dir_all(&folder)?;
        let database = folder.join("x.db3");
        fs::write(&database, "database")?;
        let input = || Input::new(database.clone(), "x".into()).files;
        let before = input();
        assert_eq!(before.len(), 1);
        fs::write(folder.join("x.db3-wal"), "log")?;
        let with_log = input();
        assert_ne!(with_log, before);
        fs::write(folder.join("x.db3-wal"), "longer log")?;
        assert_ne!(input(), with_log);
        fs::remove_dir_all(&folder)
    }
    #[test]
    fn a_link_to_nothing_leaves_the_other_bags() -> std::io::Result<()> {
        let folder = std::env::temp_dir().join(format!("reorder-links-{}", std::process::id()));
        fs::create_dir_all(&folder)?;
        fs::write(folder.join("a.mcap"), "a bag")?;
        std::os::unix::fs::symlink(folder.join("gone"), folder.join("b.mcap"))?;
        let found =
            find(std::slice::from_ref(&folder)).map(|bags| bags.into_iter().map(|bag| bag.name).collect::<Vec<_>>());
        fs::remove_dir_all(&folder)?;
        assert_eq!(found.ok(), Some(vec!["a".to_owned(), "b".to_owned()]));
        Ok(())
    }
}
