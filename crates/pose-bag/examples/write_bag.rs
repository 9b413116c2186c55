//! Writes a bag with one topic of every message type: `cargo run -p pose-bag --example write_bag BAG [none|zstd]`.

use std::error::Error;

use pose_bag::msg::{
    Duration, Header, JointTrajectory, JointTrajectoryPoint, Path, Pose, PoseArray, PoseStamped, Time,
};
use pose_bag::{BagWriter, Compression, OfferedQos};
use se3_geom::pose_from_xyzw;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let bag_path = arguments.next().ok_or("usage: write_bag BAG [none|zstd]")?;
    let compression = match arguments.next().as_deref() {
        Some("none") => Compression::None,
        _ => Compression::Zstd,
    };

    let start_ns: u64 = 1_700_000_000_000_000_000;
    let header = Header { stamp: Time { sec: 1_700_000_000, nanosec: 0 }, frame_id: "base_link".into() };
    let mut poses = Vec::new();
    for k in 0..5 {
        let half_angle = 0.1 * f64::from(k);
        let quaternion_xyzw = [half_angle.sin(), 0.0, 0.0, half_angle.cos()];
        poses.push(Pose::from(&pose_from_xyzw([0.1 * f64::from(k), 0.2, 0.3], quaternion_xyzw)?));
    }
    let stamped: Vec<_> = poses.iter().map(|&pose| PoseStamped { header: header.clone(), pose }).collect();
    let point = |positions: [f64; 2], sec| JointTrajectoryPoint {
        positions: positions.to_vec(),
        velocities: vec![0.0; 2],
        time_from_start: Duration { sec, nanosec: 500_000_000 },
        ..Default::default()
    };

    let mut bag = BagWriter::create_with(&bag_path, compression)?;
    bag.add_topic::<Path>("/path", OfferedQos::TransientLocal)?;
    bag.write("/poses", start_ns, &PoseArray { header: header.clone(), poses })?;
    for (time_ns, tool) in (start_ns..).step_by(20_000_000).zip(&stamped) {
        bag.write("/tool", time_ns, tool)?;
    }
    bag.write("/path", start_ns + 1, &Path { header: header.clone(), poses: stamped })?;
    let joint_names = ["shoulder", "elbow"].map(String::from).to_vec();
    let points = vec![point([0.25, -1.5], 0), point([0.5, 1e-300], 2)];
    bag.write("/joint_trajectory", start_ns + 2, &JointTrajectory { header, joint_names, points })?;
    Ok(bag.finish()?)
}
