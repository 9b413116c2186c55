//! The path run through at a constant speed of the tool.

use crate::audit::{Audit, Found, against};
use crate::bounds::Bounds;
use crate::joint_path::JointPath;
use crate::sampling::{Sampling, sample};
use crate::speed_profile::{Smoothed, SpeedProfile};
use crate::trajectory::JointTrajectory;

/// Parts of the interval between two knots over which the tool's way is tabulated.
const PARTS: usize = 8;
/// States of the profile in each published period.
const STATES: f64 = 4.0;
/// Part of the wanted speed that is left for what quintics add between points, where the same speed is also the limit.
const LEFT: f64 = 1e-3;
/// The shortest ramp in published periods, and by how much each further one is longer.
const RAMPS: (f64, f64) = (4.0, 1.25);
/// Part of the way that both ramps together may take.
const MOST_RAMPS: f64 = 0.8;
/// Abscissae in [0, 1] and weights of Gauss's rule of degree 5.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// With the tool's way ℓ and σ = dℓ/ds = ‖p′‖, a profile ℓ(t) gives ṡ = ℓ̇/σ and s̈ = (ℓ̈ − σ′ṡ²)/σ. Between ramps ℓ̇ is the wanted speed exactly,
/// however unevenly the tool moves along the path's own parameter, which gridpoints with a law of their own between them do not resolve.
///
/// The ramps are ℓ̇ = v(10τ³ − 15τ⁴ + 6τ⁵), as short as keeps every limit; `None` where there are none, or where the tool turns on the spot.
pub(crate) fn at_constant_speed(
    path: &JointPath,
    bounds: &Bounds<'_>,
    sampling: &Sampling<'_>,
    wanted: f64,
) -> Option<(Smoothed, JointTrajectory, Audit)> {
    let way = Way::along(path, bounds)?;
    let (length, speed) = (way.length(), (1.0 - LEFT) * wanted);
    let mut ramp = RAMPS.0 / sampling.rate_hz;
    while speed * ramp < MOST_RAMPS * length {
        // A whole number of periods, so that sampling does not stretch it.
        let duration = ((length / speed + ramp) * sampling.rate_hz).ceil() / sampling.rate_hz;
        let profile = Smoothed::new(way.profile(speed, duration, STATES * sampling.rate_hz)?, 0.0);
        let trajectory = sample(path, &profile, duration, sampling).ok()?;
        let Found { audit, .. } = against(bounds, &trajectory);
        if audit.limits_ok {
            return Some((profile, trajectory, audit));
        }
        ramp *= RAMPS.1;
    }
    None
}

/// The tool's way along a path.
struct Way<'a> {
    path: &'a JointPath,
    bounds: &'a Bounds<'a>,
    parameters: Vec<f64>,
    /// Way up to each parameter, in m.
    ways: Vec<f64>,
}

impl<'a> Way<'a> {
    fn along(path: &'a JointPath, bounds: &'a Bounds<'a>) -> Option<Self> {
        let parts = |pair: &[f64]| {
            let (from, to) = (pair[0], pair[1]);
            (0..PARTS).map(move |k| from + (to - from) * k as f64 / PARTS as f64)
        };
        let parameters: Vec<f64> = path.knots().windows(2).flat_map(parts).chain([path.domain().1]).collect();
        let mut way = Self { path, bounds, parameters, ways: vec![0.0] };
        for k in 1..way.parameters.len() {
            let step = way.between(way.parameters[k - 1], way.parameters[k]);
            way.ways.push(way.ways[k - 1] + step);
        }
        let mean = way.length() / (path.domain().1 - path.domain().0);
        // A tool that hardly moves for a while would have the joints race.
        let moves = way.parameters.iter().all(|&s| way.rate(s).0 > 1e-6 * mean);
        moves.then_some(way)
    }

    fn length(&self) -> f64 {
        self.ways[self.ways.len() - 1]
    }

    /// σ and σ′.
    fn rate(&self, s: f64) -> (f64, f64) {
        let [q, first, second, _] = self.path.at(s);
        let (velocity, acceleration) = self.bounds.chain.tool_motion(&q, &first, &second);
        let sigma = velocity.norm();
        (sigma, velocity.dot(&acceleration) / sigma)
    }

    fn between(&self, from: f64, to: f64) -> f64 {
        (to - from) * GAUSS.iter().map(|(x, weight)| weight * self.rate(from + x * (to - from)).0).sum::<f64>()
    }

    /// The parameter at which so much of the way is behind the tool.
    fn parameter_at(&self, way: f64) -> f64 {
        let k = self.ways.partition_point(|&w| w <= way).clamp(1, self.ways.len() - 1);
        let (from, to) = (self.parameters[k - 1], self.parameters[k]);
        let left = way - self.ways[k - 1];
        let mut s = from + (to - from) * left / (self.ways[k] - self.ways[k - 1]);
        // Newton's steps: σ hardly changes over an eighth of an interval.
        for _ in 0..3 {
            s = (s + (left - self.between(from, s)) / self.rate(s).0).clamp(from, to);
        }
        s
    }

    /// s(t) of the whole way in that duration, at that speed between two ramps.
    fn profile(&self, speed: f64, duration: f64, states_hz: f64) -> Option<SpeedProfile> {
        let (length, (first, last)) = (self.length(), self.path.domain());
        let ramp = duration - length / speed;
        let ramped = |t: f64| {
            let tau = t / ramp;
            let way = speed * ramp * tau.powi(4) * (2.5 - 3.0 * tau + tau * tau);
            let rate = speed * tau.powi(3) * (10.0 - 15.0 * tau + 6.0 * tau * tau);
            [way, rate, speed / ramp * 30.0 * tau * tau * (1.0 - tau) * (1.0 - tau)]
        };
        let steps = (duration * states_hz).round() as usize;
        let times: Vec<f64> = (0..=steps).map(|k| duration * k as f64 / steps as f64).collect();
        let mut states: Vec<[f64; 3]> = times
            .iter()
            .map(|&t| {
                let [way, rate, change] = if t < ramp {
                    ramped(t)
                } else if t > duration - ramp {
                    let [way, rate, change] = ramped(duration - t);
                    [length - way, rate, -change]
                } else {
                    [speed * (t - 0.5 * ramp), speed, 0.0]
                };
                let s = self.parameter_at(way);
                let (sigma, slope) = self.rate(s);
                let along = rate / sigma;
                [s, along, (change - slope * along * along) / sigma]
            })
            .collect();
        (states[0], states[steps]) = ([first, 0.0, 0.0], [last, 0.0, 0.0]);
        states.iter().flatten().all(|x| x.is_finite()).then(|| SpeedProfile::through(times, &states))
    }
}
