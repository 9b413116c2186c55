//! Durations beside those of toppra: same paths, same gridpoints, same limits.
#![allow(clippy::unwrap_used, missing_docs)]

use std::f64::consts::TAU;

use end_to_end::python;
use planner::manipulator::nalgebra::DVector;
use planner::manipulator::{EndDerivatives, JointLimits, JointPath, Robot, TimedPath, TimingOptions, time_path};
use serde_json::{Value, json};

const PATHS_AN_ARM: u64 = 8;
const SAMPLES: u32 = 60;
/// As many as the second-order pass of `time_path` has for paths of this many samples.
const GRIDPOINTS: u32 = 1000;

/// SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
struct Random(u64);

impl Random {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        from + (to - from) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Every joint a sum of two sines of up to one period and a half about the middle of its range, within 0.8 of it.
fn random_path(robot: &Robot, random: &mut Random) -> JointPath {
    let limits = &robot.limits;
    let sines: Vec<[[f64; 3]; 2]> = (0..robot.chain.dof())
        .map(|joint| {
            let half = (0.5 * (limits.upper[joint] - limits.lower[joint])).min(TAU / 2.0);
            [(); 2]
                .map(|()| [0.4 * half * random.between(0.2, 1.0), random.between(0.3, 1.5), random.between(0.0, TAU)])
        })
        .collect();
    let derivative = |s: f64, order: i32| {
        DVector::from_fn(sines.len(), |joint, _| {
            let middle = if order == 0 { 0.5 * (limits.upper[joint] + limits.lower[joint]) } else { 0.0 };
            let sine = |[amplitude, periods, phase]: &[f64; 3]| {
                let rate = TAU * periods;
                amplitude * rate.powi(order) * (rate * s + phase + f64::from(order) * TAU / 4.0).sin()
            };
            middle + sines[joint].iter().map(sine).sum::<f64>()
        })
    };
    let parameters: Vec<f64> = (0..SAMPLES).map(|i| f64::from(i) / f64::from(SAMPLES - 1)).collect();
    let configurations: Vec<_> = parameters.iter().map(|&s| derivative(s, 0)).collect();
    let ends = [0.0, 1.0].map(|s| EndDerivatives { first: derivative(s, 1), second: derivative(s, 2) });
    JointPath::through(&parameters, &configurations, [&ends[0], &ends[1]]).unwrap()
}

fn for_toppra(robot: &Robot, path: &JointPath) -> Value {
    let gridpoints: Vec<f64> = (0..=GRIDPOINTS).map(|k| f64::from(k) / f64::from(GRIDPOINTS)).collect();
    let table =
        |order: usize| -> Vec<Vec<f64>> { gridpoints.iter().map(|&s| path.at(s)[order].as_slice().to_vec()).collect() };
    json!({
        "q": table(0), "dq": table(1), "ddq": table(2), "gridpoints": gridpoints,
        "velocity": robot.limits.velocity.as_slice(), "acceleration": robot.limits.acceleration.as_slice(),
    })
}

/// The paths of all arms, and the least duration of each by toppra.
fn paths_and_durations() -> Vec<(Robot, JointPath, f64)> {
    let mut random = Random(5);
    let robots: Vec<_> = Robot::shipped_names().map(|name| Robot::shipped(name).unwrap()).collect();
    assert!([6, 7].iter().all(|dof| robots.iter().any(|robot| robot.chain.dof() == *dof)));
    let paths: Vec<_> = robots
        .iter()
        .flat_map(|robot| {
            (0..PATHS_AN_ARM).map(|_| (robot.clone(), random_path(robot, &mut random))).collect::<Vec<_>>()
        })
        .collect();
    let given: Vec<_> = paths.iter().map(|(robot, path)| for_toppra(robot, path)).collect();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("paths.json");
    std::fs::write(&file, json!({ "paths": given }).to_string()).unwrap();
    let output = python(&["tests/peers/toppra_durations.py", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let durations: Vec<f64> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(durations.len(), paths.len());
    paths.into_iter().zip(durations).map(|((robot, path), duration)| (robot, path, duration)).collect()
}

fn timed(robot: &Robot, path: &JointPath, limits: JointLimits) -> TimedPath {
    let timed = time_path(robot, path, &TimingOptions { limits, torque: false, ..TimingOptions::default() }).unwrap();
    assert!(timed.audit.limits_ok, "{:?}", timed.audit);
    timed
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn paths_take_as_long_as_toppra_says() {
    let compared = paths_and_durations();
    let (mut bounds, mut without_jerk, mut with_jerk) = (Vec::new(), Vec::new(), Vec::new());
    for (robot, path, least) in &compared {
        let second_order = timed(robot, path, JointLimits::Acceleration);
        bounds.push(second_order.second_order_duration_s / least);
        without_jerk.push(second_order.trajectory.duration_s() / least);
        with_jerk.push(timed(robot, path, JointLimits::Jerk).trajectory.duration_s() / least);
    }
    let [bounds, without_jerk, with_jerk] = [bounds, without_jerk, with_jerk].map(sorted);
    let figures = format!("bounds {bounds:.4?}\nwithout jerk limits {without_jerk:.4?}\nwith {with_jerk:.4?}");
    println!("{figures}");
    let within = |ratio: &f64| (0.98..=1.02).contains(ratio);
    assert!(bounds.iter().all(within), "{figures}");
    assert!(without_jerk.iter().all(within), "{figures}");
    let last = with_jerk.len() - 1;
    let quantile = |share: f64| with_jerk[(share * last as f64).round() as usize];
    // Nothing that keeps more limits is faster.
    assert!(with_jerk[0] >= 0.98 && quantile(0.5) <= 1.2 && quantile(0.95) <= 2.0, "{figures}");
}
