//! Prints the processor seconds that spanning trees take, as JSON: the figures of `cargo xtask bench ordering`.
//!
//! usage: figures FOLDER, which holds the sets as little-endian doubles, the coordinates of one point after another (poses: x y z
//! qx qy qz qw). The least of a few: what other processes take of the machine only ever adds. Wall seconds for two threads.
#![allow(missing_docs)]
#![allow(clippy::unwrap_used, reason = "a tool for developers")]

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use reorder::minimum_spanning_tree;
use se3_geom::nalgebra::{Isometry3, Quaternion, SVector, Translation3, UnitQuaternion};
use se3_geom::{Euclidean, Manifold, Pose, Se3};

fn main() {
    let Some(folder) = std::env::args().nth(1).filter(|folder| Path::new(folder).is_dir()) else {
        return; // `cargo test` and `cargo bench` run it without a folder
    };
    let read = |name: &str, width: usize| -> Vec<Vec<f64>> {
        let bytes = std::fs::read(Path::new(&folder).join(name)).unwrap();
        let numbers: Vec<f64> = bytes.chunks_exact(8).map(|x| f64::from_le_bytes(x.try_into().unwrap())).collect();
        numbers.chunks_exact(width).map(<[f64]>::to_vec).collect()
    };
    let poses = |name: &str| -> Vec<Pose> {
        let pose = |x: &Vec<f64>| {
            let rotation = UnitQuaternion::new_normalize(Quaternion::new(x[6], x[3], x[4], x[5]));
            Isometry3::from_parts(Translation3::new(x[0], x[1], x[2]), rotation)
        };
        read(name, 7).iter().map(pose).collect()
    };
    let mut costs = BTreeMap::new();
    let points: Vec<_> = read("r3 1e6", 3).iter().map(|x| SVector::<f64, 3>::from_column_slice(x)).collect();
    costs.insert("r3 1e6".to_owned(), least(&Euclidean::<3>, &points, 1, 1).cpu);
    let points: Vec<_> = read("r7 1e5", 7).iter().map(|x| SVector::<f64, 7>::from_column_slice(x)).collect();
    costs.insert("r7 1e5".to_owned(), least(&Euclidean::<7>, &points, 1, 3).cpu);
    for kind in ["smooth", "full turns", "clusters", "duplicates", "identical", "uniform"] {
        let name = format!("se3 {kind} 1e5");
        let cost = least(&Se3::default(), &poses(&name), 1, 3).cpu;
        costs.insert(name, cost);
    }
    let million = poses("se3 smooth 1e6");
    let [one, two] = [1, 2].map(|threads| least(&Se3::default(), &million, threads, 1));
    assert_eq!(one.fingerprint, two.fingerprint, "the tree depends on the number of threads");
    costs.insert("se3 smooth 1e6".to_owned(), one.cpu);
    costs.insert("one thread, wall".to_owned(), one.wall);
    costs.insert("two threads, wall".to_owned(), two.wall);
    println!("{}", serde_json::to_string(&costs).unwrap());
}

struct Cost {
    wall: f64,
    cpu: f64,
    fingerprint: u64,
}

fn least<M: Manifold<Point: Sync> + Sync>(manifold: &M, points: &[M::Point], threads: usize, repeats: usize) -> Cost {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut cost = Cost { wall: f64::INFINITY, cpu: f64::INFINITY, fingerprint: 0 };
    for _ in 0..repeats {
        let (start, cpu_start) = (Instant::now(), cpu_seconds());
        let tree = pool.install(|| minimum_spanning_tree(manifold, points)).unwrap();
        cost.wall = cost.wall.min(start.elapsed().as_secs_f64());
        cost.cpu = cost.cpu.min(cpu_seconds() - cpu_start);
        cost.fingerprint = tree.raw_edges().iter().fold(0, |state: u64, edge| {
            let ends = edge.source().index() as u64 ^ (edge.target().index() as u64) << 32;
            (state.rotate_left(5) ^ ends ^ edge.weight.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        });
    }
    cost
}

/// Processor time of all threads of this process, from /proc/self/task/*/schedstat.
fn cpu_seconds() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let nanoseconds = threads.filter_map(|thread| {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    nanoseconds.sum::<f64>() * 1e-9
}
