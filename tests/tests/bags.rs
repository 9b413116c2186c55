//! Bags of the independent rosbags, of every type, storage and compression, and ours in rosbags and mcap-ros2-support: every
//! message with every value.
#![allow(clippy::unwrap_used, missing_docs)]

use std::path::Path;

use end_to_end::python;
use pose_bag::msg::{
    JointState, JointTrajectory, MarkerArray, Message, Odometry, Path as PathMessage, PoseArray, PoseStamped,
    PoseWithCovarianceStamped, Text, TfMessage,
};
use pose_bag::{BagError, BagMessage, BagReader, BagWriter, Compression};
use serde_json::{Value, json};

const PEER: &str = "crates/pose-bag/tests/rosbags_peer.py";
const MESSAGES: usize = 10 * 7;

fn peer(arguments: &[&str]) -> String {
    let output = python(&[&[PEER], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Every message by topic and time, as a peer reads it.
fn dumped(bag: &Path, reader: &str) -> Vec<Value> {
    let text = peer(&["dump", bag.to_str().unwrap(), "--reader", reader]);
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Does something with a message of its own type.
trait WithType {
    fn see<M: Message>(&mut self, message: M, of: &BagMessage<'_>) -> Result<(), BagError>;
}

fn by_type(of: &BagMessage<'_>, with: &mut impl WithType) -> Result<(), BagError> {
    macro_rules! seen {
        ($($kind:ty),*) => {
            match of.message_type() {
                $(<$kind>::TYPE => with.see(of.decode::<$kind>()?, of),)*
                other => panic!("{other}"),
            }
        };
    }
    seen!(
        PoseArray,
        PoseStamped,
        PoseWithCovarianceStamped,
        Odometry,
        PathMessage,
        TfMessage,
        JointState,
        JointTrajectory,
        MarkerArray,
        Text
    )
}

struct AsJson(Vec<Value>);

impl WithType for AsJson {
    fn see<M: Message>(&mut self, message: M, of: &BagMessage<'_>) -> Result<(), BagError> {
        let (topic, kind, time_ns) = (of.topic(), of.message_type(), of.log_time_ns());
        self.0.push(json!({"topic": topic, "type": kind, "time_ns": time_ns, "message": message_json(&message)}));
        Ok(())
    }
}

fn message_json(message: &impl Message) -> Value {
    serde_json::to_value(message).unwrap()
}

struct Copied(BagWriter);

impl WithType for Copied {
    fn see<M: Message>(&mut self, message: M, of: &BagMessage<'_>) -> Result<(), BagError> {
        self.0.write(of.topic(), of.log_time_ns(), &message)
    }
}

fn ours(bag: &Path) -> Vec<Value> {
    let mut all = AsJson(Vec::new());
    let losses = BagReader::open(bag).unwrap().for_each(&mut |message| by_type(message, &mut all)).unwrap();
    assert!(losses.is_empty(), "{losses:?}");
    let key = |value: &Value| (value["topic"].as_str().unwrap().to_owned(), value["time_ns"].as_u64());
    all.0.sort_by_key(key);
    all.0
}

#[test]
fn every_message_of_rosbags_is_read_with_equal_values() {
    let folder = tempfile::tempdir().unwrap();
    let mut first: Option<Vec<Value>> = None;
    for (storage, compressions) in
        [("mcap", &["none", "storage", "message", "file"][..]), ("sqlite3", &["none", "message", "file"])]
    {
        for compression in compressions {
            let bag = folder.path().join(format!("{storage}_{compression}"));
            peer(&["every", bag.to_str().unwrap(), "--storage", storage, "--compression", compression]);
            let read = ours(&bag);
            assert_eq!(read.len(), MESSAGES);
            let expected = dumped(&bag, "rosbags");
            for (ours, theirs) in read.iter().zip(&expected) {
                assert_eq!(ours, theirs, "{storage}, {compression}");
            }
            assert_eq!(read.len(), expected.len());
            // What is in the bag does not hang on how it is stored.
            assert_eq!(first.get_or_insert(read), &expected);
        }
    }
}

#[test]
fn every_message_of_ours_is_read_by_rosbags_and_mcap_with_equal_values() {
    let folder = tempfile::tempdir().unwrap();
    let theirs = folder.path().join("theirs");
    peer(&["every", theirs.to_str().unwrap()]);
    let expected = dumped(&theirs, "rosbags");
    for compression in [Compression::None, Compression::Zstd, Compression::Lz4] {
        for name in [format!("{compression:?}"), format!("{compression:?}.mcap")] {
            let bag = folder.path().join(name);
            let mut copy = Copied(BagWriter::create_with(&bag, compression).unwrap());
            let reader = BagReader::open(&theirs).unwrap();
            assert!(reader.for_each(&mut |message| by_type(message, &mut copy)).unwrap().is_empty());
            copy.0.finish().unwrap();
            for reader in ["rosbags", "mcap"] {
                let read = dumped(&bag, reader);
                assert_eq!(read.len(), MESSAGES);
                for (found, expected) in read.iter().zip(&expected) {
                    assert_eq!(found, expected, "{reader}, {}", bag.display());
                }
            }
            assert_eq!(ours(&bag), expected);
        }
    }
}

#[test]
fn a_split_bag_is_read_in_the_order_of_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag");
    peer(&["every", bag.to_str().unwrap()]);
    let whole = ours(&bag);
    let file = BagReader::open(&bag).unwrap().files()[0].clone();
    std::fs::copy(&file, bag.join("second.mcap")).unwrap();
    let metadata = bag.join("metadata.yaml");
    let text = std::fs::read_to_string(&metadata).unwrap();
    let entry = format!("- {}\n", file.file_name().unwrap().to_str().unwrap());
    let longer = text.replace(&entry, &format!("{entry}  - second.mcap\n"));
    assert_ne!(longer, text, "{text}");
    std::fs::write(&metadata, longer).unwrap();
    let mut indices = Vec::new();
    let losses = BagReader::open(&bag).unwrap().for_each(&mut |message| {
        indices.extend((message.topic() == "/String").then(|| message.index()));
        Ok(())
    });
    assert!(losses.unwrap().is_empty());
    assert_eq!(indices, (0..14).collect::<Vec<_>>(), "messages are counted over all files");
    let twice = ours(&bag);
    assert_eq!(twice.len(), 2 * whole.len());
    assert!(twice.iter().step_by(2).eq(&whole));
}
