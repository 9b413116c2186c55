//! Prints the seconds that one call takes, as JSON: the figures of `cargo xtask bench geometry`.
//!
//! The least of many stretches of about a millisecond: what other processes take of the machine only ever adds. The criterion
//! benches beside this one are for the comparison of two versions.
#![allow(missing_docs)]

use std::cell::RefCell;
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

use se3_geom::nalgebra::Vector3;
use se3_geom::{Ends, LieGroup, Motion, Pose, PoseSpline, Se3Group, So3Group, Twist};
use serde_json::json;

const COUNT: usize = 1000;
const KNOTS_A_LOOP: f64 = 25.0;
const POINTS: usize = 1_000_000;
const STRETCH: usize = 10_000;

fn seconds<T>(work: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    let result = work();
    let elapsed = start.elapsed().as_secs_f64();
    // What the result costs to drop is not the work.
    drop(black_box(result));
    elapsed
}

fn least_seconds<T>(repeats: usize, work: impl Fn() -> T) -> f64 {
    (0..repeats).map(|_| seconds(&work)).fold(f64::INFINITY, f64::min)
}

fn each<A, B>(inputs: &[A], f: impl Fn(&A) -> B) -> f64 {
    let passes = 50;
    let stretch = || {
        for _ in 0..passes {
            for input in inputs {
                black_box(f(black_box(input)));
            }
        }
    };
    least_seconds(100, stretch) / (passes * inputs.len()) as f64
}

/// Points of an additive recurrence in the cube [−1, 1]³ (Roberts' R3): even, deterministic, without a random generator.
fn even_points(offset: f64) -> impl Iterator<Item = Vector3<f64>> {
    let steps = Vector3::new(0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_983_3);
    (0..COUNT).map(move |i| (steps * (i as f64 + offset)).map(|x| 2.0 * x.fract() - 1.0))
}

/// Loops with turns of up to about 40° between knots.
fn curve(knots: usize) -> (Vec<Pose>, Vec<f64>) {
    let parameters: Vec<f64> = (0..knots).map(|k| k as f64 * 2.0 * PI / KNOTS_A_LOOP).collect();
    let pose = |t: &f64| {
        let turn = Vector3::new(0.8 * t.sin(), 0.6 * (2.0 * t).cos(), t.sin() + 0.3 * (3.0 * t).cos());
        Pose::from_parts(Vector3::new(t.cos(), t.sin(), 0.4 * (3.0 * t).sin()).into(), So3Group::exp(turn))
    };
    (parameters.iter().map(pose).collect(), parameters)
}

/// Uniform on [0, 1): the splitmix64 generator.
fn random(k: usize) -> f64 {
    let mut z = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

fn evaluation(parameters: &[f64], evaluate: impl Fn(&[f64])) -> f64 {
    let stretches = parameters.chunks(STRETCH).map(|stretch| seconds(|| evaluate(stretch)));
    stretches.fold(f64::INFINITY, f64::min) / STRETCH as f64
}

fn look_at(motion: Motion) {
    // By reference: a copy of 200 bytes is not part of an evaluation.
    black_box(&motion);
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rotation_vectors: Vec<_> =
        even_points(0.5).enumerate().map(|(i, v)| v.normalize() * (PI * i as f64 / COUNT as f64)).collect();
    let twists: Vec<_> = even_points(0.25).zip(&rotation_vectors).map(|(v, w)| Twist::new(v, *w)).collect();
    let rotations: Vec<_> = rotation_vectors.iter().map(|v| So3Group::exp(*v)).collect();
    let poses: Vec<_> = twists.iter().map(|v| Se3Group::exp(*v)).collect();

    let (through, knots) = curve(1_000);
    let spline = PoseSpline::through(&through, &knots, Ends::Natural)?;
    let (_, last) = spline.domain();
    let sorted: Vec<f64> = (0..POINTS).map(|k| k as f64 * (last / POINTS as f64)).collect();
    let unsorted: Vec<f64> = (0..POINTS).map(|k| random(k) * last).collect();

    let used = RefCell::new(spline.sample(&sorted));
    let sample_again = || {
        let mut motions = used.borrow_mut();
        motions.clear();
        motions.extend(spline.along(sorted.iter().copied()));
    };

    let (many, many_knots) = curve(10_000);
    let costs = json!({
        "SO(3) exp": each(&rotation_vectors, |v| So3Group::exp(*v)),
        "SO(3) log": each(&rotations, So3Group::log),
        "SE(3) exp": each(&twists, |v| Se3Group::exp(*v)),
        "SE(3) log": each(&poses, Se3Group::log),
        "sorted": evaluation(&sorted, |stretch| spline.along(stretch.iter().copied()).for_each(look_at)),
        "random": evaluation(&unsorted, |stretch| stretch.iter().for_each(|t| look_at(spline.at(*t)))),
        "batch": least_seconds(5, || spline.sample(&sorted)),
        "batch again": least_seconds(5, sample_again),
        "fit": least_seconds(30, || PoseSpline::through(&many, &many_knots, Ends::Natural)),
    });
    println!("{costs}");
    Ok(())
}
