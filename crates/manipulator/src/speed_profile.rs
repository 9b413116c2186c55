//! How far along the path the robot is at each time.

use crate::quintic::Quintic;

/// s(t) from rest to rest, as quintics between given states.
#[derive(Debug, Clone)]
pub(crate) struct SpeedProfile {
    times: Vec<f64>,
    pieces: Vec<Quintic>,
    ends: [f64; 2],
}

impl SpeedProfile {
    /// Through states (s, ṡ, s̈) at increasing times from 0.
    pub(crate) fn through(times: Vec<f64>, states: &[[f64; 3]]) -> Self {
        let pieces = times
            .windows(2)
            .zip(states.windows(2))
            .map(|(t, state)| Quintic::hermite(t[1] - t[0], state[0], state[1]))
            .collect();
        Self { times, pieces, ends: [states[0][0], states[states.len() - 1][0]] }
    }

    /// Through positions with given speeds at increasing times from 0, the acceleration constant between them.
    pub(crate) fn of_constant_accelerations(times: Vec<f64>, positions: &[f64], speeds: &[f64]) -> Self {
        let pieces = (0..times.len() - 1)
            .map(|k| {
                let h = times[k + 1] - times[k];
                let acceleration = (speeds[k + 1] - speeds[k]) / h;
                let state = |i: usize| [positions[i], speeds[i], acceleration];
                Quintic::hermite(h, state(k), state(k + 1))
            })
            .collect();
        Self { ends: [positions[0], positions[positions.len() - 1]], times, pieces }
    }

    pub(crate) fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// s, ṡ and s̈; at rest outside the duration.
    fn at(&self, t: f64) -> [f64; 3] {
        if t <= 0.0 {
            return [self.ends[0], 0.0, 0.0];
        }
        if t >= self.duration() {
            return [self.ends[1], 0.0, 0.0];
        }
        let piece = self.piece(t);
        let [s, v, a, _] = self.pieces[piece].at(t - self.times[piece]);
        [s, v, a]
    }

    fn piece(&self, t: f64) -> usize {
        self.times.partition_point(|&k| k <= t).clamp(1, self.times.len() - 1) - 1
    }

    /// ∫(s − reference) dt from `from` to `to`, which may lie outside the duration.
    fn integral(&self, reference: f64, from: f64, to: f64) -> f64 {
        let duration = self.duration();
        let before = (to.min(0.0) - from.min(0.0)) * (self.ends[0] - reference);
        let after = (to.max(duration) - from.max(duration)) * (self.ends[1] - reference);
        let (from, to) = (from.clamp(0.0, duration), to.clamp(0.0, duration));
        let (first, last) = (self.piece(from), self.piece(to));
        let inside: f64 = (first..=last)
            .map(|k| {
                let start = self.times[k];
                let piece = &self.pieces[k];
                let until = to.min(self.times[k + 1]) - start;
                let since = (from - start).max(0.0);
                piece.integral_from(reference, until) - piece.integral_from(reference, since)
            })
            .sum();
        before + inside + after
    }
}

/// A profile averaged over a sliding window, which turns the jumps of its jerk into ramps.
///
/// ŝ(t) = (1/w)∫ s from t − w to t, over a duration longer by w. Speed, acceleration and jerk of ŝ are averages of those of s, so
/// none of them grows. The quintic between points that are sampled from a profile with jumping jerk overshoots the jerk; between
/// points sampled from ŝ it hardly does.
#[derive(Debug, Clone)]
pub(crate) struct Smoothed {
    profile: SpeedProfile,
    window: f64,
}

impl Smoothed {
    pub(crate) fn new(profile: SpeedProfile, window: f64) -> Self {
        Self { profile, window }
    }

    pub(crate) fn duration(&self) -> f64 {
        self.profile.duration() + self.window
    }

    /// ŝ and its first two derivatives.
    pub(crate) fn at(&self, t: f64) -> [f64; 3] {
        let now = self.profile.at(t);
        if self.window == 0.0 {
            return now;
        }
        let earlier = self.profile.at(t - self.window);
        let mean = now[0] + self.profile.integral(now[0], t - self.window, t) / self.window;
        [mean, (now[0] - earlier[0]) / self.window, (now[1] - earlier[1]) / self.window]
    }

    /// The time at which ŝ passes `s`.
    pub(crate) fn time_at(&self, s: f64) -> f64 {
        if s <= self.profile.ends[0] {
            return 0.0;
        }
        if s >= self.profile.ends[1] {
            return self.duration();
        }
        // An average is late by at most its window.
        let piece = self.profile.pieces.partition_point(|piece| piece.at(0.0)[0] <= s).max(1) - 1;
        let (mut before, mut after) = (self.profile.times[piece], self.profile.times[piece + 1] + self.window);
        let mut time = 0.5 * (before + after);
        for _ in 0..60 {
            let [position, speed, _] = self.at(time);
            if position < s {
                before = time
            } else {
                after = time
            }
            // Newton's step, unless it leaves the bracket or the profile stands still.
            let next = time + (s - position) / speed;
            let next = if next > before && next < after { next } else { 0.5 * (before + after) };
            if (next - time).abs() <= 1e-12 * self.duration() {
                return next;
            }
            time = next;
        }
        time
    }
}
