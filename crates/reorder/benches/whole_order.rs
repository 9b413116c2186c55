//! Prints the wall seconds that the order of a million poses takes, as JSON: the figure that `cargo xtask bench python` compares with.
//!
//! usage: whole_order FOLDER, which holds them as little-endian doubles x y z qx qy qz qw.
#![allow(missing_docs)]
#![allow(clippy::unwrap_used, reason = "a tool for developers")]

use std::path::Path;
use std::time::Instant;

use reorder::{Options, order_poses};
use se3_geom::{Pose, pose_from_xyzw};

fn main() {
    let Some(folder) = std::env::args().nth(1).filter(|folder| Path::new(folder).is_dir()) else {
        return; // `cargo test` and `cargo bench` run it without a folder
    };
    let bytes = std::fs::read(Path::new(&folder).join("clean 1e6")).unwrap();
    let numbers: Vec<f64> = bytes.chunks_exact(8).map(|x| f64::from_le_bytes(x.try_into().unwrap())).collect();
    let pose = |x: &[f64]| pose_from_xyzw([x[0], x[1], x[2]], [x[3], x[4], x[5], x[6]]).unwrap();
    let poses: Vec<Pose> = numbers.chunks_exact(7).map(pose).collect();
    let start = Instant::now();
    let ordering = order_poses(&poses, 1.0, &Options::default()).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(ordering.order.len(), poses.len());
    println!("{}", serde_json::json!({ "order clean 1e6": seconds }));
}
