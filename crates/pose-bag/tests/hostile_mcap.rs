//! MCAP files that are cut, damaged, or no MCAP at all.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::path::Path;

use pose_bag::msg::{Message, PoseStamped};
use pose_bag::{BagError, Compression, PoseSet, Selection, encode, read_poses, recover_poses};
use proptest::prelude::*;
use support::small_bag;

const MESSAGES: usize = 40;

fn read_bytes(folder: &Path, bytes: &[u8]) -> Result<Vec<PoseSet>, BagError> {
    let path = folder.join("hostile.mcap");
    fs::write(&path, bytes).unwrap();
    read_poses(&path, None)
}

fn u32_bytes_prefixed(text: &[u8]) -> Vec<u8> {
    [&u32::try_from(text.len()).unwrap().to_le_bytes()[..], text].concat()
}

fn record(opcode: u8, claimed: u64, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &claimed.to_le_bytes(), body].concat()
}

fn after_magic(records: &[u8]) -> Vec<u8> {
    [mcap::MAGIC, records].concat()
}

/// An uncompressed chunk of these records.
fn chunk(records: &[u8]) -> Vec<u8> {
    let size = (records.len() as u64).to_le_bytes();
    let body = [&[0; 16][..], &size, &[0; 4], &u32_bytes_prefixed(b""), &size, records].concat();
    record(6, body.len() as u64, &body)
}

#[test]
fn a_cut_anywhere_is_an_error_that_counts_the_messages_before_it() {
    let folder = tempfile::tempdir().unwrap();
    for compression in [Compression::None, Compression::Zstd] {
        let whole = fs::read(small_bag(folder.path(), compression, MESSAGES)).unwrap();
        assert_eq!(read_bytes(folder.path(), &whole).unwrap()[0].poses.len(), MESSAGES);
        let mut counts = Vec::new();
        for len in (1..whole.len()).step_by(97).chain([whole.len() - 1]) {
            match read_bytes(folder.path(), &whole[..len]) {
                Err(BagError::Truncated { messages_read, .. }) => counts.push(messages_read),
                other => panic!("{compression:?} cut at {len} of {}: {other:?}", whole.len()),
            }
        }
        assert!(counts.is_sorted(), "{counts:?}");
        assert_eq!((counts.first(), counts.last()), (Some(&0), Some(&(MESSAGES as u64))));
        if compression == Compression::None {
            // A record of a stamped pose is 9 + 22 + 88 bytes, so cuts 97 bytes apart part nearly every two of them.
            assert!(counts.iter().filter(|&&n| 0 < n && n < MESSAGES as u64).count() > MESSAGES / 2, "{counts:?}");
        }
    }
}

#[test]
fn a_flipped_bit_in_the_poses_does_not_pass() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = fs::read(small_bag(folder.path(), Compression::None, MESSAGES)).unwrap();
    let number = support::pose(7).translation.x.to_le_bytes();
    let at = bytes.windows(8).position(|window| window == number).unwrap();
    bytes[at] ^= 1; // the last digit of a coordinate: still a pose
    let error = read_bytes(folder.path(), &bytes).unwrap_err().to_string();
    assert!(error.ends_with("after 0 readable messages: the checksum of a chunk does not match its bytes"), "{error}");
}

#[test]
fn claims_that_crash_trusting_readers() {
    let folder = tempfile::tempdir().unwrap();
    let channel_with_endless_topic = [&[1, 0, 0, 0][..], &[0xff; 4], b"/tool"].concat();
    let cases: [(&str, Vec<u8>, &str); 8] = [
        (
            "a message beyond its chunk",
            [chunk(&record(5, 500, &[0; 30])), vec![0; 1000]].concat(),
            "beyond the end of its chunk",
        ),
        ("a record of 2^64 - 1 bytes", record(5, u64::MAX, &[]), "claims 18446744073709551615 bytes"),
        ("a message of 4 GB", record(5, 4_000_000_000, &[]), "claims 4000000000 bytes"),
        ("a message of 200 MB", record(5, 200_000_000, &[]), "is cut off"),
        ("an attachment too short", record(9, 4, &[0; 4]), "is cut off"),
        ("a topic of 4 GB", record(4, 13, &channel_with_endless_topic), "a channel record is too short"),
        ("a chunk of 2^64 - 1 bytes", record(6, u64::MAX, &[]), "is cut off"),
        ("a message without channel", record(5, 22, &[0; 22]), "the unknown channel 0"),
    ];
    for (name, records, expected) in cases {
        let error = read_bytes(folder.path(), &after_magic(&records)).unwrap_err().to_string();
        assert!(error.contains(expected), "{name}: {error}");
    }
}

#[test]
fn a_damaged_chunk_is_lost_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chunks.mcap");
    let options = mcap::WriteOptions::new().profile("ros2").chunk_size(Some(2000)).compression(None);
    let mut writer = options.create(fs::File::create(&path).unwrap()).unwrap();
    for message in
        mcap::MessageStream::new(&fs::read(small_bag(folder.path(), Compression::None, MESSAGES)).unwrap()).unwrap()
    {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    let mut bytes = fs::read(&path).unwrap();
    let number = support::pose(20).translation.x.to_le_bytes();
    let at = bytes.windows(8).position(|window| window == number).unwrap();
    bytes[at] ^= 1;
    fs::write(&path, &bytes).unwrap();
    let error = read_poses(&path, None).unwrap_err().to_string();
    let (sets, losses) = recover_poses(&path, &Selection::default()).unwrap();
    let read = &sets[0].poses;
    let counts = format!("there are {} messages where its statistics count {MESSAGES}", read.len());
    let said: Vec<_> = losses.iter().map(ToString::to_string).collect();
    assert!(said.len() == 2 && said[0] == error && said[1].ends_with(&counts), "{said:?}");
    // A chunk is closed once it holds 2000 bytes: some 20 messages of 119 are in it.
    assert!((MESSAGES - 25..MESSAGES - 10).contains(&read.len()), "{}", read.len());
    assert!(read.iter().all(|pose| support::poses(MESSAGES).iter().any(|whole| whole.translation == pose.translation)));
    assert!(read.iter().all(|pose| pose.translation != support::pose(20).translation));
}

/// A file that ends as it should around these records.
fn file_of(records: &[u8]) -> Vec<u8> {
    let end = [record(15, 4, &[0; 4]), record(2, 20, &[0; 20]), mcap::MAGIC.to_vec()].concat();
    [after_magic(records), end].concat()
}

fn message_record(channel: u16, data: &[u8]) -> Vec<u8> {
    let body = [&channel.to_le_bytes()[..], &[0; 20], data].concat();
    record(5, body.len() as u64, &body)
}

/// Schema 1, and channel 1 of stamped poses.
fn tool_channel() -> Vec<u8> {
    let text = |text: &str| u32_bytes_prefixed(text.as_bytes());
    let schema = [&[1, 0][..], &text(PoseStamped::TYPE), &text("ros2msg"), &text("")].concat();
    let channel = [&[1, 0, 1, 0][..], &text("/tool"), &text("cdr"), &[0; 4]].concat();
    [record(3, schema.len() as u64, &schema), record(4, channel.len() as u64, &channel)].concat()
}

#[test]
fn messages_of_a_lost_channel_are_lost_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lost.mcap");
    let known = |k: usize| message_record(1, &encode(&support::stamped("base", 0, &support::pose(k))).unwrap());
    // Channel 2 has a schema that nobody defined, and channel 3 is itself not defined.
    let channel = [&[2, 0, 9, 0][..], &u32_bytes_prefixed(b"/chatter"), &u32_bytes_prefixed(b"cdr"), &[0; 4]].concat();
    let mut records = [tool_channel(), record(4, channel.len() as u64, &channel)].concat();
    for k in 0..20 {
        records.extend([message_record(2, b"lost"), message_record(3, b"lost"), known(k)].concat());
    }
    for records in [records.clone(), chunk(&records)] {
        fs::write(&path, file_of(&records)).unwrap();
        let (sets, losses) = recover_poses(&path, &Selection::default()).unwrap();
        support::assert_same(&sets[0].poses, &support::poses(20));
        let said: Vec<_> = losses.iter().map(ToString::to_string).collect();
        assert_eq!(said.len(), 3, "{said:?}");
        let expected = ["the unknown schema 9", "the unknown channel 2", "the unknown channel 3"];
        assert!(said.iter().zip(expected).all(|(said, expected)| said.ends_with(expected)), "{said:?}");
    }
}

#[test]
fn a_message_that_is_no_message_any_more_is_lost_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kind.mcap");
    let mut records = tool_channel();
    for k in 0..5 {
        let mut message = message_record(1, &encode(&support::stamped("base", 0, &support::pose(k))).unwrap());
        message[0] ^= if k == 4 { 2 } else { 0 };
        records.extend(message);
    }
    for (records, expected) in [
        (chunk(&records), "after 4 readable messages: a chunk holds a record of kind 0x07"),
        (records, "after 4 readable messages: a message index of 106 bytes claims to have another length"),
    ] {
        fs::write(&path, file_of(&records)).unwrap();
        let (sets, losses) = recover_poses(&path, &Selection::default()).unwrap();
        support::assert_same(&sets[0].poses, &support::poses(4));
        let said: Vec<_> = losses.iter().map(ToString::to_string).collect();
        assert!(said.len() == 1 && said[0].ends_with(expected), "{said:?}");
    }
}

#[test]
fn a_message_that_cannot_be_decompressed_is_lost_alone() {
    let folder = tempfile::tempdir().unwrap();
    let mut records = tool_channel();
    for k in 0..20 {
        let data = encode(&support::stamped("base", 0, &support::pose(k))).unwrap();
        let mut packed = zstd::bulk::compress(&data, 1).unwrap();
        packed[0] ^= u8::from(k == 19);
        records.extend(message_record(1, &packed));
        packed[0] ^= 1;
        records.extend(message_record(1, &packed).repeat(usize::from(k == 10)));
    }
    fs::write(folder.path().join("bag.mcap"), file_of(&records)).unwrap();
    let metadata = "rosbag2_bagfile_information: {version: 9, storage_identifier: mcap, compression_mode: MESSAGE, \
                    compression_format: zstd, relative_file_paths: [bag.mcap]}";
    fs::write(folder.path().join("metadata.yaml"), metadata).unwrap();
    let (sets, losses) = recover_poses(folder.path(), &Selection::default()).unwrap();
    support::assert_same(&sets[0].poses, &support::poses(19));
    let said: Vec<_> = losses.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 2, "{said:?}");
    for (said, before) in said.iter().zip([11, 19]) {
        let expected = format!("after {before} readable messages: a message cannot be decompressed");
        assert!(said.contains(&expected), "{said}");
    }
}

/// A chunk of so many bytes (private records of a mebibyte of zeros), by zstd, that claims to hold `claimed` bytes.
fn packed_records(bytes: usize, claimed: u64) -> Vec<u8> {
    let zeros = vec![0; (1 << 20) - 9];
    let records = record(0x80, zeros.len() as u64, &zeros).repeat(bytes.div_ceil(1 << 20));
    let packed = zstd::bulk::compress(&records[..bytes], 1).unwrap();
    let size = (packed.len() as u64).to_le_bytes();
    let body = [&[0; 16][..], &claimed.to_le_bytes(), &[0; 4], &u32_bytes_prefixed(b"zstd"), &size, &packed].concat();
    record(6, body.len() as u64, &body)
}

#[test]
fn bombs_are_refused_before_they_unfold() {
    let folder = tempfile::tempdir().unwrap();
    let mib = 1 << 20;
    let cases = [
        (packed_records(100 * mib, 100 << 20), "claims to hold 104857600, which is not believed"),
        (packed_records(100 * mib, 4000), "a chunk holds more than the 4000 bytes that it claims"),
        (packed_records(mib, 1 << 60), "claims to hold 1152921504606846976, which is not believed"),
        (packed_records(4000, 4001), "a chunk holds less than the 4001 bytes that it claims"),
        // 1000 times 9 MiB out of a kilobyte or so each: a few are believed, and all others not.
        (packed_records(9 * mib, 9 << 20).repeat(1000), "claims to hold 9437184, which is not believed"),
    ];
    for (chunk, expected) in cases {
        let started = std::time::Instant::now();
        let error = read_bytes(folder.path(), &after_magic(&chunk)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
        // Generous, since the machine may be busy: unfolding 100 MiB alone takes some 50 ms. That little is unfolded is what the sentence says.
        assert!(started.elapsed().as_secs() < 20);
    }
}

#[test]
fn definitions_that_differ_are_refused_by_the_field() {
    let folder = tempfile::tempdir().unwrap();
    let definition = |text: &str| {
        let path = folder.path().join("other.mcap");
        let mut writer = mcap::Writer::new(fs::File::create(&path).unwrap()).unwrap();
        let schema = writer.add_schema(PoseStamped::TYPE, "ros2msg", text.as_bytes()).unwrap();
        let channel_id = writer.add_channel(schema, "/tool", "cdr", &Default::default()).unwrap();
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
        let data = encode(&support::stamped("base", 0, &support::pose(1))).unwrap();
        writer.write_to_known_channel(&header, &data).unwrap();
        writer.finish().unwrap();
        read_poses(&path, None).map(|sets| sets.len()).map_err(|error| error.to_string())
    };
    let ours = PoseStamped::DEFINITION;
    assert_eq!(definition(ours), Ok(1));
    let error = definition(&ours.replace("Pose pose", "Pose pose\nfloat64 confidence")).unwrap_err();
    let expected = "topic /tool: the bag's geometry_msgs/msg/PoseStamped is not the standard one: it has the extra field confidence";
    assert!(error.ends_with(expected), "{error}");
    // Definitions that contain themselves, unfold to 10^60 fields, or have a megabyte.
    let unfolding: String =
        (0..60).map(|k| format!("===\nMSG: a/T{k}\n{}", format!("T{} x\n", k + 1).repeat(10))).collect();
    for text in [format!("PoseStamped header\n{ours}"), format!("a/T0 header\n{unfolding}"), "a".repeat(1 << 20)] {
        let started = std::time::Instant::now();
        assert!(definition(&text).unwrap_err().contains("is not the standard one"));
        assert!(started.elapsed().as_secs() < 20, "10^60 fields never end");
    }
}

#[test]
fn bytes_after_the_end_are_damage() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = fs::read(small_bag(folder.path(), Compression::Zstd, 3)).unwrap();
    bytes.push(0);
    let error = read_bytes(folder.path(), &bytes).unwrap_err();
    assert!(matches!(error, BagError::Corrupt { messages_read: 3, .. }), "{error}");
}

#[test]
fn names_that_would_fill_the_memory_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let long = u32_bytes_prefixed(&vec![b'a'; 2000]);
    let short = u32_bytes_prefixed(b"a");
    let cases = [
        record(4, 2013, &[&[1, 0, 0, 0][..], &long, &short].concat()),
        record(4, 2013, &[&[1, 0, 0, 0][..], &short, &long].concat()),
        record(3, 2016, &[&[1, 0][..], &long, &short, &short].concat()),
    ];
    for records in cases {
        let error = read_bytes(folder.path(), &after_magic(&records)).unwrap_err().to_string();
        assert!(error.contains("has a name of 2000 bytes"), "{error}");
    }
}

#[test]
fn files_without_chunks_or_index_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = fs::read(small_bag(folder.path(), Compression::Zstd, MESSAGES)).unwrap();
    let path = folder.path().join("plain.mcap");
    for chunked in [false, true] {
        let options = mcap::WriteOptions::new().profile("ros2").use_chunks(chunked).emit_summary_records(false);
        let options = options.emit_message_indexes(false).emit_summary_offsets(false);
        let mut writer = options.create(fs::File::create(&path).unwrap()).unwrap();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            writer.write(&message.unwrap()).unwrap();
        }
        writer.finish().unwrap();
        support::assert_same(&read_poses(&path, None).unwrap()[0].poses, &support::poses(MESSAGES));
    }
}

#[test]
fn chunks_by_lz4_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let whole = small_bag(folder.path(), Compression::None, MESSAGES);
    let path = folder.path().join("lz4.mcap");
    let options = mcap::WriteOptions::new().profile("ros2").compression(Some(mcap::Compression::Lz4));
    let mut writer = options.create(fs::File::create(&path).unwrap()).unwrap();
    let bytes = fs::read(whole).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    support::assert_same(&read_poses(&path, None).unwrap()[0].poses, &support::poses(MESSAGES));
    let cut = fs::read(&path).unwrap();
    let error = read_bytes(folder.path(), &cut[..cut.len() / 2]).unwrap_err();
    assert!(matches!(error, BagError::Truncated { .. }), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(4), ..ProptestConfig::with_cases(200) })]

    #[test]
    fn random_records_do_not_panic(records in prop::collection::vec((0_u8..17, prop::collection::vec(any::<u8>(), 0..80)), 0..6)) {
        let folder = tempfile::tempdir().unwrap();
        let framed = records.iter().flat_map(|(opcode, body)| record(*opcode, body.len() as u64, body)).collect::<Vec<_>>();
        prop_assert!(read_bytes(folder.path(), &after_magic(&framed)).is_err());
        prop_assert!(read_bytes(folder.path(), &framed).is_err());
        prop_assert!(read_bytes(folder.path(), &after_magic(&chunk(&framed))).is_err());
    }

    #[test]
    fn damaged_bags_do_not_panic(zstd: bool, damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5)) {
        let folder = tempfile::tempdir().unwrap();
        let compression = if zstd { Compression::Zstd } else { Compression::None };
        let mut bytes = fs::read(small_bag(folder.path(), compression, 4)).unwrap();
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let _ = read_bytes(folder.path(), &bytes);
    }
}
