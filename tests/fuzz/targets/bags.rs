//! Any bytes as an SQLite file, and as the metadata of a bag: an error, or poses.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pose_bag::{BagReader, Selection, recover_poses};

fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir().expect("a folder");
    if bytes.starts_with(b"SQLite") {
        let path = folder.path().join("bag.db3");
        std::fs::write(&path, bytes).expect("a file");
        let _ = recover_poses(&path, &Selection::default());
    } else {
        std::fs::write(folder.path().join("metadata.yaml"), bytes).expect("a file");
        let _ = BagReader::open(folder.path());
    }
});
