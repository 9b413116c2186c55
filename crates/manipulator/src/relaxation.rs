//! The self-motion of a redundant arm along a curve, made smooth: the least of motion and discomfort together.

use nalgebra::{DMatrix, DVector};

use crate::continuation::Tracker;
use crate::layers::{DISCOMFORT_COST, settled};
use crate::posture::{discomfort, first_violation, self_motions};
use crate::stations::Station;

const ROUNDS: usize = 12;
/// Stations that are relaxed together.
const WINDOW: usize = 96;
/// A round that gains less than this part of the energy is the last.
const WORTHWHILE: f64 = 1e-3;
/// Longest step of a round, in rad or m: a self-motion is a curve, and its tangent serves this far.
const LONGEST_STEP: f64 = 0.3;
const MAX_SHORTENINGS: usize = 5;
/// Step of the difference quotients of the discomfort, in rad or m: their errors, 1e-6 of it, do not matter to a descent.
const DIFFERENCE: f64 = 1e-3;

/// Moves `configurations[k]`, at `stations[k]`, along their self-motions so that Σ ½‖(qₖ₊₁ − qₖ)/v‖²/lₖ + c·lₖ·discomfort falls, by Newton's method
/// with line search. On a closed curve the first and the last stay alike; `hold_first` keeps the first where it is.
pub(crate) fn relax(
    tracker: &Tracker<'_>,
    stations: &[Station],
    configurations: &mut [DVector<f64>],
    hold_first: bool,
) {
    let closed = tracker.curve.is_closed();
    let count = stations.len();
    if count <= WINDOW {
        let free = if hold_first { 1..count - usize::from(closed) } else { 0..count - usize::from(closed) };
        Band { tracker, stations, free, closed }.settle(configurations);
        return;
    }
    // Windows that overlap by half, each with its neighbours held.
    let mut from = 1;
    while from < count - 1 {
        let free = from..(from + WINDOW).min(count - 1);
        Band { tracker, stations, free, closed }.settle(configurations);
        from += WINDOW / 2;
    }
}

struct Band<'a> {
    tracker: &'a Tracker<'a>,
    stations: &'a [Station],
    /// Stations that may move.
    free: std::ops::Range<usize>,
    closed: bool,
}

impl Band<'_> {
    fn settle(&self, configurations: &mut [DVector<f64>]) {
        let Some(mut energy) = self.energy(configurations) else { return };
        for _ in 0..ROUNDS {
            let Some(step) = self.newton_step(configurations) else { return };
            let mut part = (LONGEST_STEP / step.iter().map(|s| s.amax()).fold(1e-12, f64::max)).min(1.0);
            let mut better = None;
            for _ in 0..MAX_SHORTENINGS {
                better = self.moved(configurations, &step, part).and_then(|trial| {
                    let less = self.energy(&trial).filter(|e| *e < energy)?;
                    Some((trial, less))
                });
                if better.is_some() {
                    break;
                }
                part *= 0.4;
            }
            let Some((trial, less)) = better else { return };
            configurations.clone_from_slice(&trial);
            let gain = energy - less;
            energy = less;
            if gain < WORTHWHILE * energy.abs() {
                return;
            }
        }
    }

    /// Stations whose configurations enter the energy.
    fn touched(&self) -> std::ops::Range<usize> {
        if self.closed && self.free.start == 0 {
            return 0..self.stations.len();
        }
        self.free.start.saturating_sub(1)..(self.free.end + 1).min(self.stations.len())
    }

    /// `None` where a configuration is not legal.
    fn energy(&self, configurations: &[DVector<f64>]) -> Option<f64> {
        let touched = self.touched();
        let mut sum = 0.0;
        for k in touched.clone() {
            let q = &configurations[k];
            sum += self.weight(k) * self.discomfort(q)?;
            if k + 1 < touched.end {
                let way = &configurations[k + 1] - q;
                sum += 0.5 * way.component_div(&self.tracker.robot.limits.velocity).norm_squared()
                    / self.stations[k].length;
            }
        }
        Some(sum)
    }

    /// `None` beyond limits and at singularities.
    fn discomfort(&self, q: &DVector<f64>) -> Option<f64> {
        let robot = self.tracker.robot;
        let jacobian = robot.chain.body_jacobian(q);
        let legal = first_violation(robot, q).is_none() && self.tracker.is_regular(&jacobian);
        legal.then(|| discomfort(robot, q, &jacobian))
    }

    /// Half the way to either neighbour, as the trapezoid rule has it.
    fn weight(&self, k: usize) -> f64 {
        let before = if k > 0 { self.stations[k - 1].length } else { 0.0 };
        0.5 * DISCOMFORT_COST * (before + self.stations[k].length)
    }

    /// What each free configuration is moved by, tangentially to its self-motion.
    fn newton_step(&self, configurations: &[DVector<f64>]) -> Option<Vec<DVector<f64>>> {
        let robot = self.tracker.robot;
        let touched = self.touched();
        let bases: Vec<DMatrix<f64>> = touched
            .clone()
            .map(|k| self_motions(&robot.chain.body_jacobian(&configurations[k])))
            .collect::<Option<_>>()?;
        let from = touched.start;
        let basis = |k: usize| &bases[k - from];
        let freedom = bases[0].ncols();
        let wrap = self.closed && self.free.start == 0;
        // The last station of a closed curve is its first.
        let place = |k: usize| {
            let k = if wrap && k + 1 == self.stations.len() { 0 } else { k };
            self.free.contains(&k).then(|| (k - self.free.start) * freedom)
        };
        let size = self.free.len() * freedom;
        let (mut gradient, mut hessian) = (DVector::zeros(size), DMatrix::zeros(size, size));
        let weights = robot.limits.velocity.map(|v| v.powi(-2));
        for k in touched.clone().take(touched.len() - 1) {
            let stiffness = &weights / self.stations[k].length;
            let force = (&configurations[k + 1] - &configurations[k]).component_mul(&stiffness);
            for (a, sign) in [(k, -1.0), (k + 1, 1.0)] {
                let Some(row) = place(a) else { continue };
                let mut part = gradient.rows_mut(row, freedom);
                part += basis(a).transpose() * &force * sign;
                for (b, other) in [(k, -1.0), (k + 1, 1.0)] {
                    let Some(column) = place(b) else { continue };
                    let weighted = DMatrix::from_diagonal(&stiffness) * basis(b);
                    let mut block = hessian.view_mut((row, column), (freedom, freedom));
                    block += basis(a).transpose() * weighted * (sign * other);
                }
            }
        }
        for k in touched {
            let Some(row) = place(k) else { continue };
            // Beyond a limit the discomfort stays at its greatest, so that the difference draws a joint at its limit away from it.
            let pull = |q: &DVector<f64>| discomfort(robot, q, &robot.chain.body_jacobian(q));
            let here = pull(&configurations[k]);
            for (d, direction) in basis(k).column_iter().enumerate() {
                let at = |h: f64| pull(&(&configurations[k] + direction * h));
                let (after, before) = (at(DIFFERENCE), at(-DIFFERENCE));
                gradient[row + d] += self.weight(k) * (after - before) / (2.0 * DIFFERENCE);
                let bend = (after + before - 2.0 * here) / DIFFERENCE.powi(2);
                hessian[(row + d, row + d)] += self.weight(k) * bend.max(0.0);
            }
        }
        let step = -hessian.cholesky()?.solve(&gradient);
        Some(self.free.clone().map(|k| basis(k) * step.rows((k - self.free.start) * freedom, freedom)).collect())
    }

    fn moved(&self, configurations: &[DVector<f64>], step: &[DVector<f64>], part: f64) -> Option<Vec<DVector<f64>>> {
        let mut moved = configurations.to_vec();
        for (k, by) in self.free.clone().zip(step) {
            moved[k] = settled(self.tracker, self.stations[k].s, &(&configurations[k] + by * part))?;
        }
        if self.closed && self.free.start == 0 {
            let last = configurations.len() - 1;
            let shift = &moved[0] - &configurations[0];
            moved[last] += shift;
        }
        Some(moved)
    }
}
