//! Poses and bags for the tests.
#![allow(dead_code, clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use pose_bag::msg::{Header, Pose, PoseArray, PoseStamped, Time};
use pose_bag::{BagWriter, Compression};
use se3_geom::{Pose as SpatialPose, pose_from_xyzw};

/// Positions that no short decimal hits, and quaternions (2, 4, 5, 6)/9 turned round by `k`: all four components differ, so an
/// order mixed up shows.
pub(crate) fn pose(k: usize) -> SpatialPose {
    let q = [2.0, 4.0, 5.0, 6.0].map(|c: f64| c / 9.0);
    let quaternion_xyzw = std::array::from_fn(|i| q[(i + k) % 4]);
    let k = k as f64;
    pose_from_xyzw([0.1 * k, -0.2 * k, 1.0 / (1.0 + k)], quaternion_xyzw).unwrap()
}

pub(crate) fn poses(n: usize) -> Vec<SpatialPose> {
    (0..n).map(pose).collect()
}

pub(crate) fn header(frame_id: &str, stamp_ns: i64) -> Header {
    Header { stamp: Time::from_nanos(stamp_ns).unwrap(), frame_id: frame_id.into() }
}

pub(crate) fn array(frame_id: &str, poses: &[SpatialPose]) -> PoseArray {
    PoseArray { header: header(frame_id, 0), poses: poses.iter().map(Pose::from).collect() }
}

pub(crate) fn stamped(frame_id: &str, stamp_ns: i64, pose: &SpatialPose) -> PoseStamped {
    PoseStamped { header: header(frame_id, stamp_ns), pose: pose.into() }
}

/// A bag of `n` stamped poses on `/tool`; the path of its MCAP file.
pub(crate) fn small_bag(folder: &Path, compression: Compression, n: usize) -> PathBuf {
    let path = folder.join(format!("small_{compression:?}.mcap"));
    let mut bag = BagWriter::create_with(&path, compression).unwrap();
    for k in 0..n {
        bag.write("/tool", k as u64, &stamped("base", k as i64, &pose(k))).unwrap();
    }
    bag.finish().unwrap();
    path
}

/// Reading writes the quaternion anew as q/|q|. For a quaternion that is normalised already, |q| is within 3 ε of 1 (three
/// additions and a root round, ε = 2⁻⁵²), so each component, below 1, moves by at most 4 ε.
pub(crate) const RENORMALISED: f64 = 4.0 * f64::EPSILON;

/// Positions have the same bits, quaternions the same components in the same places.
pub(crate) fn assert_same(read: &[SpatialPose], written: &[SpatialPose]) {
    assert_eq!(read.len(), written.len());
    for (a, b) in read.iter().zip(written) {
        for axis in 0..3 {
            assert_eq!(a.translation.vector[axis].to_bits(), b.translation.vector[axis].to_bits());
        }
        let worst = (a.rotation.coords - b.rotation.coords).amax();
        assert!(worst <= RENORMALISED, "{worst:e}");
    }
}
