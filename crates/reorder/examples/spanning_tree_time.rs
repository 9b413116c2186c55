//! Times the minimum spanning tree of a file of points, for comparison with others on the same file.
//!
//! usage: spanning_tree_time SPACE FILE THREADS REPEATS
//!
//! SPACE is r2, r3, r7, s2, so3 or se3; FILE holds little-endian doubles, the coordinates of one point after another (se3: x y z
//! qx qy qz qw). Prints one JSON object: the least wall and processor seconds, the weight of the tree, and the peak of memory
//! above the points themselves.
#![allow(clippy::unwrap_used, reason = "a tool for developers")]

use std::time::Instant;

use reorder::minimum_spanning_tree;
use se3_geom::nalgebra::{Isometry3, Quaternion, SVector, Translation3, UnitQuaternion, Vector3};
use se3_geom::{Euclidean, Manifold, Se3, So3, Sphere};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [space, file, threads, repeats] = arguments.as_slice() else {
        panic!("usage: spanning_tree_time SPACE FILE THREADS REPEATS")
    };
    let bytes = std::fs::read(file).unwrap();
    let numbers: Vec<f64> = bytes.chunks_exact(8).map(|x| f64::from_le_bytes(x.try_into().unwrap())).collect();
    drop(bytes);
    let task = Task { space, threads: threads.parse().unwrap(), repeats: repeats.parse().unwrap() };
    let rotation = |q: &[f64]| UnitQuaternion::new_normalize(Quaternion::from(SVector::from_column_slice(q)));
    match space.as_str() {
        "r2" => task.time(&Euclidean::<2>, numbers, 2, SVector::from_column_slice),
        "r3" => task.time(&Euclidean::<3>, numbers, 3, SVector::from_column_slice),
        "r7" => task.time(&Euclidean::<7>, numbers, 7, SVector::from_column_slice),
        "s2" => task.time(&Sphere, numbers, 3, |x| Vector3::from_column_slice(x).normalize()),
        "so3" => task.time(&So3, numbers, 4, rotation),
        "se3" => task.time(&Se3::default(), numbers, 7, |x| {
            Isometry3::from_parts(Translation3::new(x[0], x[1], x[2]), rotation(&x[3..]))
        }),
        other => panic!("no space {other}"),
    }
}

struct Task<'a> {
    space: &'a str,
    threads: usize,
    repeats: usize,
}

impl Task<'_> {
    fn time<M: Manifold<Point: Sync> + Sync>(
        &self,
        manifold: &M,
        numbers: Vec<f64>,
        width: usize,
        point: impl Fn(&[f64]) -> M::Point,
    ) {
        let points: Vec<M::Point> = numbers.chunks_exact(width).map(point).collect();
        drop(numbers);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build().unwrap();
        let before = status("VmRSS");
        let (mut wall, mut cpu, mut weight, mut fingerprint) = (f64::INFINITY, f64::INFINITY, 0.0, 0_u64);
        for _ in 0..self.repeats {
            let (start, cpu_start) = (Instant::now(), cpu_seconds());
            let tree = pool.install(|| minimum_spanning_tree(manifold, &points)).unwrap();
            wall = wall.min(start.elapsed().as_secs_f64());
            cpu = cpu.min(cpu_seconds() - cpu_start);
            weight = tree.edge_weights().sum();
            fingerprint = tree.raw_edges().iter().fold(0, |state, edge| {
                let ends = edge.source().index() as u64 ^ (edge.target().index() as u64) << 32;
                (state.rotate_left(5) ^ ends ^ edge.weight.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15)
            });
        }
        println!(
            "{{\"space\": \"{}\", \"n\": {}, \"threads\": {}, \"wall_s\": {wall:.5}, \"cpu_s\": {cpu:.5}, \"weight\": {weight}, \
             \"fingerprint\": \"{fingerprint:016x}\", \"peak_mib\": {:.1}}}",
            self.space,
            points.len(),
            self.threads,
            status("VmHWM") - before
        );
    }
}

/// A line of /proc/self/status in MiB; NaN where there is none.
fn status(key: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with(key));
    line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok()).map_or(f64::NAN, |kib| kib / 1024.0)
}

/// User and system time of the process, from /proc/self/schedstat of all its threads.
fn cpu_seconds() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let run = threads.filter_map(|thread| {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    run.sum::<f64>() * 1e-9
}
