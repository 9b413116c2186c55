//! KITTI and EuRoC, and which poses of a bag are taken together.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;

use pose_bag::msg::{
    Header, Message, Odometry, Path, Pose, PoseWithCovariance, PoseWithCovarianceStamped, TfMessage, Transform,
    TransformStamped, Twist, TwistWithCovariance, Vector3,
};
use pose_bag::{BagWriter, Grouping, Selection, read_poses, read_table, recover_poses};
use support::{array, assert_same, header, pose, poses, stamped};

#[test]
fn kitti_is_told_from_tum_by_its_numbers() {
    let folder = tempfile::tempdir().unwrap();
    // A quarter turn about z takes x to y: the first column of R is y.
    let text = "0 -1 0 1.5 1 0 0 -2 0 0 1 3e-1\n1 0 0 4 0 1 0 5 0 0 1 6\n";
    for name in ["00.txt", "00.kitti", "00.tum"] {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        let set = read_poses(&path, None).unwrap().remove(0);
        assert_eq!((set.poses.len(), &set.stamps_ns), (2, &None));
        assert_eq!(set.poses[0].translation.vector, se3_geom::nalgebra::Vector3::new(1.5, -2.0, 0.3));
        let half = 0.5_f64.sqrt();
        let expected = se3_geom::nalgebra::Vector4::new(0.0, 0.0, half, half);
        assert!((set.poses[0].rotation.coords - expected).amax() < 2.0 * f64::EPSILON, "{}", set.poses[0].rotation);
    }
    // Any rotation comes back from its matrix, up to the sign of the quaternion and the rounding of nine products.
    let rows: Vec<String> = poses(20)
        .iter()
        .map(|pose| {
            let matrix = pose.to_homogeneous();
            let row = |k: usize| matrix.row(k).iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
            [row(0), row(1), row(2)].join(" ")
        })
        .collect();
    let path = folder.path().join("many.kitti");
    fs::write(&path, rows.join("\n")).unwrap();
    for (read, written) in read_poses(&path, None).unwrap()[0].poses.iter().zip(poses(20)) {
        assert_eq!(read.translation, written.translation);
        assert!(read.rotation.angle_to(&written.rotation) < 1e-7, "acos resolves sqrt(ε) near 0");
    }
}

#[test]
fn euroc_has_w_first_and_stamps_that_no_double_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("data.csv");
    let text = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1]\n\
                1403636580838555648,4.5,-1.25,0.5,0.8,0.2,0.4,-0.4,9\r\n1403636580838555649,1,2,3,1,0,0,0,9\n";
    fs::write(&path, text).unwrap();
    let set = read_poses(&path, None).unwrap().remove(0);
    assert_eq!(set.stamps_ns.as_deref(), Some(&[1_403_636_580_838_555_648, 1_403_636_580_838_555_649][..]));
    let q = set.poses[0].rotation;
    assert!((q.coords - se3_geom::nalgebra::Vector4::new(0.2, 0.4, -0.4, 0.8)).amax() <= support::RENORMALISED);
    assert_eq!(set.poses[0].translation.vector, se3_geom::nalgebra::Vector3::new(4.5, -1.25, 0.5));
    let table = read_table(&path).unwrap();
    assert!(table.is_euroc());
    assert_eq!(table.columns(), ["t", "x", "y", "z", "qw", "qx", "qy", "qz", "v_RS_R_x"]);
}

#[test]
fn every_type_with_poses_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("types.mcap");
    let mut bag = BagWriter::create(&path).unwrap();
    let with_covariance = |k: usize| PoseWithCovariance { pose: Pose::from(&pose(k)), covariance: [0.5; 36] };
    let twist = TwistWithCovariance { twist: Twist::default(), covariance: [0.25; 36] };
    for k in 0..4 {
        let header = || Header { frame_id: "map".into(), ..header("", 10 + k as i64) };
        let stamped = PoseWithCovarianceStamped { header: header(), pose: with_covariance(k) };
        bag.write("/amcl", k as u64, &stamped).unwrap();
        let child_frame_id = "base_link".into();
        let odometry = Odometry { header: header(), child_frame_id, pose: with_covariance(k), twist: twist.clone() };
        bag.write("/odom", k as u64, &odometry).unwrap();
        let path =
            Path { header: header(), poses: (0..=k).map(|k| support::stamped("map", k as i64, &pose(k))).collect() };
        bag.write("/plan", k as u64, &path).unwrap();
    }
    bag.finish().unwrap();
    for topic in ["/amcl", "/odom"] {
        let set = read_poses(&path, Some(topic)).unwrap().remove(0);
        assert_eq!((set.frame_id.as_str(), set.stamps_ns.as_deref()), ("map", Some(&[10, 11, 12, 13][..])));
        assert_same(&set.poses, &poses(4));
    }
    let paths = read_poses(&path, Some("/plan")).unwrap();
    assert_eq!(paths.iter().map(|set| set.poses.len()).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert_eq!((paths[3].origin.message, paths[3].stamps_ns.as_deref()), (Some(3), Some(&[0, 1, 2, 3][..])));
    assert_same(&paths[3].poses, &poses(4));
}

#[test]
fn a_path_is_chosen_where_there_is_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.mcap");
    for with_poses in [true, false] {
        let mut bag = BagWriter::create(&path).unwrap();
        let curve = Path { header: header("", 0), poses: vec![stamped("", 0, &pose(9))] };
        bag.write("/path", 0, &curve).unwrap();
        if with_poses {
            bag.write("/poses", 0, &array("base", &poses(3))).unwrap();
        }
        bag.finish().unwrap();
        assert_eq!(read_poses(&path, None).unwrap()[0].poses.len(), if with_poses { 3 } else { 1 });
    }
}

fn transform(parent: &str, child: &str, k: usize) -> TransformStamped {
    let Pose { position, orientation } = Pose::from(&pose(k));
    let translation = Vector3 { x: position.x, y: position.y, z: position.z };
    let transform = Transform { translation, rotation: orientation };
    TransformStamped { header: header(parent, 7 + k as i64), child_frame_id: child.into(), transform }
}

fn select(parent: &str, child: &str) -> Selection {
    Selection { frames: Some((parent.into(), child.into())), ..Selection::default() }
}

#[test]
fn transforms_between_one_pair_of_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tf.mcap");
    let mut bag = BagWriter::create(&path).unwrap();
    for k in 0..5 {
        let transforms = vec![transform("map", "odom", 50 + k), transform("/base", "tool", k)];
        bag.write("/tf", k as u64, &TfMessage { transforms }).unwrap();
    }
    bag.finish().unwrap();
    let (sets, losses) = recover_poses(&path, &select("base", "tool")).unwrap();
    assert!(losses.is_empty());
    assert_eq!((sets.len(), sets[0].frame_id.as_str()), (1, "base"));
    assert_eq!(sets[0].stamps_ns.as_deref(), Some(&[7, 8, 9, 10, 11][..]));
    assert_same(&sets[0].poses, &poses(5));
    for selection in [Selection::default(), select("base", "camera")] {
        let error = recover_poses(&path, &selection).unwrap_err().to_string();
        assert!(error.ends_with("topic /tf: name one of the frame pairs map:odom, base:tool"), "{error}");
    }
    assert_eq!(TfMessage::TYPE, "tf2_msgs/msg/TFMessage");
}

#[test]
fn frames_that_are_named_mean_the_transforms_that_have_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("several.mcap");
    let write = |with_static: bool| {
        let mut bag = BagWriter::create(&path).unwrap();
        for k in 0..3 {
            bag.write("/goal", k as u64, &stamped("base", 0, &pose(50 + k))).unwrap();
            bag.write("/tf", k as u64, &TfMessage { transforms: vec![transform("base", "tool", k)] }).unwrap();
            if with_static {
                let transforms = vec![transform("tool", "camera", 70 + k), transform("base", "table", 80)];
                bag.write("/tf_static", k as u64, &TfMessage { transforms }).unwrap();
            }
        }
        bag.finish().unwrap();
    };
    for with_static in [false, true] {
        write(with_static);
        let (sets, _) = recover_poses(&path, &select("base", "tool")).unwrap();
        assert_same(&sets[0].poses, &poses(3));
        assert_eq!(sets[0].origin.topic.as_deref(), Some("/tf"));
    }
    let (sets, _) = recover_poses(&path, &select("tool", "camera")).unwrap();
    assert_eq!(sets[0].origin.topic.as_deref(), Some("/tf_static"));
    let refusal = |parent: &str| recover_poses(&path, &select(parent, "x")).unwrap_err().to_string();
    let topics = "/tf (tf2_msgs/msg/TFMessage), /tf_static (tf2_msgs/msg/TFMessage)";
    let sentence = refusal("nonsense");
    assert!(
        sentence.ends_with(&format!("has no transforms nonsense:x; its topics of transforms: {topics}")),
        "{sentence}"
    );
    write(false);
    let sentence = refusal("nonsense");
    assert!(sentence.ends_with("topic /tf: name one of the frame pairs base:tool"), "{sentence}");
    let mut bag = BagWriter::create(&path).unwrap();
    bag.write("/goal", 0, &stamped("base", 0, &pose(1))).unwrap();
    bag.finish().unwrap();
    let sentence = refusal("nonsense");
    assert!(sentence.ends_with("has no transforms nonsense:x; its topics of transforms: none"), "{sentence}");
}

#[test]
fn a_pair_of_frames_is_found_among_any_number() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hands.mcap");
    let mut bag = BagWriter::create(&path).unwrap();
    for k in 0..3 {
        let mut transforms: Vec<_> = (0..150).map(|link| transform("hand", &format!("link{link}"), 9)).collect();
        transforms.push(transform("base", "tool", k));
        bag.write("/tf", k as u64, &TfMessage { transforms }).unwrap();
    }
    bag.finish().unwrap();
    assert_same(&recover_poses(&path, &select("base", "tool")).unwrap().0[0].poses, &poses(3));
    let error = recover_poses(&path, &select("base", "camera")).unwrap_err().to_string();
    assert!(error.contains("topic /tf: name one of the frame pairs hand:link0, "), "{error}");
}

#[test]
fn single_poses_are_taken_together_by_window_or_gap() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("single.mcap");
    let mut bag = BagWriter::create(&path).unwrap();
    for (k, &time) in [0, 1, 2, 5, 6, 10, 11, 12, 13].iter().enumerate() {
        bag.write("/tool", time, &stamped("base", 0, &pose(k))).unwrap();
    }
    bag.finish().unwrap();
    let lengths = |grouping| {
        let (sets, _) = recover_poses(&path, &Selection { grouping, ..Selection::default() }).unwrap();
        assert_same(&sets.iter().flat_map(|set| set.poses.clone()).collect::<Vec<_>>(), &poses(9));
        sets.iter().map(|set| (set.log_time_ns, set.poses.len())).collect::<Vec<_>>()
    };
    assert_eq!(lengths(Grouping::Whole), [(0, 9)]);
    assert_eq!(lengths(Grouping::Gap { longest_ns: 2 }), [(0, 3), (5, 2), (10, 4)]);
    assert_eq!(lengths(Grouping::Window { length_ns: 3 }), [(0, 3), (5, 2), (10, 3), (13, 1)]);
    // Windows begin with their first pose: 0 to 5, 6 to 11, 12 on.
    assert_eq!(lengths(Grouping::Window { length_ns: 6 }), [(0, 4), (6, 3), (12, 2)]);
}
