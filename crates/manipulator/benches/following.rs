//! Prints the figures of following curves, one a line: the time that inverse kinematics takes a pose, and how many of a fixed set of
//! random curves each arm follows, how long that takes and how near to singularities and limits it leads.
#![allow(missing_docs, clippy::unwrap_used)]

#[path = "../tests/support/mod.rs"]
mod support;

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Instant;

use manipulator::{IkOptions, JointPath, PathOptions, Robot, follow, solve_ik};
use support::Random;
use support::curves::{random_curve, scaled_writing, spline};

const POSES: usize = 1000;

/// The least of several runs: what other processes take of the machine only ever adds.
fn ik_us_per_pose(robot: &Robot) -> f64 {
    let curve = spline(&scaled_writing(robot, 40, 0.5));
    let last = curve.domain().1;
    let poses: Vec<_> = (0..POSES).map(|i| curve.pose(last * i as f64 / (POSES - 1) as f64)).collect();
    let options = IkOptions::default();
    let run = || {
        let start = Instant::now();
        let mut q = robot.preferred.clone();
        for pose in &poses {
            q = solve_ik(robot, black_box(pose), &q, &options).unwrap();
        }
        black_box(q);
        start.elapsed().as_secs_f64() * 1e6 / POSES as f64
    };
    (0..30).map(|_| run()).fold(f64::INFINITY, f64::min)
}

/// Least singular value, least margin to a position limit, travel at the velocity limits in s, and the greatest second derivative
/// times the path's squared length in the parameter.
fn figures(robot: &Robot, path: &JointPath) -> [f64; 4] {
    let (first, last) = path.domain();
    let mut figures = [f64::INFINITY, f64::INFINITY, 0.0, 0.0];
    let mut before = path.at(first)[0].clone();
    for i in 0..=500 {
        let [q, _, second, _] = path.at(first + (last - first) * f64::from(i) / 500.0);
        let singular = robot.chain.body_jacobian(&q).singular_values().min();
        let margin = (&q - &robot.limits.lower).min().min((&robot.limits.upper - &q).min());
        figures[0] = figures[0].min(singular);
        figures[1] = figures[1].min(margin);
        figures[2] += (&q - &before).component_div(&robot.limits.velocity).amax();
        figures[3] = figures[3].max(second.amax() * (last - first).powi(2));
        before = q;
    }
    figures
}

fn main() {
    let curves: u64 = std::env::var("CURVES").ok().and_then(|n| n.parse().ok()).unwrap_or(200);
    let only = std::env::var("ROBOT").ok();
    for name in Robot::shipped_names() {
        let robot = Robot::shipped(name).unwrap();
        println!("ik_us_per_pose {name} {:.2}", ik_us_per_pose(&robot));
    }
    for name in Robot::shipped_names().filter(|name| only.as_ref().is_none_or(|only| only == name)) {
        let robot = Robot::shipped(name).unwrap();
        let mut worst = Vec::new();
        let mut open = 0;
        let (mut followed, mut times_ms) = (0, Vec::new());
        let mut reasons = std::collections::BTreeMap::<String, usize>::new();
        for seed in 0..curves {
            let curve = random_curve(&robot, &mut Random(seed));
            let start = Instant::now();
            let result = follow(&robot, &curve, None, &PathOptions::default());
            times_ms.push(start.elapsed().as_secs_f64() * 1e3);
            match result {
                Ok(path) => {
                    followed += 1;
                    worst.push(figures(&robot, &path));
                    let [first, last] = [path.domain().0, path.domain().1].map(|s| path.at(s)[0].clone());
                    let turns = (last - first).map(|way| way - TAU * (way / TAU).round());
                    open += usize::from(curve.is_closed() && turns.amax() > 1e-6);
                }
                Err(error) => {
                    let text = format!("{error:?}");
                    *reasons.entry(text.split([' ', '{']).next().unwrap().to_owned()).or_default() += 1;
                }
            }
        }
        for (k, what) in
            ["least singular value", "least limit margin", "joint travel s", "greatest bend"].iter().enumerate()
        {
            let mut values: Vec<f64> = worst.iter().map(|w| w[k]).collect();
            values.sort_by(f64::total_cmp);
            let at = |part: f64| values[((values.len() - 1) as f64 * part) as usize];
            println!(
                "follow {name} {what}: least {:.4} p10 {:.4} median {:.4} p90 {:.4} max {:.4}",
                at(0.0),
                at(0.1),
                at(0.5),
                at(0.9),
                at(1.0)
            );
        }
        println!("follow {name} closed curves left open in the joints: {open}");
        times_ms.sort_by(f64::total_cmp);
        let at = |part: f64| times_ms[((times_ms.len() - 1) as f64 * part) as usize];
        println!(
            "follow {name} followed {followed} of {curves} ms median {:.2} p95 {:.2} max {:.2} {reasons:?}",
            at(0.5),
            at(0.95),
            at(1.0)
        );
    }
}
