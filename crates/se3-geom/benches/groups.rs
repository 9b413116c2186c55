//! Time of an exponential, a logarithm and a product of SO(3) and SE(3), over a thousand elements of all angles up to π.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use se3_geom::nalgebra::Vector3;
use se3_geom::{LieGroup, Se3Group, So3Group, Twist};

const COUNT: usize = 1000;

/// Points of an additive recurrence in the cube [−1, 1]³ (Roberts' R3): even, deterministic, without a random generator.
fn vectors(offset: f64) -> impl Iterator<Item = Vector3<f64>> {
    let steps = Vector3::new(0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_983_3);
    (0..COUNT).map(move |i| (steps * (i as f64 + offset)).map(|x| 2.0 * x.fract() - 1.0))
}

fn group_benches<G: LieGroup>(c: &mut Criterion, name: &str, algebra: &[G::Algebra]) {
    let elements: Vec<G::Element> = algebra.iter().map(|v| G::exp(*v)).collect();
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements(COUNT as u64));
    group.bench_function("exp", |b| {
        b.iter(|| {
            algebra.iter().for_each(|v| {
                black_box(G::exp(*black_box(v)));
            })
        });
    });
    group.bench_function("log", |b| {
        b.iter(|| {
            elements.iter().for_each(|a| {
                let _ = black_box(G::log(black_box(a)));
            })
        });
    });
    group.bench_function("compose", |b| {
        b.iter(|| {
            elements.windows(2).for_each(|w| {
                black_box(G::compose(black_box(&w[0]), black_box(&w[1])));
            })
        });
    });
    group.finish();
}

fn benches(c: &mut Criterion) {
    let rotations: Vec<_> = vectors(0.5)
        .enumerate()
        .map(|(i, v)| v.normalize() * (std::f64::consts::PI * i as f64 / COUNT as f64))
        .collect();
    let twists: Vec<_> = vectors(0.25).zip(&rotations).map(|(v, w)| Twist::new(v, *w)).collect();
    group_benches::<So3Group>(c, "SO(3)", &rotations);
    group_benches::<Se3Group>(c, "SE(3)", &twists);
}

criterion_group!(groups, benches);
criterion_main!(groups);
