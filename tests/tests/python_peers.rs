//! Independent Python implementations as judges: rosbags and mcap-ros2-support of our bags, and the tests of the rclpy peers.
#![allow(clippy::unwrap_used, missing_docs)]

use end_to_end::{python, recording, root};
use pose_bag::msg::{Header, JointTrajectory, JointTrajectoryPoint, PoseArray, Time};
use pose_bag::{BagWriter, Compression, OfferedQos};
use serde_json::json;

const READER: &str = "crates/pose-bag/tests/rosbags_peer.py";

#[test]
fn our_bags_open_in_rosbags_and_mcap_ros2_support() {
    let (poses, _) = recording("lasa_sine");
    let header = Header { stamp: Time { sec: 7, nanosec: 9 }, frame_id: "base_link".into() };
    let array = PoseArray { header: header.clone(), poses: poses.iter().map(Into::into).collect() };
    let point = JointTrajectoryPoint { positions: vec![0.1, -0.2], ..JointTrajectoryPoint::default() };
    let trajectory = JointTrajectory { header, joint_names: vec!["a".into(), "b".into()], points: vec![point] };
    let folder = tempfile::tempdir().unwrap();
    for (name, compression) in [("none", Compression::None), ("zstd", Compression::Zstd)] {
        let path = folder.path().join(name);
        let mut bag = BagWriter::create_with(&path, compression).unwrap();
        bag.add_topic::<JointTrajectory>("/joint_trajectory", OfferedQos::TransientLocal).unwrap();
        bag.write("/reorder/poses", 5, &array).unwrap();
        bag.write("/joint_trajectory", 6, &trajectory).unwrap();
        bag.finish().unwrap();
        for reader in ["rosbags", "mcap"] {
            let output = python(&[READER, "read", path.to_str().unwrap(), "--reader", reader]);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            let (read, planned) = (&said["topics"]["/reorder/poses"], &said["topics"]["/joint_trajectory"]);
            assert_eq!(
                (&read["type"], &read["elements"]),
                (&json!("geometry_msgs/msg/PoseArray"), &json!(poses.len()))
            );
            assert_eq!(read["frame_id"], "base_link");
            // Both languages print the shortest text that reads back to the same double, so these agree to the last bit.
            assert_eq!(read["first"], serde_json::to_value(array.poses[0]).unwrap(), "{reader}, {name}");
            assert_eq!(read["last"], serde_json::to_value(array.poses[poses.len() - 1]).unwrap(), "{reader}, {name}");
            assert_eq!(planned["type"], "trajectory_msgs/msg/JointTrajectory");
            assert_eq!(planned["first"]["positions"], json!([0.1, -0.2]));
        }
    }
}

#[test]
fn the_peers_checker_catches_its_mutants() {
    let output = python(&["-m", "unittest", "discover", "-s", "tests/peers"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let ran = said.lines().find(|line| line.starts_with("Ran ")).unwrap_or_default();
    assert!(ran.starts_with("Ran 2") || ran.starts_with("Ran 3"), "some twenty tests ran: {said}");
    assert!(root().join("tests/peers/test_receive_trajectory.py").exists());
}
