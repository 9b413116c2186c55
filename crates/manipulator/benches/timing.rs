//! Figures of inverse dynamics and timing, a line each: `name value unit`.
#![allow(clippy::unwrap_used, missing_docs)]

#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;
use std::time::Instant;

use manipulator::nalgebra::{UnitQuaternion, Vector3};
use manipulator::{JointPath, PathOptions, Robot, TimingOptions, follow, time_path};
use se3_geom::{Ends, PoseSpline, Se3, centripetal_knots};
use support::{Random, random_path};

fn main() {
    inverse_dynamics();
    plans_of_200_poses();
}

fn seconds<T>(action: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = action();
    (result, start.elapsed().as_secs_f64())
}

/// Value below which the share lies.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}

fn print(name: &str, value: f64, unit: &str) {
    println!("{name:<55} {value:>10.4} {unit}");
}

fn inverse_dynamics() {
    const CALLS: usize = 200_000;
    let robot = Robot::shipped("panda").unwrap();
    let dynamics = robot.dynamics.unwrap();
    let (mut q, mut torque) = ([0.3; 7], [0.0; 7]);
    let run = |calls: usize, q: &mut [f64; 7], torque: &mut [f64; 7]| {
        for k in 0..calls {
            q[k % 7] += 1e-5;
            dynamics.torque(black_box(q), &[0.2; 7], &[0.7; 7], torque);
            black_box(&torque);
        }
    };
    run(CALLS / 10, &mut q, &mut torque);
    let ((), elapsed) = seconds(|| run(CALLS, &mut q, &mut torque));
    print("inverse dynamics, 7 joints", 1e6 * elapsed / CALLS as f64, "us");
}

/// 200 poses on a random smooth arc in front of the arm.
fn path_through_200_poses(robot: &Robot, random: &mut Random) -> Option<JointPath> {
    let home = robot.chain.forward(&robot.preferred);
    let wave = |random: &mut Random| [random.between(0.02, 0.08), random.between(0.5, 1.5), random.between(0.0, 6.0)];
    let waves: Vec<_> = (0..6).map(|_| wave(random)).collect();
    let poses: Vec<_> = (0..200)
        .map(|i| {
            let at = |k: usize| {
                let [size, periods, phase] = waves[k];
                size * (std::f64::consts::TAU * periods * f64::from(i) / 199.0 + phase).sin()
            };
            let mut pose = home;
            pose.translation.vector += Vector3::new(at(0), at(1), at(2));
            pose.rotation *= UnitQuaternion::from_scaled_axis(Vector3::new(at(3), at(4), at(5)) * 5.0);
            pose
        })
        .collect();
    let curve = PoseSpline::through(&poses, &centripetal_knots(&Se3::default(), &poses), Ends::Natural).ok()?;
    follow(robot, &curve, Some(&robot.preferred), &PathOptions::default()).ok()
}

fn plans_of_200_poses() {
    let mut random = Random(200);
    let paths: Vec<_> = Robot::shipped_names()
        .flat_map(|name| {
            let robot = Robot::shipped(name).unwrap();
            let paths: Vec<_> = (0..12).filter_map(|_| path_through_200_poses(&robot, &mut random)).collect();
            paths.into_iter().map(move |path| (robot.clone(), path)).collect::<Vec<_>>()
        })
        .collect();
    let (mut times, mut ratios) = (Vec::new(), Vec::new());
    for (robot, path) in &paths {
        let (timed, elapsed) = seconds(|| time_path(robot, path, &TimingOptions::default()).unwrap());
        times.push(1e3 * elapsed);
        ratios.push(timed.trajectory.duration_s() / timed.second_order_duration_s);
    }
    print("paths through 200 poses", paths.len() as f64, "");
    print("timing with jerk limits, 200 poses, median", quantile(&mut times, 0.5), "ms");
    print("timing with jerk limits, 200 poses, p95", quantile(&mut times, 0.95), "ms");
    print("duration over velocity/acceleration bound, median", quantile(&mut ratios, 0.5), "");
    print("duration over velocity/acceleration bound, p95", quantile(&mut ratios, 0.95), "");
    let _ = random_path;
}
