//! Random curves in front of the arm, sampled, shuffled, some of them noisy: whatever is planned is in the true order, legal, and
//! passes every pose; everything else is a refusal. `cargo xtask soak shuffled` runs thousands, the tests a seeded sample.
#![allow(clippy::unwrap_used, missing_docs)]

use planner::manipulator::nalgebra::Vector3;
use planner::manipulator::{Robot, audit};
use planner::reorder::Topology;
use planner::se3_geom::{LieGroup, Manifold, Pose, So3, So3Group};
use planner::{Config, Refusal, Request, plan};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};

const SAMPLE: u32 = 8;

#[derive(Debug, Clone)]
struct Curve {
    /// Amplitudes of three harmonics: x, y, z in m, and a rotation vector in rad.
    harmonics: Vec<[f64; 6]>,
    closed: bool,
    poses: usize,
    /// Noise in units of the mean gap, for each pose.
    noise: f64,
    shuffle: Vec<u64>,
    jitter: Vec<[f64; 6]>,
}

fn curves() -> impl Strategy<Value = Curve> {
    let harmonic = prop::array::uniform6(-1.0..1.0_f64);
    (40..160_usize).prop_flat_map(move |poses| {
        (
            prop::collection::vec(harmonic.clone(), 3),
            any::<bool>(),
            prop_oneof![3 => Just(0.0), 1 => 0.0..0.6_f64],
            prop::collection::vec(any::<u64>(), poses),
            prop::collection::vec(prop::array::uniform6(-1.0..1.0_f64), poses),
        )
            .prop_map(move |(harmonics, closed, noise, shuffle, jitter)| Curve {
                harmonics,
                closed,
                poses,
                noise,
                shuffle,
                jitter,
            })
    })
}

impl Curve {
    fn at(&self, phase: f64) -> [f64; 6] {
        let mut value = [0.0; 6];
        for (k, amplitudes) in self.harmonics.iter().enumerate() {
            let order = (k + 1) as f64;
            for (v, a) in value.iter_mut().zip(amplitudes) {
                *v += a * (order * phase + a).sin() / (order * order);
            }
        }
        let scales = [0.08, 0.08, 0.04, 0.15, 0.15, 0.15];
        std::array::from_fn(|i| value[i] * scales[i])
    }

    /// Poses in true order, around the tool's home.
    fn sample(&self, home: &Pose) -> Vec<Pose> {
        let turn = if self.closed { std::f64::consts::TAU } else { 4.0 };
        let values: Vec<_> = (0..self.poses).map(|i| self.at(turn * i as f64 / self.poses as f64)).collect();
        let gap = |a: &[f64; 6], b: &[f64; 6]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        let mean = values.windows(2).map(|v| gap(&v[0], &v[1])).sum::<f64>() / (self.poses - 1) as f64;
        let pose = |(v, jitter): (&[f64; 6], &[f64; 6])| {
            let p =
                Vector3::new(v[0], v[1], v[2]) + Vector3::new(jitter[0], jitter[1], jitter[2]) * (self.noise * mean);
            let r = Vector3::new(v[3], v[4], v[5])
                + Vector3::new(jitter[3], jitter[4], jitter[5]) * (self.noise * mean / 0.1);
            Pose::from_parts((home.translation.vector + p).into(), home.rotation * So3Group::exp(r))
        };
        values.iter().zip(&self.jitter).map(pose).collect()
    }
}

/// Every neighbourhood of the truth is one of the recovered order, and the other way round.
fn same_curve(truth: &[usize], found: &[usize], closed: bool) -> bool {
    let pairs = |order: &[usize]| {
        let mut pairs: Vec<_> = order.windows(2).map(|p| (p[0].min(p[1]), p[0].max(p[1]))).collect();
        if closed {
            let (a, b) = (order[0], order[order.len() - 1]);
            pairs.push((a.min(b), a.max(b)));
        }
        pairs.sort_unstable();
        pairs
    };
    pairs(truth) == pairs(found)
}

#[test]
fn what_is_planned_for_the_ur5e_is_true_legal_and_exact() {
    assert_true_legal_and_exact("ur5e");
}

#[test]
fn what_is_planned_for_the_viperx_is_true_legal_and_exact() {
    assert_true_legal_and_exact("vx300s");
}

#[test]
fn what_is_planned_for_the_panda_is_true_legal_and_exact() {
    assert_true_legal_and_exact("panda");
}

fn assert_true_legal_and_exact(name: &str) {
    let cases = std::env::var("REORDER_SOAK_CASES").ok().map_or(SAMPLE, |n| n.parse().unwrap());
    let robot = Robot::shipped(name).unwrap();
    let home = robot.chain.forward(&robot.preferred);
    let start = robot.preferred.as_slice().to_vec();
    let tally = std::cell::RefCell::new(std::collections::BTreeMap::<String, usize>::new());
    let count = |what: &str| -> Result<(), TestCaseError> {
        *tally.borrow_mut().entry(what.to_owned()).or_default() += 1;
        Ok(())
    };
    let config = ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(2026),
        failure_persistence: None,
        max_shrink_iters: 0,
        ..ProptestConfig::default()
    };
    TestRunner::new(config)
        .run(&curves(), |curve| {
            let in_order = curve.sample(&home);
            let mut rows: Vec<usize> = (0..curve.poses).collect();
            rows.sort_by_key(|&i| curve.shuffle[i]);
            let mut truth = vec![0; curve.poses];
            rows.iter().enumerate().for_each(|(row, &i)| truth[i] = row);
            let poses: Vec<Pose> = rows.iter().map(|&i| in_order[i]).collect();
            let request = Request { poses: poses.clone(), start: Some(start.clone()), ..Request::default() };
            let plan = match plan(&robot, &Config::default(), &request) {
                Ok(plan) => plan,
                Err(Refusal::Verdict { .. }) => return count("refused: ambiguous"),
                Err(Refusal::Manipulator { .. }) => return count("refused: the arm cannot follow"),
                Err(other) => return Err(TestCaseError::fail(other.to_string())),
            };
            let closed = plan.ordering.topology == Topology::Closed;
            prop_assert_eq!(closed, curve.closed);
            prop_assert!(same_curve(&truth, &plan.ordering.order, closed), "a silent wrong order");
            let audit = audit(&robot, &plan.trajectory);
            prop_assert!(audit.limits_ok && audit.starts_and_ends_at_rest && audit.times_increase);
            let greatest = audit.max_ratio.velocity.max(audit.max_ratio.acceleration).max(audit.max_ratio.jerk);
            prop_assert!(greatest <= 1.0);
            for (pose, &time) in poses.iter().zip(&plan.pose_times_s) {
                let tool = robot.chain.forward(&plan.trajectory.at(time)[0]);
                prop_assert!((tool.translation.vector - pose.translation.vector).norm() < 2e-4);
                prop_assert!(So3.distance(&tool.rotation, &pose.rotation) < 2e-3);
            }
            count(if closed { "planned: closed" } else { "planned: open" })
        })
        .unwrap();
    println!("{cases} random plans for the {name}: {:?}", tally.borrow());
    let planned: usize = tally.borrow().iter().filter(|(what, _)| what.starts_with("planned")).map(|(_, n)| n).sum();
    assert!(planned > cases as usize / 4, "too few were planned to say anything: {:?}", tally.borrow());
}
