//! Any bytes as an MCAP file: an error, or poses; what is read strictly is what is recovered without loss.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pose_bag::{Selection, read_poses, recover_poses};

fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bag.mcap");
    std::fs::write(&path, bytes).expect("a file");
    let strict = read_poses(&path, None);
    match recover_poses(&path, &Selection::default()) {
        Ok((sets, losses)) => assert_eq!(losses.is_empty(), strict.is_ok_and(|strict| strict == sets)),
        Err(_) => assert!(strict.is_err()),
    }
});
