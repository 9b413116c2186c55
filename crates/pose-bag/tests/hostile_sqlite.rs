//! SQLite bags that are cut, damaged, or made to keep a reader busy.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use pose_bag::{BagError, Selection, encode, read_poses, recover_poses};
use proptest::prelude::*;
use rusqlite::Connection;
use support::{assert_same, pose, poses, stamped};

const TABLES: &str = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, \
                      offered_qos_profiles TEXT); \
                      INSERT INTO topics VALUES (1, '/tool', 'geometry_msgs/msg/PoseStamped', 'cdr', '');";
const MESSAGES: &str = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);";

fn bag(folder: &Path, name: &str, tables: &str, count: usize) -> PathBuf {
    let path = folder.join(name);
    let _ = fs::remove_file(&path);
    let database = Connection::open(&path).unwrap();
    database.execute_batch("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN").unwrap();
    database.execute_batch(tables).unwrap();
    for k in 0..count {
        let data = encode(&stamped("base", k as i64, &pose(k))).unwrap();
        database.execute("INSERT INTO messages VALUES (NULL, 1, ?1, ?2)", (k as i64, data)).unwrap();
    }
    database.execute_batch("COMMIT").unwrap();
    path
}

fn whole(folder: &Path, count: usize) -> PathBuf {
    bag(folder, "whole.db3", &format!("{TABLES}{MESSAGES}"), count)
}

#[test]
fn bags_of_old_versions_without_definitions_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = whole(folder.path(), 30);
    for path in [&path, &folder.path().join("odd name %41 #1?.db3")] {
        if !path.exists() {
            fs::copy(folder.path().join("whole.db3"), path).unwrap();
        }
        assert_same(&read_poses(path, None).unwrap()[0].poses, &poses(30));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "nothing is written beside a bag");
}

#[test]
fn what_a_killed_recorder_left_in_its_log_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = whole(folder.path(), 3);
    let database = Connection::open(&path).unwrap();
    database.execute_batch("PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0;").unwrap();
    for k in 3..9 {
        let data = encode(&stamped("base", k as i64, &pose(k))).unwrap();
        database.execute("INSERT INTO messages VALUES (NULL, 1, ?1, ?2)", (k as i64, data)).unwrap();
    }
    assert_same(&read_poses(&path, None).unwrap()[0].poses, &poses(9));
}

#[test]
fn a_path_with_doubled_slashes_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = whole(folder.path(), 3);
    for slashes in ["/", "//"] {
        let doubled = format!("{slashes}{}", path.display());
        assert_same(&read_poses(doubled, None).unwrap()[0].poses, &poses(3));
    }
}

#[test]
fn a_recording_that_is_in_its_log_alone_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.db3");
    let database = Connection::open(&path).unwrap();
    database.execute_batch("PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0; BEGIN;").unwrap();
    database.execute_batch(&format!("{TABLES}{MESSAGES}")).unwrap();
    for k in 0..500 {
        let data = encode(&stamped("base", k as i64, &pose(k))).unwrap();
        database.execute("INSERT INTO messages VALUES (NULL, 1, ?1, ?2)", (k as i64, data)).unwrap();
    }
    database.execute_batch("COMMIT").unwrap();
    assert!(fs::metadata(&path).unwrap().len() < 500 * 84, "the poses are in the log");
    assert_same(&read_poses(&path, None).unwrap()[0].poses, &poses(500));
}

#[test]
fn a_cut_is_an_error_and_what_is_whole_is_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let count = 2000;
    let bytes = fs::read(whole(folder.path(), count)).unwrap();
    let path = folder.path().join("cut.db3");
    let mut recovered = Vec::new();
    for pages in [0, 1, 2, 10, 30, 60, bytes.len() / 4096 - 1] {
        fs::write(&path, &bytes[..(pages * 4096 + 100).min(bytes.len() - 1)]).unwrap();
        let error = read_poses(&path, None).unwrap_err();
        assert!(matches!(error, BagError::Corrupt { .. }), "{error}");
        if let Ok((sets, losses)) = recover_poses(&path, &Selection::default()) {
            assert_eq!(losses.len(), 1);
            let read = &sets[0].poses;
            assert_same(read, &poses(read.len()));
            recovered.push(read.len());
        }
    }
    assert!(recovered.len() >= 4 && recovered.is_sorted() && *recovered.last().unwrap() > count / 2, "{recovered:?}");
}

#[test]
fn a_log_beside_a_cut_page_is_read_and_the_cut_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = whole(folder.path(), 3);
    let database = Connection::open(&path).unwrap();
    database.execute_batch("PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0; BEGIN;").unwrap();
    for k in 3..1003 {
        let data = encode(&stamped("base", k as i64, &pose(k))).unwrap();
        database.execute("INSERT INTO messages VALUES (NULL, 1, ?1, ?2)", (k as i64, data)).unwrap();
    }
    database.execute_batch("COMMIT").unwrap();
    let cut = folder.path().join("cut.db3");
    fs::copy(folder.path().join("whole.db3-wal"), folder.path().join("cut.db3-wal")).unwrap();
    fs::write(&cut, [fs::read(&path).unwrap(), vec![1; 100]].concat()).unwrap();
    let (sets, losses) = recover_poses(&cut, &Selection::default()).unwrap();
    assert_same(&sets[0].poses, &poses(1003));
    let said: Vec<_> = losses.iter().map(ToString::to_string).collect();
    let expected = format!("{} is damaged after 1003 readable messages: its last page is cut off", cut.display());
    assert_eq!(said, [expected]);
    assert!(read_poses(&cut, None).is_err());
}

#[test]
fn tables_that_are_none_and_rows_that_never_end_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS id, 1 AS topic_id, i AS timestamp, \
                   x'00' AS data FROM n";
    let large = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER DEFAULT 1, timestamp INTEGER DEFAULT 0, \
                 data BLOB AS (zeroblob(200000000)) VIRTUAL); INSERT INTO messages(id) VALUES (1), (2), (3);";
    let text = format!("{MESSAGES} INSERT INTO messages VALUES (1, 1, 1, 'text');");
    let unknown = format!("{MESSAGES} INSERT INTO messages VALUES (1, 7, 1, x'00');");
    // The sorted reader believes the entry of the schema, which says that the view is a table with a page.
    let lying = format!(
        "CREATE VIEW messages AS {endless}; PRAGMA writable_schema = ON; \
         UPDATE sqlite_master SET type = 'table', rootpage = 2 WHERE name = 'messages';"
    );
    let cases = [
        ("view.db3", format!("{TABLES} CREATE VIEW messages AS {endless};"), "there is no table messages"),
        ("lying.db3", format!("{TABLES} {lying}"), "is damaged"),
        ("none.db3", MESSAGES.to_owned(), "there is no table topics"),
        ("large.db3", format!("{TABLES} {large}"), "its pages contradict each other"),
        ("text.db3", format!("{TABLES} {text}"), "message 1 holds no bytes"),
        ("unknown.db3", format!("{TABLES} {unknown}"), "a message belongs to the unknown topic 7"),
    ];
    for (name, tables, expected) in cases {
        let path = bag(folder.path(), name, &tables, 0);
        let started = Instant::now();
        let error = read_poses(&path, None).unwrap_err().to_string();
        assert!(error.contains(expected), "{name}: {error}");
        assert!(started.elapsed().as_secs() < 30, "{name} took {:?}", started.elapsed());
    }
    fs::write(folder.path().join("no.db3"), "SQLite format 3\0 and no more").unwrap();
    let error = read_poses(folder.path().join("no.db3"), None).unwrap_err().to_string();
    assert!(error.ends_with("is damaged after 0 readable messages: there is no table topics"), "{error}");
}

#[test]
fn metadata_and_packed_files_that_unfold_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let refusal = || {
        let started = Instant::now();
        let error = read_poses(folder.path(), None).unwrap_err().to_string();
        assert!(started.elapsed().as_secs() < 30, "{error}: {:?}", started.elapsed());
        error
    };
    let laughs: String = (1..30).map(|k| format!("a{k}: &a{k} [*a{0}, *a{0}, *a{0}, *a{0}, *a{0}]\n", k - 1)).collect();
    write("metadata.yaml", format!("a0: &a0 [lol]\n{laughs}rosbag2_bagfile_information: *a29\n").as_bytes());
    assert!(refusal().contains("is not the folder of a rosbag2 bag: metadata.yaml"));
    write("metadata.yaml", "[".repeat(100_000).as_bytes());
    assert!(refusal().contains("is not the folder of a rosbag2 bag: metadata.yaml"));
    write("metadata.yaml", &vec![b'#'; 5 << 20]);
    assert!(refusal().ends_with("it has more than 4194304 bytes"));
    let metadata = |mode: &str, storage: &str, file: &str| {
        format!(
            "rosbag2_bagfile_information: {{version: 9, storage_identifier: {storage}, compression_mode: {mode}, \
             compression_format: zstd, relative_file_paths: [{file}]}}"
        )
    };
    let bomb = zstd::bulk::compress(&vec![0; 300 << 20], 1).unwrap();
    for storage in ["mcap", "sqlite3"] {
        write("metadata.yaml", metadata("file", storage, "bomb.zstd").as_bytes());
        write("bomb.zstd", &bomb);
        let error = refusal();
        assert!(error.contains("unpacks to more than"), "{error}");
    }
    let message = zstd::bulk::compress(&vec![0; 200 << 20], 1).unwrap();
    let path = bag(folder.path(), "bomb.db3", &format!("{TABLES}{MESSAGES}"), 0);
    Connection::open(path).unwrap().execute("INSERT INTO messages VALUES (1, 1, 1, ?1)", [message]).unwrap();
    write("metadata.yaml", metadata("message", "sqlite3", "bomb.db3").as_bytes());
    assert!(refusal().contains("message 1 cannot be decompressed: it unpacks to more than"));
}

#[test]
fn a_message_that_cannot_be_decompressed_is_lost_alone() {
    let folder = tempfile::tempdir().unwrap();
    let database = Connection::open(bag(folder.path(), "bag.db3", &format!("{TABLES}{MESSAGES}"), 0)).unwrap();
    for k in 0..20 {
        let mut packed = zstd::bulk::compress(&encode(&stamped("base", 0, &pose(k))).unwrap(), 1).unwrap();
        packed[0] ^= u8::from(k == 19);
        let insert = |data: &[u8]| {
            database.execute("INSERT INTO messages VALUES (NULL, 1, ?1, ?2)", (k as i64, data)).unwrap();
        };
        insert(&packed);
        if k == 10 {
            insert(b"no zstd");
        }
    }
    let metadata = "rosbag2_bagfile_information: {version: 9, storage_identifier: sqlite3, compression_mode: MESSAGE, \
                    compression_format: zstd, relative_file_paths: [bag.db3]}";
    fs::write(folder.path().join("metadata.yaml"), metadata).unwrap();
    let (sets, losses) = recover_poses(folder.path(), &Selection::default()).unwrap();
    assert_same(&sets[0].poses, &poses(19));
    let said: Vec<_> = losses.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(said[0].contains("after 11 readable messages: message 12 cannot be decompressed"), "{said:?}");
    assert!(said[1].contains("after 19 readable messages: message 21 cannot be decompressed"), "{said:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(5), ..ProptestConfig::with_cases(200) })]

    #[test]
    fn damaged_bags_do_not_panic(damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20)) {
        let folder = tempfile::tempdir().unwrap();
        let path = whole(folder.path(), 60);
        let mut bytes = fs::read(&path).unwrap();
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        fs::write(&path, &bytes).unwrap();
        let _ = recover_poses(&path, &Selection::default());
    }
}
