//! Time of the minimum spanning tree of ten thousand points near a closed curve, on one thread and on two.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use reorder::minimum_spanning_tree;
use se3_geom::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use se3_geom::{Manifold, Pose, R3, Se3, So3};

const COUNT: usize = 10_000;

/// Rows along the curve in a scrambled order, with even, deterministic noise of 0.01 in all six directions.
fn poses() -> Vec<Pose> {
    let steps = [0.919, 0.845, 0.777, 0.714, 0.656, 0.603, 0.554].map(|step: f64| step + 0.000_487);
    let noise = |i: usize, k: usize| 0.02 * ((i as f64 * steps[k]).fract() - 0.5);
    let vector = |i: usize, k: usize| Vector3::new(noise(i, k), noise(i, k + 1), noise(i, k + 2));
    let rows = (0..COUNT).map(|i| i * 7919 % COUNT);
    rows.map(|i| {
        let t = std::f64::consts::TAU * i as f64 / COUNT as f64;
        let position = Vector3::new(t.cos(), t.sin(), 0.4 * (3.0 * t).sin()) + vector(i, 0);
        // Three full turns, across the double cover.
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::z() * (3.0 * t) + vector(i, 3));
        Isometry3::from_parts(position.into(), rotation)
    })
    .collect()
}

fn on_threads<M: Manifold<Point: Sync> + Sync>(c: &mut Criterion, name: &str, manifold: &M, points: &[M::Point]) {
    for threads in [1, 2] {
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { return };
        c.bench_function(&format!("{name}, threads {threads}"), |b| {
            b.iter(|| pool.install(|| minimum_spanning_tree(manifold, black_box(points))));
        });
    }
}

fn spanning_trees(c: &mut Criterion) {
    let poses = poses();
    on_threads(c, "poses", &Se3::default(), &poses);
    on_threads(c, "positions", &R3::default(), &poses.iter().map(|p| p.translation.vector).collect::<Vec<_>>());
    on_threads(c, "rotations", &So3, &poses.iter().map(|p| p.rotation).collect::<Vec<_>>());
}

criterion_group!(benches, spanning_trees);
criterion_main!(benches);
