//! Any bytes as a TUM, KITTI or EuRoC track: an error, or as many poses as stamps.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pose_bag::read_poses;

fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["track.txt", "track.csv"] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        let Ok(sets) = read_poses(&path, None) else { continue };
        assert_eq!(sets.len(), 1);
        for set in sets {
            assert!(set.stamps_ns.is_none_or(|stamps| stamps.len() == set.poses.len()));
            assert!(set.poses.iter().all(|pose| (pose.rotation.norm() - 1.0).abs() < 1e-9));
            assert!(set.poses.iter().all(|pose| pose.translation.vector.iter().all(|x| x.is_finite())));
        }
    }
});
