//! MCAP files in which a record is taken for another one: what is lost with it is told.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::path::Path;

use mcap::records::op;
use pose_bag::msg::{Message, PoseStamped};
use pose_bag::{Compression, Selection, encode, read_poses, recover_poses};
use support::{poses, small_bag};

const MESSAGES: usize = 40;

/// The bag of [`MESSAGES`] poses as crate `mcap` writes it, in several chunks or in none.
fn whole(folder: &Path, chunked: bool) -> Vec<u8> {
    let options =
        mcap::WriteOptions::new().profile("ros2").use_chunks(chunked).chunk_size(Some(1500)).compression(None);
    let path = folder.join("whole.mcap");
    let mut writer = options.create(fs::File::create(&path).unwrap()).unwrap();
    let bytes = fs::read(small_bag(folder, Compression::None, MESSAGES)).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    fs::read(path).unwrap()
}

/// Opcode and place of every record outside of chunks.
fn records(bytes: &[u8]) -> Vec<(u8, usize)> {
    let (mut found, mut at) = (Vec::new(), mcap::MAGIC.len());
    while at + mcap::MAGIC.len() < bytes.len() {
        found.push((bytes[at], at));
        at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    found
}

/// How many poses are left, and what is said to be lost.
fn recovered(folder: &Path, bytes: &[u8]) -> (usize, Vec<String>) {
    let path = folder.join("damaged.mcap");
    fs::write(&path, bytes).unwrap();
    let strict = read_poses(&path, None);
    match recover_poses(&path, &Selection::default()) {
        Ok((sets, losses)) => {
            assert_eq!(strict.is_ok(), losses.is_empty(), "{losses:?}");
            (sets[0].poses.len(), losses.iter().map(ToString::to_string).collect())
        }
        Err(error) => (0, vec![error.to_string()]),
    }
}

#[test]
fn a_flipped_bit_in_an_opcode_loses_nothing_in_silence() {
    let folder = tempfile::tempdir().unwrap();
    for chunked in [false, true] {
        let bytes = whole(folder.path(), chunked);
        assert_eq!(recovered(folder.path(), &bytes), (MESSAGES, vec![]));
        for (opcode, at) in records(&bytes) {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1 << bit;
                let (read, losses) = recovered(folder.path(), &damaged);
                let name = format!("{opcode:#04x} as {:#04x} at {at}: {losses:?}", damaged[at]);
                assert!(read == MESSAGES || !losses.is_empty(), "{name}");
                let holds_poses = [op::MESSAGE, op::CHUNK].contains(&opcode);
                assert!(!holds_poses || !losses.is_empty(), "{name}");
            }
        }
    }
}

#[test]
fn what_is_lost_with_an_opcode_is_told_without_statistics_too() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        (true, op::MESSAGE_INDEX, op::DATA_END, MESSAGES, "the record that ends the data has "),
        (true, op::CHUNK, op::MESSAGE_INDEX, 0, "bytes claims to have another length"),
        (true, op::CHUNK, op::SUMMARY_OFFSET, 0, "a record of kind 0x0e before the end of the data is out of place"),
        (true, op::CHUNK, 0x46, 0, "a record is of the unknown kind 0x46"),
        (
            true,
            op::SUMMARY_OFFSET,
            op::CHUNK,
            MESSAGES,
            "a record of kind 0x06 after the end of the data is out of place",
        ),
        (
            true,
            op::SUMMARY_OFFSET,
            op::DATA_END,
            MESSAGES,
            "a record of kind 0x0f after the end of the data is out of place",
        ),
        (false, op::MESSAGE, op::MESSAGE_INDEX, 0, "bytes claims to have another length"),
        (false, op::MESSAGE, op::HEADER, 0, "a record of kind 0x01 before the end of the data is out of place"),
    ];
    for (chunked, from, to, all, expected) in cases {
        let mut bytes = whole(folder.path(), chunked);
        let found = records(&bytes);
        // The second of its kind: without the first chunk there is no channel.
        let place =
            |opcode| found.iter().filter(|(of, _)| *of == opcode).nth(usize::from(opcode != op::STATISTICS)).unwrap().1;
        bytes[place(from)] = to;
        bytes[place(op::STATISTICS)] |= 0x80;
        let (read, losses) = recovered(folder.path(), &bytes);
        assert!(losses.iter().any(|loss| loss.contains(expected)), "{losses:?}");
        assert!(read > 0 && (read == MESSAGES) == (all == MESSAGES), "{read} after {losses:?}");
    }
}

#[test]
fn messages_that_the_statistics_count_and_nobody_finds_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = whole(folder.path(), false);
    let messages: Vec<_> = records(&bytes).into_iter().filter(|(opcode, _)| *opcode == op::MESSAGE).collect();
    // Applications may have records of their own: only the number is amiss.
    messages[..3].iter().for_each(|&(_, at)| bytes[at] |= 0x80);
    let (read, losses) = recovered(folder.path(), &bytes);
    let expected = "after 37 readable messages: there are 37 messages where its statistics count 40";
    assert!(read == 37 && losses.len() == 1 && losses[0].ends_with(expected), "{losses:?}");
}

#[test]
fn all_topics_count_and_records_without_poses_may_be_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("more.mcap");
    for chunked in [false, true] {
        let options = mcap::WriteOptions::new().profile("ros2").use_chunks(chunked);
        let mut writer = options.create(fs::File::create(&path).unwrap()).unwrap();
        let other = writer.add_channel(0, "/other", "json", &Default::default()).unwrap();
        let about = mcap::records::Metadata { name: "about".into(), metadata: Default::default() };
        let schema = writer.add_schema(PoseStamped::TYPE, "ros2msg", PoseStamped::DEFINITION.as_bytes()).unwrap();
        let tool = writer.add_channel(schema, "/tool", "cdr", &Default::default()).unwrap();
        for k in 0..MESSAGES {
            let pose = encode(&support::stamped("base", 0, &support::pose(k))).unwrap();
            for (channel_id, data) in [(other, b"{}".as_slice()), (tool, &pose)] {
                let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
                writer.write_to_known_channel(&header, data).unwrap();
            }
        }
        writer.write_metadata(&about).unwrap();
        let attached = mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: "a.txt".into(),
            media_type: "text/plain".into(),
            data: b"text".as_slice().into(),
        };
        writer.attach(&attached).unwrap();
        writer.write_private_record(0x80, b"private", Default::default()).unwrap();
        writer.finish().unwrap();
        support::assert_same(&read_poses(&path, None).unwrap()[0].poses, &poses(MESSAGES));
    }
}
