//! Seeded randomness and curves with known order.
#![allow(dead_code, reason = "every test binary uses its own part of it")]

pub(crate) mod harmonics;
pub(crate) mod permutations;
pub(crate) mod plane;
pub(crate) mod trials;

use se3_geom::Pose;
use se3_geom::nalgebra::{Isometry3, UnitQuaternion, Vector3};

/// SplitMix64 (Steele, Lea, Flood 2014): small, seeded, the same everywhere.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn seeded(seed: u64) -> Self {
        Self(seed)
    }
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// Uniform in [-1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    /// Standard normal, by Box and Muller.
    pub(crate) fn gauss(&mut self) -> f64 {
        let [u, v] = [0.5 * (self.signed() + 1.0), 0.5 * (self.signed() + 1.0)];
        (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
    pub(crate) fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.signed(), self.signed(), self.signed())
    }
    pub(crate) fn rotation(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.vector() * 3.0)
    }
    pub(crate) fn pose(&mut self) -> Pose {
        Isometry3::from_parts(self.vector().into(), self.rotation())
    }
    pub(crate) fn permutation(&mut self, n: usize) -> Vec<usize> {
        let mut rows: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            rows.swap(i, self.below(i + 1));
        }
        rows
    }
}

/// Row k of the result is `points[rows[k]]`.
pub(crate) fn shuffled<T: Clone>(points: &[T], rows: &[usize]) -> Vec<T> {
    rows.iter().map(|&row| points[row].clone()).collect()
}

/// A recovered order in the numbering before `shuffled`.
pub(crate) fn unshuffled(order: &[usize], rows: &[usize]) -> Vec<usize> {
    order.iter().map(|&k| rows[k]).collect()
}

/// Consecutive pairs, closing pair included if `closed`, each as (smaller, greater), ascending.
pub(crate) fn neighbours(order: &[usize], closed: bool) -> Vec<(usize, usize)> {
    let closing = closed.then(|| (order[order.len() - 1], order[0]));
    let mut pairs: Vec<_> =
        order.windows(2).map(|w| (w[0], w[1])).chain(closing).map(|(a, b)| (a.min(b), a.max(b))).collect();
    pairs.sort_unstable();
    pairs
}

/// A tool on a helix of radius 0.3 m that turns about its own axis too.
pub(crate) fn helix_pose(t: f64) -> Pose {
    let position = Vector3::new(0.3 * t.cos(), 0.3 * t.sin(), 0.05 * t);
    Isometry3::from_parts(position.into(), UnitQuaternion::from_scaled_axis(Vector3::new(0.2 * t.sin(), 0.0, 0.4 * t)))
}

/// A loop in SE(3) whose rotation makes `turns` full turns about z on the way.
pub(crate) fn loop_pose(t: f64, turns: f64) -> Pose {
    let position = Vector3::new(t.cos(), 1.3 * t.sin(), 0.4 * (2.0 * t).cos());
    Isometry3::from_parts(position.into(), UnitQuaternion::from_scaled_axis(Vector3::z() * (turns * t)))
}
