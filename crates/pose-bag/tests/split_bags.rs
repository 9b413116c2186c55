//! Bags of several files, of which some are damaged or something else.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::path::Path;

use pose_bag::{BagError, Compression, Selection, read_poses, recover_poses};
use support::{assert_same, poses, small_bag};

const MESSAGES: usize = 10;

/// The folder of a bag with these files.
fn split(folder: &Path, how: &str, files: &[(&str, &[u8])]) {
    for (name, bytes) in files {
        fs::write(folder.join(name), bytes).unwrap();
    }
    let names: Vec<_> = files.iter().map(|(name, _)| *name).collect();
    write_metadata(folder, how, &names);
}

fn write_metadata(folder: &Path, how: &str, names: &[&str]) {
    let text =
        format!("rosbag2_bagfile_information: {{version: 9, {how}, relative_file_paths: [{}]}}", names.join(", "));
    fs::write(folder.join("metadata.yaml"), text).unwrap();
}

fn sentences(folder: &Path, losses: &[BagError]) -> Vec<String> {
    losses.iter().map(|loss| loss.to_string().replace(&format!("{}/", folder.display()), "")).collect()
}

#[test]
fn files_that_are_empty_or_zeroed_are_lost_alone() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let whole = fs::read(small_bag(folder, Compression::Zstd, MESSAGES)).unwrap();
    let zeros = vec![0; whole.len()];
    let files = [("a.mcap", &[][..]), ("b.mcap", &whole), ("c.mcap", &zeros), ("d.mcap", &whole)];
    split(folder, "storage_identifier: mcap", &files);
    fs::remove_file(folder.join("d.mcap")).unwrap();
    let (sets, losses) = recover_poses(folder, &Selection::default()).unwrap();
    assert_same(&sets[0].poses, &poses(MESSAGES));
    assert!(losses.iter().all(BagError::is_loss));
    assert_eq!(losses.iter().map(BagError::may_pass).collect::<Vec<_>>(), [false, false, true]);
    let expected = [
        "a.mcap is damaged after 0 readable messages: it is empty",
        "c.mcap is damaged after 0 readable messages: its first bytes are not the MCAP magic",
        "d.mcap: No such file or directory (os error 2)",
    ];
    assert_eq!(sentences(folder, &losses), expected);
    assert_eq!(sentences(folder, &[read_poses(folder, None).unwrap_err()]), expected[..1]);
}

#[test]
fn packed_files_that_are_empty_are_lost_alone() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let packed = zstd::bulk::compress(&fs::read(small_bag(folder, Compression::None, MESSAGES)).unwrap(), 1).unwrap();
    let files = [("a.mcap.zstd", &[][..]), ("b.mcap.zstd", &packed), ("c.mcap.zstd", &[0; 100])];
    split(folder, "storage_identifier: mcap, compression_mode: FILE, compression_format: zstd", &files);
    let (sets, losses) = recover_poses(folder, &Selection::default()).unwrap();
    assert_same(&sets[0].poses, &poses(MESSAGES));
    let said = sentences(folder, &losses);
    assert_eq!((said.len(), said[0].as_str()), (2, "a.mcap.zstd is damaged after 0 readable messages: it is empty"));
    assert!(
        said[1].starts_with("c.mcap.zstd is damaged after 0 readable messages: it cannot be decompressed"),
        "{said:?}"
    );
}

#[test]
fn where_every_file_is_empty_that_is_the_error() {
    let folder = tempfile::tempdir().unwrap();
    for storage in ["mcap", "sqlite3"] {
        split(folder.path(), &format!("storage_identifier: {storage}"), &[("a", b""), ("b", b"")]);
        let error = recover_poses(folder.path(), &Selection::default()).unwrap_err();
        assert_eq!(sentences(folder.path(), &[error]), ["a is damaged after 0 readable messages: it is empty"]);
    }
}

#[test]
fn files_that_are_named_twice_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let whole = fs::read(small_bag(folder, Compression::Zstd, MESSAGES)).unwrap();
    split(folder, "storage_identifier: mcap", &[("a.mcap", &whole), ("b.mcap", &whole)]);
    assert_eq!(read_poses(folder, None).unwrap()[0].poses.len(), 2 * MESSAGES);
    // Of what a file is named only the last part counts.
    for names in [["a.mcap", "b.mcap", "a.mcap"], ["sub1/a.mcap", "b.mcap", "sub2/a.mcap"]] {
        write_metadata(folder, "storage_identifier: mcap", &names);
        let error = read_poses(folder, None).unwrap_err().to_string();
        let expected = "is not the folder of a rosbag2 bag: metadata.yaml: relative_file_paths names a.mcap twice";
        assert!(error.ends_with(expected), "{error}");
    }
}

#[test]
fn pipes_are_refused_instead_of_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let pipe = |name: &str| {
        let path = folder.join(name);
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        path
    };
    for name in ["a.mcap", "a.db3", "a"] {
        let error = read_poses(pipe(name), None).unwrap_err();
        assert_eq!(sentences(folder, &[error]), [format!("{name}: it is not a regular file")]);
    }
    write_metadata(folder, "storage_identifier: sqlite3", &["a.db3"]);
    let error = read_poses(folder, None).unwrap_err();
    assert_eq!(sentences(folder, &[error]), ["a.db3: it is not a regular file"]);
    fs::remove_file(folder.join("metadata.yaml")).unwrap();
    pipe("metadata.yaml");
    let error = read_poses(folder, None).unwrap_err().to_string();
    assert!(error.ends_with("metadata.yaml: it is not a regular file"), "{error}");
}
