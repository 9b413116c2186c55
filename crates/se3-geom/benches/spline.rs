//! What a `PoseSpline` costs: fit of 10 000 knots, evaluation in order and in random order, and a million points at once.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use se3_geom::nalgebra::Vector3;
use se3_geom::{Ends, LieGroup, Pose, PoseSpline, So3Group};

const KNOTS: usize = 10_000;

/// The fractional part of k times the golden ratio's inverse powers: even, seedless, in no order.
fn scattered(k: usize) -> f64 {
    (k as f64 * 0.618_033_988_749_894_9).fract()
}

/// A walk with turns of up to 60° between poses.
fn walk() -> (Vec<Pose>, Vec<f64>) {
    let mut now = Pose::identity();
    let mut poses = Vec::with_capacity(KNOTS);
    for k in 0..KNOTS {
        poses.push(now);
        let unit = |j: usize| 2.0 * scattered(7 * k + j) - 1.0;
        let turn = Vector3::new(unit(1), unit(2), unit(3)) * 0.6;
        let step = Vector3::new(unit(4), unit(5), unit(6)) * 0.1;
        now = Pose::from_parts((now.translation.vector + step).into(), now.rotation * So3Group::exp(turn));
    }
    let knots = (0..KNOTS).map(|k| k as f64 + 0.4 * scattered(k)).collect();
    (poses, knots)
}

fn spline(c: &mut Criterion) {
    let (poses, knots) = walk();
    c.bench_function("fit 1e4 knots", |b| {
        b.iter_with_large_drop(|| PoseSpline::through(black_box(&poses), &knots, Ends::Natural).expect("a spline"));
    });
    let curve = PoseSpline::through(&poses, &knots, Ends::Natural).expect("a spline");
    let (first, last) = curve.domain();
    let sorted: Vec<_> = (0..1_000_000).map(|k| first + (last - first) * k as f64 / 1e6).collect();
    let random: Vec<_> = (0..1_000_000).map(|k| first + (last - first) * scattered(k)).collect();
    for (name, parameters) in [("evaluate sorted", &sorted), ("evaluate random", &random)] {
        let mut next = parameters.iter().cycle();
        c.bench_function(name, |b| b.iter(|| curve.at(next.next().copied().unwrap_or(0.0))));
    }
    let mut million = c.benchmark_group("a million sorted points");
    million.sample_size(10);
    million.bench_function("sample into a vector", |b| b.iter_with_large_drop(|| curve.sample(black_box(&sorted))));
    million.bench_function("run along", |b| {
        b.iter(|| curve.along(black_box(&sorted).iter().copied()).for_each(|motion| _ = black_box(&motion)));
    });
}

criterion_group!(benches, spline);
criterion_main!(benches);
