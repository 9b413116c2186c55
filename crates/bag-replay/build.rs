//! Names the sources that results depend on by a hash, so that outputs which an older program made are made anew.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::{env, fs};

const CRATES: [&str; 6] = ["se3-geom", "reorder", "manipulator", "pose-bag", "planner", "bag-replay"];

fn main() {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut hasher = DefaultHasher::new();
    env::var("CARGO_PKG_VERSION").unwrap_or_default().hash(&mut hasher);
    for name in CRATES {
        let folder = here.with_file_name(name).join("src");
        println!("cargo::rerun-if-changed={}", folder.display());
        take_in(&folder, &mut hasher);
    }
    println!("cargo::rustc-env=REORDER_SOURCES={:016x}", hasher.finish());
}

/// A crate that is not beside this one counts by its version, which is this one's.
fn take_in(folder: &Path, hasher: &mut DefaultHasher) {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            take_in(&path, hasher);
        } else if let Ok(content) = fs::read(&path) {
            path.file_name().hash(hasher);
            content.hash(hasher);
        }
    }
}
