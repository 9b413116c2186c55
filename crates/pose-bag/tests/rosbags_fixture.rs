//! Bags that PyPI rosbags 0.11.9 wrote (`tests/rosbags_peer.py write`), without Python.

mod support;

use pose_bag::read_poses;
use support::{assert_same, pose, poses};

const START_NS: i64 = 1_700_000_000_000_000_000;

fn fixture(name: &str) -> String {
    format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn both_storages_all_compressions_and_both_byte_orders_are_read() {
    for bag in [
        "rosbags_none",
        "rosbags_zstd",
        "rosbags_mcap_message",
        "rosbags_mcap_file",
        "rosbags_sqlite3_none",
        "rosbags_sqlite3_message",
        "rosbags_sqlite3_file",
    ] {
        let scans = read_poses(fixture(bag), Some("/scan")).unwrap();
        assert_eq!(scans.len(), 2);
        assert_eq!((scans[0].frame_id.as_str(), scans[1].frame_id.as_str()), ("base", "a frame of odd length"));
        assert_same(&scans[0].poses, &poses(7));
        assert_same(&scans[1].poses, &[pose(100), pose(101), pose(102)]);

        let tool = read_poses(fixture(bag), Some("/tool")).unwrap();
        assert_eq!(tool.len(), 1);
        assert_same(&tool[0].poses, &poses(5));
        let stamps: Vec<_> = (0..5).map(|k| START_NS + 20_000_000 * k + 7).collect();
        assert_eq!(tool[0].stamps_ns.as_deref(), Some(&stamps[..]));
    }
}

#[test]
fn the_topics_to_choose_from_are_named() {
    let bag = fixture("rosbags_zstd");
    let error = read_poses(&bag, None).unwrap_err().to_string();
    assert_eq!(
        error,
        format!(
            "{bag} has several topics with poses, name one of them: \
             /scan (geometry_msgs/msg/PoseArray), /tool (geometry_msgs/msg/PoseStamped)"
        )
    );
    let error = read_poses(&bag, Some("/note")).unwrap_err().to_string();
    assert!(
        error
            .starts_with(&format!("{bag} has no poses on topic /note; its topics: /note (std_msgs/msg/String), /scan"))
    );
}
