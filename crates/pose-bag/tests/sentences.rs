//! Bad input is refused with one sentence that names the file and the place.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::path::PathBuf;

use pose_bag::msg::{
    Message, Odometry, Path, PoseArray, PoseStamped, PoseWithCovariance, Text, Twist, TwistWithCovariance,
};
use pose_bag::{BagWriter, Table, encode, read_poses, read_table};
use support::{array, header, poses, stamped};
use tempfile::TempDir;

const HEADER: &str = "x,y,z,qx,qy,qz,qw\n";

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.path(name), content).unwrap();
        self.path(name)
    }

    /// The sentence, without the folder.
    fn sentence(&self, result: Result<impl Sized, pose_bag::BagError>) -> String {
        let sentence = result.err().expect("an error").to_string();
        assert!(!sentence.contains('\n'), "{sentence}");
        sentence.replace(&format!("{}/", self.0.path().display()), "")
    }

    fn refusal(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        self.sentence(read_poses(self.file(name, content), None))
    }
}

#[test]
fn csv() {
    let folder = Folder::new();
    let rows = |rows: &str| format!("{HEADER}0,0,0,0,0,0,1\n\n{rows}\n");
    let cases = [
        (String::new(), "poses.csv holds no rows"),
        (HEADER.into(), "poses.csv holds no rows"),
        (rows("0,0,0,0,0,0,0"), "poses.csv, line 4: the quaternion is zero, so there is no orientation"),
        (rows("0,0,0,0,0,0,2"), "poses.csv, line 4: the quaternion has norm 2.000000 instead of 1"),
        (rows("0,NaN,0,0,0,0,1"), "poses.csv, line 4: y is not finite: NaN"),
        (rows("0,0,0,0,0,0,-inf"), "poses.csv, line 4: qw is not finite: -inf"),
        (rows("0,0,0,0,0,one,1"), "poses.csv, line 4: qz is not a number: \"one\""),
        (rows("0,0,0,0,0,,1"), "poses.csv, line 4: qz is not a number: \"\""),
        (rows("0,0,0,0,0,1"), "poses.csv, line 4: 6 fields instead of 7"),
        (rows("0,0,0,0,0,0,1,"), "poses.csv, line 4: 8 fields instead of 7"),
        (
            "0,0,0,0,0,0,1\n".into(),
            "poses.csv, line 1: the header is missing; the first line names the columns, such as x,y,z,qx,qy,qz,qw",
        ),
        ("x,y,z,qx,qy,qz\n0,0,0,0,0,0\n".into(), "poses.csv has no column qw; its columns are x, y, z, qx, qy, qz"),
        ("x,y,x\n0,0,0\n".into(), "poses.csv, line 1: column x occurs twice"),
    ];
    for (content, sentence) in cases {
        assert_eq!(folder.refusal("poses.csv", &content), sentence, "{content}");
    }
    assert_eq!(
        folder.refusal("poses.csv", [b"x,y\n".as_slice(), &[0xff, 0xfe]].concat()),
        "poses.csv, line 2: this is not UTF-8 text"
    );
    let endless = vec![b'1'; (1 << 20) + 2];
    assert_eq!(folder.refusal("poses.csv", endless), "poses.csv, line 1: the line is longer than 1048576 bytes");
    let missing = folder.sentence(read_table(folder.path("none.csv")));
    assert_eq!(missing, "none.csv: No such file or directory (os error 2)");
    let standard_input = Table::from_reader("x\n".as_bytes(), "standard input").unwrap_err().to_string();
    assert_eq!(standard_input, "standard input holds no rows");
}

#[test]
fn tum() {
    let folder = Folder::new();
    let cases = [
        ("# only comments\n", "track.txt holds no poses"),
        ("0 0 0 0 0 0 1\n", "track.txt, line 1: 7 fields instead of 8"),
        ("#\n1 0 0 0 0 0 0 0\n", "track.txt, line 2: the quaternion is zero, so there is no orientation"),
        ("soon 0 0 0 0 0 0 1\n", "track.txt, line 1: t is not a number: \"soon\""),
        ("1 0 0 nan 0 0 0 1\n", "track.txt, line 1: z is not finite: NaN"),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 0 0 1\n", "track.txt, line 2: 8 fields instead of 12"),
        ("1 0 0 0 0 1 0 0 0 0 one 0\n", "track.txt, line 1: number 11 is not a number: \"one\""),
        (
            "2 0 0 0 0 1 0 0 0 0 1 0\n",
            "track.txt, line 1: the 3 x 3 block is no rotation: it is 3.000000 away from one",
        ),
        (
            "1 0 0 0 0 1 0 0 0 0 -1 0\n",
            "track.txt, line 1: the 3 x 3 block is no rotation: it is 2.000000 away from one",
        ),
    ];
    for (content, sentence) in cases {
        assert_eq!(folder.refusal("track.txt", content), sentence);
    }
}

#[test]
fn euroc() {
    let folder = Folder::new();
    let header = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n";
    let cases = [
        (format!("{header}1.5,0,0,0,1,0,0,0\n"), "data.csv, line 2: t is not a number: \"1.5\""),
        (format!("{header}1,0,0,0,0,0,0,0\n"), "data.csv, line 2: the quaternion is zero, so there is no orientation"),
        (format!("{header}# more\n1,0,0,1,0,0,0\n"), "data.csv, line 3: 7 fields instead of 8"),
        // Without its quaternion the comment is one like any other.
        (
            format!("{}\n1,2,3,4\n", header.split(",q_RS_w").next().unwrap()),
            "data.csv, line 2: the header is missing; the first line names the columns, such as x,y,z,qx,qy,qz,qw",
        ),
    ];
    for (content, sentence) in cases {
        assert_eq!(folder.refusal("data.csv", &content), sentence, "{content}");
    }
}

#[test]
fn stamps_that_do_not_fit() {
    let folder = Folder::new();
    let does_not_fit = "does not fit into 64 bits of nanoseconds (TUM has seconds, EuRoC nanoseconds)";
    for stamp in ["1403636579763555584", "-1e10", "9223372036.854775808"] {
        let text = format!("9223372036.854775807 0 0 0 0 0 0 1\n{stamp} 0 0 0 0 0 0 1\n");
        let expected = format!("track.tum, line 2: the stamp {stamp} {does_not_fit}");
        assert_eq!(folder.refusal("track.tum", text), expected);
    }
    let header = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n";
    let text = format!("{header}9223372036854775807,0,0,0,1,0,0,0\n9223372036854775808,0,0,0,1,0,0,0\n");
    let expected = format!("data.csv, line 3: the stamp 9223372036854775808 {does_not_fit}");
    assert_eq!(folder.refusal("data.csv", text), expected);
}

#[test]
fn poses_in_messages() {
    let folder = Folder::new();
    let mut zero = array("base", &poses(3));
    zero.poses[1].orientation.w = 0.0;
    zero.poses[1].orientation.x = 0.0;
    zero.poses[1].orientation.y = 0.0;
    zero.poses[1].orientation.z = 0.0;
    let mut nan = array("base", &poses(3));
    nan.poses[2].position.y = f64::NAN;
    let empty = array("base", &[]);
    let good = array("base", &poses(3));
    let place = "bag.mcap, topic /poses, message 1, pose";
    let cases: [(&[&PoseArray], String); 3] = [
        (&[&good, &zero], format!("{place} 1 (counted from 0): the quaternion is zero, so there is no orientation")),
        (&[&good, &nan], format!("{place} 2 (counted from 0): a coordinate is not a finite number")),
        (&[&empty, &empty], "bag.mcap holds no poses".into()),
    ];
    for (messages, sentence) in cases {
        let mut bag = BagWriter::create(folder.path("bag.mcap")).unwrap();
        messages.iter().for_each(|message| bag.write("/poses", 0, *message).unwrap());
        bag.finish().unwrap();
        assert_eq!(folder.sentence(read_poses(folder.path("bag.mcap"), None)), sentence);
    }
}

#[test]
fn frames_and_types_that_change() {
    let folder = Folder::new();
    let mut bag = BagWriter::create(folder.path("bag.mcap")).unwrap();
    bag.write("/tool", 0, &stamped("base", 0, &poses(1)[0])).unwrap();
    bag.write("/tool", 1, &stamped("world", 0, &poses(1)[0])).unwrap();
    let wrong_type = bag.write("/tool", 2, &array("base", &poses(1)));
    assert_eq!(
        folder.sentence(wrong_type),
        "bag.mcap, topic /tool: a geometry_msgs/msg/PoseArray is written to a topic of geometry_msgs/msg/PoseStamped"
    );
    bag.finish().unwrap();
    assert_eq!(
        folder.sentence(read_poses(folder.path("bag.mcap"), None)),
        "bag.mcap, topic /tool, message 1 (counted from 0): the frame is \"world\" after \"base\""
    );
}

#[test]
fn a_child_frame_that_changes() {
    let folder = Folder::new();
    let write = |child_frames: &[&str]| {
        let _ = fs::remove_file(folder.path("bag.mcap"));
        let mut bag = BagWriter::create(folder.path("bag.mcap")).unwrap();
        for (time_ns, child) in (0..).zip(child_frames) {
            let pose = PoseWithCovariance { pose: stamped("odom", 0, &poses(1)[0]).pose, covariance: [0.0; 36] };
            let (header, twist) =
                (header("odom", 0), TwistWithCovariance { twist: Twist::default(), covariance: [0.0; 36] });
            bag.write("/odom", time_ns, &Odometry { header, child_frame_id: (*child).into(), pose, twist }).unwrap();
        }
        bag.finish().unwrap();
        read_poses(folder.path("bag.mcap"), None)
    };
    assert_eq!(write(&["base", "base"]).unwrap()[0].poses.len(), 2);
    assert_eq!(
        folder.sentence(write(&["base", "base", "camera", "base"])),
        "bag.mcap, topic /odom, message 2 (counted from 0): the child frame is \"camera\" after \"base\""
    );
}

/// A bag with messages of several types on `/poses`, which [`BagWriter`] refuses.
fn mixed_bag(folder: &Folder, messages: &[(&str, Vec<u8>)]) -> PathBuf {
    let path = folder.path("mixed.mcap");
    let mut writer = mcap::Writer::new(fs::File::create(&path).unwrap()).unwrap();
    for (k, (message_type, data)) in (0..).zip(messages) {
        let schema = writer.add_schema(message_type, "ros2msg", b"").unwrap();
        let channel_id = writer.add_channel(schema, "/poses", "cdr", &Default::default()).unwrap();
        let header = mcap::records::MessageHeader { channel_id, sequence: k, log_time: k.into(), publish_time: 0 };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    path
}

#[test]
fn a_topic_of_two_types_is_refused_whichever_comes_first() {
    let folder = Folder::new();
    let single = (PoseStamped::TYPE, encode(&stamped("base", 0, &poses(1)[0])).unwrap());
    let array = (PoseArray::TYPE, encode(&array("base", &poses(3))).unwrap());
    let path = Path { header: header("base", 0), poses: vec![stamped("base", 0, &poses(1)[0])] };
    let path = (Path::TYPE, encode(&path).unwrap());
    let text = (Text::TYPE, encode(&Text { data: "pose".into() }).unwrap());
    for (first, second) in [(&array, &single), (&path, &single), (&single, &array), (&array, &path), (&array, &text)] {
        let bag = mixed_bag(&folder, &[first.clone(), first.clone(), second.clone()]);
        assert_eq!(
            folder.sentence(read_poses(bag, None)),
            format!(
                "mixed.mcap, topic /poses, message 2 (counted from 0): it is a {} after those of {}",
                second.0, first.0
            )
        );
    }
}

#[test]
fn poses_of_a_path_in_another_frame() {
    let folder = Folder::new();
    let read = |frame: &str, of_poses: [&str; 3]| {
        let poses = of_poses.iter().zip(poses(3)).map(|(frame, pose)| stamped(frame, 0, &pose)).collect();
        let mut bag = BagWriter::create(folder.path("bag.mcap")).unwrap();
        bag.write("/path", 0, &Path { header: header(frame, 0), poses }).unwrap();
        bag.finish().unwrap();
        read_poses(folder.path("bag.mcap"), None)
    };
    let place = "bag.mcap, topic /path, message 0, pose";
    assert_eq!(
        folder.sentence(read("base", ["base", "camera", "base"])),
        format!("{place} 1 (counted from 0): the frame is \"camera\" in a path of \"base\"")
    );
    assert_eq!(
        folder.sentence(read("", ["", "base", "camera"])),
        format!("{place} 2 (counted from 0): the frame is \"camera\" in a path of \"base\"")
    );
    for (frame, of_poses) in [("base", ["", "base", ""]), ("", ["", "base", "base"])] {
        assert_eq!(read(frame, of_poses).unwrap()[0].frame_id, "base");
    }
}

/// A bag written by crate `mcap` alone, so that encoding and bytes may be wrong.
fn raw_bag(folder: &Folder, schema: &str, encoding: &str, data: &[u8]) -> PathBuf {
    let path = folder.path("raw.mcap");
    let mut writer = mcap::Writer::new(fs::File::create(&path).unwrap()).unwrap();
    let schema = writer.add_schema(schema, "ros2msg", b"").unwrap();
    let channel_id = writer.add_channel(schema, "/poses", encoding, &Default::default()).unwrap();
    let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
    writer.write_to_known_channel(&header, data).unwrap();
    writer.finish().unwrap();
    path
}

#[test]
fn bytes_that_are_no_message() {
    let folder = Folder::new();
    let array = "geometry_msgs/msg/PoseArray";
    let place = "raw.mcap, topic /poses, message 0 (counted from 0):";
    let cases: [(&str, &str, &[u8], String); 6] = [
        (array, "cdr", &[0, 1], format!("{place} the message has 2 bytes, too few for its 4-byte CDR header")),
        (array, "cdr", &[0, 9, 0, 0], format!("{place} the CDR header names the unknown representation 0x0009")),
        (
            "geometry_msgs/msg/PoseStamped",
            "cdr",
            &[0, 1, 0, 0, 0],
            format!("{place} the message of 5 bytes does not follow its definition: unexpected end of input"),
        ),
        (
            array,
            "cdr",
            &[[0, 1, 0, 0].as_slice(), &[0; 24]].concat(),
            format!("{place} the message has 28 bytes but its fields end after 20"),
        ),
        (array, "json", b"{}", "raw.mcap, topic /poses: the messages are encoded as \"json\" instead of cdr".into()),
        (
            "std_msgs/msg/String",
            "cdr",
            &[],
            "raw.mcap has no topic with poses (PoseArray, PoseStamped, PoseWithCovarianceStamped, Odometry, Path, TFMessage); \
             its topics: /poses (std_msgs/msg/String)"
                .into(),
        ),
    ];
    for (schema, encoding, data, sentence) in cases {
        assert_eq!(folder.sentence(read_poses(raw_bag(&folder, schema, encoding, data), None)), sentence);
    }
}

#[test]
fn files_that_are_no_bag() {
    let folder = Folder::new();
    assert_eq!(folder.refusal("a.mcap", ""), "a.mcap holds no poses");
    assert_eq!(
        folder.refusal("a.mcap", "x,y,z\n"),
        "a.mcap is not an MCAP file: its first bytes are not the MCAP magic"
    );
    let cut = "a.mcap is cut off: it ends in the middle of a record after 0 readable messages";
    assert_eq!(folder.refusal("a.mcap", &mcap::MAGIC[..5]), cut);
    let format = "expected .csv, .tum, .txt, .kitti, .mcap, .db3 or the folder of a rosbag2 bag";
    assert_eq!(folder.refusal("a.pdf", "%PDF"), format!("a.pdf is not a pose file: {format}"));
    let none = folder.sentence(read_poses(folder.path("none.mcap"), None));
    assert_eq!(none, "none.mcap: No such file or directory (os error 2)");
}

#[test]
fn folders_that_are_no_bag() {
    let folder = Folder::new();
    let bag = folder.path("bag");
    fs::create_dir(&bag).unwrap();
    let sentence = |metadata: &str| {
        fs::write(bag.join("metadata.yaml"), metadata).unwrap();
        folder.sentence(read_poses(&bag, None))
    };
    let metadata = |storage: &str, mode: &str, files: &str| {
        format!(
            "rosbag2_bagfile_information: {{version: 9, storage_identifier: {storage}, compression_mode: '{mode}', \
             relative_file_paths: [{files}]}}"
        )
    };
    let convert = "are not supported; `ros2 bag convert` makes an MCAP bag of it";
    assert_eq!(
        folder.sentence(read_poses(&bag, None)),
        "bag is not the folder of a rosbag2 bag: metadata.yaml: No such file or directory (os error 2)"
    );
    assert_eq!(sentence(&metadata("leveldb", "", "a.db")), format!("bag: bags with storage leveldb {convert}"));
    let by_chunk = format!("bag: bags with compression mode CHUNK {convert}");
    assert_eq!(sentence(&metadata("mcap", "CHUNK", "a.mcap")), by_chunk);
    let unnamed = format!("bag: bags with compression by  {convert}");
    assert_eq!(sentence(&metadata("mcap", "MESSAGE", "a.mcap")), unnamed);
    assert_eq!(sentence(&metadata("sqlite3", "", "a.db3")), "bag/a.db3: No such file or directory (os error 2)");
    assert_eq!(sentence(&metadata("mcap", "", "a.mcap")), "bag/a.mcap: No such file or directory (os error 2)");
    let not_metadata = "bag is not the folder of a rosbag2 bag: metadata.yaml:";
    assert_eq!(sentence(&metadata("mcap", "", "")), format!("{not_metadata} relative_file_paths is empty"));
    assert_eq!(sentence(&metadata("mcap", "", "..")), format!("{not_metadata} relative_file_paths names no file"));
    assert!(sentence("just: yaml").starts_with(not_metadata));
    assert!(sentence("\u{0}").starts_with(not_metadata));
}

#[test]
fn places_that_cannot_be_written() {
    let folder = Folder::new();
    let nowhere = folder.path("nowhere/bag");
    let error = folder.sentence(BagWriter::create(&nowhere));
    assert!(error.starts_with("nowhere/bag: ") && error.contains("No such file or directory"), "{error}");
    assert_eq!(BagWriter::create("..").err().unwrap().to_string(), ".. already exists and is not overwritten");
    fs::create_dir(folder.path("bag")).unwrap();
    assert_eq!(folder.sentence(BagWriter::create(folder.path("bag"))), "bag already exists and is not overwritten");
    let mut bag = BagWriter::create(folder.path("late")).unwrap();
    bag.write("/tool", 0, &PoseStamped { ..stamped("base", 0, &poses(1)[0]) }).unwrap();
    fs::create_dir(folder.path("late")).unwrap();
    folder.file("late/mine", "kept");
    assert!(folder.sentence(bag.finish()).starts_with("late: "));
    assert_eq!(fs::read_to_string(folder.path("late/mine")).unwrap(), "kept");
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 2, "nothing half-written stays");
}
