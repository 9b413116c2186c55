//! How evenly the control steps come.

/// Times between control steps, in s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StepTimes {
    count: u64,
    mean: f64,
    /// Sum of squared differences from the mean (Welford's algorithm).
    squares: f64,
    longest: f64,
}

impl StepTimes {
    pub(crate) fn note(&mut self, interval_s: f64) {
        self.count += 1;
        let before = interval_s - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (interval_s - self.mean);
        self.longest = self.longest.max(interval_s);
    }

    /// How many there were.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Steps a second, on average.
    pub fn rate_hz(&self) -> f64 {
        if self.mean > 0.0 { 1.0 / self.mean } else { 0.0 }
    }

    /// Standard deviation.
    pub fn jitter_rms_s(&self) -> f64 {
        if self.count > 1 { (self.squares / self.count as f64).sqrt() } else { 0.0 }
    }

    /// The longest.
    pub fn longest_s(&self) -> f64 {
        self.longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_a_few_steps() {
        let mut times = StepTimes::default();
        [0.004, 0.006, 0.004, 0.006].into_iter().for_each(|interval| times.note(interval));
        assert!((times.rate_hz() - 200.0).abs() < 1e-9 && (times.jitter_rms_s() - 0.001).abs() < 1e-12);
        assert_eq!((times.count(), times.longest_s()), (4, 0.006));
    }
}
