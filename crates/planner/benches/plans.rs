//! Figures of kinematics, timing and whole plans as one JSON object. The share of time in each stage goes to stderr.
#![allow(clippy::unwrap_used, missing_docs)]

#[path = "../tests/support/mod.rs"]
mod support;

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Instant;

use planner::manipulator::{IkOptions, JointLimits, JointPath, PathOptions, Robot, TimingOptions};
use planner::manipulator::{follow, least_duration_s, solve_ik, time_path, uncorrected_duration_s};
use planner::reorder::{Options, TopologyChoice, Verdict, order_poses};
use planner::se3_geom::{Ends, LieGroup, Pose, PoseSpline, Se3, So3Group, centripetal_knots};
use planner::{Config, Request, plan};
use serde_json::json;
use support::random::Random;

const POSES: usize = 200;
const SETS_AN_ARM: usize = 8;

fn main() {
    let mut random = Random::new(200);
    let robots: Vec<_> = Robot::shipped_names().map(|name| Robot::shipped(name).unwrap()).collect();
    let sets: Vec<(&Robot, Vec<Pose>)> = robots
        .iter()
        .flat_map(|robot| (0..SETS_AN_ARM).map(|_| (robot, followable(robot, &mut random))).collect::<Vec<_>>())
        .collect();
    let (mut with_jerk, mut without, mut timing, mut ratios) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut corrections, mut solving) = (Vec::new(), Vec::new());
    let mut stages = [(); 3].map(|()| Vec::new());
    for (robot, poses) in &sets {
        with_jerk.push(plan_ms(robot, poses, JointLimits::Jerk));
        without.push(plan_ms(robot, poses, JointLimits::Acceleration));
        stages[0].push(milliseconds(|| order_poses(poses, 0.1, &Options::default())).1);
        let (path, following) = milliseconds(|| followed(robot, poses).unwrap());
        stages[1].push(following);
        let (timed, timing_ms) = milliseconds(|| time_path(robot, &path, &TimingOptions::default()).unwrap());
        stages[2].push(timing_ms);
        ratios.push(timed.trajectory.duration_s() / timed.second_order_duration_s);
        corrections.push(
            timed.trajectory.duration_s() / uncorrected_duration_s(robot, &path, &TimingOptions::default()).unwrap(),
        );
        if robot.chain.dof() == 7 {
            let options =
                TimingOptions { limits: JointLimits::Acceleration, torque: false, ..TimingOptions::default() };
            timing.push(least_of(10, || milliseconds(|| time_path(robot, &path, &options).unwrap()).1));
            solving.push(least_of(10, || milliseconds(|| least_duration_s(robot, &path, &options, 1000).unwrap()).1));
        }
    }
    let [ordering, following, jerk_timing] = stages.map(|stage| quantile(stage, 0.5));
    eprintln!("medians in ms: order {ordering:.1}, follow {following:.1}, timing with jerk limits {jerk_timing:.1}");
    let figures = json!({
        "plan ms": quantile(with_jerk, 0.5),
        "plan without jerk ms": quantile(without, 0.5),
        "timing 1000 gridpoints ms": quantile(solving, 0.5),
        "audited timing ms": quantile(timing, 0.5),
        "inverse dynamics us": inverse_dynamics_us(),
        "ik us": robots.iter().map(ik_us).fold(0.0, f64::max),
        "duration ratio median": quantile(ratios.clone(), 0.5),
        "duration ratio p95": quantile(ratios, 0.95),
        "corrections ratio median": quantile(corrections.clone(), 0.5),
        "corrections ratio p95": quantile(corrections, 0.95),
    });
    println!("{figures}");
}

fn milliseconds<T>(action: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = black_box(action());
    (result, 1e3 * start.elapsed().as_secs_f64())
}

/// What other processes take of the machine only ever adds.
fn least_of(runs: usize, mut cost: impl FnMut() -> f64) -> f64 {
    (0..runs).map(|_| cost()).fold(f64::INFINITY, f64::min)
}

/// Value below which the share lies.
fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}

fn plan_ms(robot: &Robot, poses: &[Pose], limits: JointLimits) -> f64 {
    // The order is given and the topology told: what is measured is a plan, not the doubts about a curve that crosses itself.
    let timing = TimingOptions { limits, ..TimingOptions::default() };
    let (topology, minimum_verdict) = (TopologyChoice::Open, Verdict::Ambiguous);
    let config = Config { topology, minimum_verdict, timing, ..Config::default() };
    let request = Request { poses: poses.to_vec(), ..Request::default() };
    milliseconds(|| plan(robot, &config, &request).unwrap()).1
}

fn spline(poses: &[Pose]) -> PoseSpline {
    PoseSpline::through(poses, &centripetal_knots(&Se3::default(), poses), Ends::Natural).unwrap()
}

fn followed(robot: &Robot, poses: &[Pose]) -> Option<JointPath> {
    follow(robot, &spline(poses), None, &PathOptions::default()).ok()
}

/// A random arc in front of the arm that it can follow.
fn followable(robot: &Robot, random: &mut Random) -> Vec<Pose> {
    std::iter::repeat_with(|| arc(robot, random)).find(|poses| followed(robot, poses).is_some()).unwrap()
}

fn arc(robot: &Robot, random: &mut Random) -> Vec<Pose> {
    let home = robot.chain.forward(&robot.preferred);
    let sizes = [random.vector() * 0.1, random.vector() * 0.1, random.vector() * 0.3, random.vector() * 0.3];
    let span = random.between(2.0, 5.0);
    (0..POSES)
        .map(|i| {
            let (sin, cos) = (span * i as f64 / (POSES - 1) as f64).sin_cos();
            let offset = sizes[0] * sin + sizes[1] * (cos - 1.0);
            let turn = So3Group::exp(sizes[2] * sin + sizes[3] * (cos - 1.0));
            Pose::from_parts((home.translation.vector + offset).into(), home.rotation * turn)
        })
        .collect()
}

fn ik_us(robot: &Robot) -> f64 {
    const CALLS: usize = 1000;
    let angle = |i: usize| TAU * i as f64 / CALLS as f64;
    let near = |i: usize| robot.preferred.map(|q| q + 0.2 * angle(i).sin());
    let poses: Vec<_> = (0..CALLS).map(|i| robot.chain.forward(&near(i))).collect();
    let options = IkOptions::default();
    let run = || {
        let mut q = robot.preferred.clone();
        for pose in &poses {
            q = solve_ik(robot, black_box(pose), &q, &options).unwrap();
        }
        q
    };
    least_of(20, || 1e3 * milliseconds(run).1 / CALLS as f64)
}

fn inverse_dynamics_us() -> f64 {
    const CALLS: usize = 100_000;
    let robot = Robot::shipped("panda").unwrap();
    let dynamics = robot.dynamics.unwrap();
    let (mut q, mut torque) = ([0.3; 7], [0.0; 7]);
    let mut run = || {
        for k in 0..CALLS {
            q[k % 7] += 1e-5;
            dynamics.torque(black_box(&q), &[0.2; 7], &[0.7; 7], &mut torque);
            black_box(&torque);
        }
    };
    least_of(5, || 1e3 * milliseconds(&mut run).1 / CALLS as f64)
}
