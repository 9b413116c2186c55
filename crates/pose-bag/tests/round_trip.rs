//! What is written reads back.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;

use pose_bag::msg::{Duration, JointTrajectory, JointTrajectoryPoint, Path, Time};
use pose_bag::{BagError, BagWriter, Compression, OfferedQos, Table, decode, encode, read_poses, write_csv, write_tum};
use proptest::prelude::*;
use support::{array, assert_same, header, pose, poses, stamped};

#[test]
fn csv() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("poses.csv");
    write_csv(&path, &poses(9)).unwrap();
    let sets = read_poses(&path, None).unwrap();
    assert_eq!(sets.len(), 1);
    assert_eq!((sets[0].frame_id.as_str(), &sets[0].stamps_ns, &sets[0].origin.file), ("", &None, &path));
    assert_same(&sets[0].poses, &poses(9));
}

#[test]
fn csv_columns_in_any_order_with_others_between() {
    let text = "\u{feff}# made by hand\r\nt,qw,qx,qy,qz,label,x,y,z\r\n\r\n2024-01-01,0.8,0.2,0.4,-0.4,\"a\",1,2,3\r\n";
    let table = Table::from_reader(text.as_bytes(), "poses.csv").unwrap();
    assert_eq!(table.line_numbers().collect::<Vec<_>>(), [4]);
    assert_eq!(table.select(&["z", "x"]).unwrap(), [[3.0, 1.0]]);
    let pose = table.poses().unwrap()[0];
    assert_eq!((pose.translation.x, pose.translation.y, pose.translation.z), (1.0, 2.0, 3.0));
    let q = pose.rotation.coords - se3_geom::nalgebra::Vector4::new(0.2, 0.4, -0.4, 0.8);
    assert!(q.amax() <= support::RENORMALISED, "{q}");
    assert!(table.has_column("label") && !table.has_column("qv"));
}

#[test]
fn tum_with_stamps_that_no_double_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("track.tum");
    let stamps = [-1_500_000_001, -1, 0, 1_403_636_579_763_555_584, 1_403_636_579_763_555_585];
    let written: Vec<_> = stamps.into_iter().zip(poses(5)).collect();
    write_tum(&path, &written).unwrap();
    let sets = read_poses(&path, None).unwrap();
    assert_eq!(sets[0].stamps_ns.as_deref(), Some(&stamps[..]));
    assert_same(&sets[0].poses, &poses(5));

    let text = "# time x y z qx qy qz qw\n1.5e1\t0 0 0  0 0 0 1\n.25 0 0 0 0 0 0 1\n";
    fs::write(&path, text).unwrap();
    assert_eq!(read_poses(&path, None).unwrap()[0].stamps_ns.as_deref(), Some(&[15_000_000_000, 250_000_000][..]));
}

#[test]
fn every_pose_array_is_a_set_in_the_order_of_recording() {
    let folder = tempfile::tempdir().unwrap();
    for compression in [Compression::None, Compression::Zstd] {
        let path = folder.path().join(format!("{compression:?}"));
        let mut bag = BagWriter::create_with(&path, compression).unwrap();
        bag.write("/poses", 20, &array("second", &poses(2))).unwrap();
        bag.write("/poses", 10, &array("first", &poses(7))).unwrap();
        bag.finish().unwrap();
        let sets = read_poses(&path, None).unwrap();
        assert_eq!(sets.iter().map(|set| set.frame_id.as_str()).collect::<Vec<_>>(), ["first", "second"]);
        assert_eq!(sets[0].origin.message, Some(1));
        assert_eq!(sets[0].origin.topic.as_deref(), Some("/poses"));
        assert_same(&sets[0].poses, &poses(7));
        assert_same(&sets[1].poses, &poses(2));
        // The MCAP file alone is a bag too, by its name or by its magic.
        let mcap = path.join(format!("{compression:?}_0.mcap"));
        assert_eq!(read_poses(&mcap, Some("/poses")).unwrap().len(), 2);
        let renamed = folder.path().join("recording.bin");
        fs::copy(&mcap, &renamed).unwrap();
        assert_eq!(read_poses(&renamed, None).unwrap().len(), 2);
    }
}

#[test]
fn stamped_poses_of_a_topic_are_one_set() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag");
    let mut bag = BagWriter::create(&path).unwrap();
    for k in [0, 2, 1] {
        bag.write("/tool", k, &stamped("base", 1000 + k as i64, &pose(k as usize))).unwrap();
        bag.write("/poses", k, &array("base", &poses(3))).unwrap();
    }
    bag.finish().unwrap();
    let sets = read_poses(&path, Some("/tool")).unwrap();
    assert_eq!(sets.len(), 1);
    assert_eq!(sets[0].stamps_ns.as_deref(), Some(&[1000, 1001, 1002][..]));
    assert_same(&sets[0].poses, &poses(3));
    assert_eq!(read_poses(&path, Some("/poses")).unwrap().len(), 3);
}

#[test]
fn a_bag_over_several_files_and_many_chunks() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, part) = (folder.path().join("whole"), folder.path().join("part.mcap"));
    // 20 arrays of 1,000 poses, 56 bytes each: more than one megabyte, the size of a chunk.
    let mut bag = BagWriter::create_with(&whole, Compression::None).unwrap();
    for k in 0..20 {
        bag.write("/poses", k, &array("base", &poses(1000))).unwrap();
    }
    bag.finish().unwrap();
    let mut bag = BagWriter::create(&part).unwrap();
    bag.write("/poses", 20, &array("base", &poses(4))).unwrap();
    bag.finish().unwrap();
    fs::rename(&part, whole.join("whole_1.mcap")).unwrap();
    let metadata = whole.join("metadata.yaml");
    let text = fs::read_to_string(&metadata).unwrap();
    let longer = text.replace(
        "relative_file_paths:\n  - whole_0.mcap",
        "relative_file_paths:\n  - whole_0.mcap\n  - whole/whole_1.mcap",
    );
    assert_ne!(longer, text);
    fs::write(&metadata, longer).unwrap();

    let sets = read_poses(&whole, None).unwrap();
    assert_eq!(sets.iter().map(|set| set.poses.len()).collect::<Vec<_>>(), [[1000; 20].as_slice(), &[4]].concat());
    assert_same(&sets[19].poses, &poses(1000));
    assert_eq!(sets[20].origin.file, whole.join("whole_1.mcap"));
}

#[test]
fn nothing_is_seen_of_a_bag_before_its_end_nor_left_of_one_without_end() {
    let folder = tempfile::tempdir().unwrap();
    let entries = || fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect::<Vec<_>>();
    let path = folder.path().join("bag");
    let mut bag = BagWriter::create(&path).unwrap();
    bag.write("/poses", 1, &array("base", &poses(2))).unwrap();
    assert!(!path.exists());
    drop(bag);
    assert!(entries().is_empty(), "{:?}", entries());

    let mut bag = BagWriter::create(&path).unwrap();
    bag.add_topic::<Path>("/path", OfferedQos::TransientLocal).unwrap();
    bag.finish().unwrap();
    assert_eq!(entries(), ["bag"]);
    assert!(matches!(BagWriter::create(&path), Err(BagError::AlreadyExists { .. })));
    assert_eq!(entries(), ["bag"]);
}

#[test]
fn path_and_joint_trajectory_keep_every_bit() {
    let path = Path { header: header("base", -1), poses: (0..3).map(|k| stamped("tool", k, &pose(2))).collect() };
    assert_eq!(decode::<Path>(&encode(&path).unwrap()).unwrap(), path);
    assert_eq!(path.header.stamp, Time { sec: -1, nanosec: 999_999_999 });
    let point = |x: f64| JointTrajectoryPoint {
        positions: vec![x, -x],
        velocities: vec![f64::MIN_POSITIVE; 2],
        accelerations: vec![],
        effort: vec![f64::MAX],
        time_from_start: Duration { sec: 3, nanosec: 7 },
    };
    let joint_names = ["a", "", "größer"].map(String::from).to_vec();
    let trajectory = JointTrajectory { header: header("", 5), joint_names, points: vec![point(0.1), point(-0.0)] };
    assert_eq!(decode::<JointTrajectory>(&encode(&trajectory).unwrap()).unwrap(), trajectory);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(2), ..ProptestConfig::with_cases(200) })]

    /// Text is the shortest that reads back to the same double, whatever its size.
    #[test]
    fn any_position_survives_csv_bit_by_bit(position in prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.csv");
        let written = se3_geom::pose_from_xyzw(position, [0.0, 0.0, 0.0, 1.0]).unwrap();
        write_csv(&path, &[written]).unwrap();
        assert_same(&read_poses(&path, None).unwrap()[0].poses, &[written]);
    }

    #[test]
    fn stamps_split_and_join(nanos in i64::from(i32::MIN) * 1_000_000_000..=i64::from(i32::MAX) * 1_000_000_000) {
        prop_assert_eq!(Time::from_nanos(nanos).unwrap().to_nanos(), nanos);
    }
}
