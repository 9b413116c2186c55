//! Repeatable random numbers.

use planner::manipulator::nalgebra::{DVector, Vector3};

/// SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [from, to).
    pub(crate) fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From `from` to `to` with equal chances for equal ratios.
    pub(crate) fn by_ratio(&mut self, from: f64, to: f64) -> f64 {
        self.between(from.ln(), to.ln()).exp()
    }

    pub(crate) fn coin(&mut self) -> bool {
        self.bits() & 1 == 0
    }

    pub(crate) fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(-1.0, 1.0))
    }

    /// Uniform between two configurations; unbounded joints within a turn.
    pub(crate) fn configuration(&mut self, lower: &DVector<f64>, upper: &DVector<f64>) -> DVector<f64> {
        let turn = std::f64::consts::PI;
        DVector::from_fn(lower.len(), |j, _| self.between(lower[j].max(-turn), upper[j].min(turn)))
    }
}
