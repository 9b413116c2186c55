//! Paths that are pulled tight: coarse geodesics from any start, for shots to begin with.

use std::f64::consts::PI;

use nalgebra::SVector;

use crate::geodesic_flow::Connection;

pub(crate) const SEGMENTS: usize = 32;
const MOST_RELAXATIONS: usize = 100;
/// How far paths swing out in one half wave before they are pulled tight, and in two, as parts of the distance of the two points.
/// Every one with every other, so that they pass obstacles on all sides.
const BOWS: [f64; 7] = [0.0, 0.25, -0.25, 0.5, -0.5, 1.0, -1.0];
const WEAVES: [f64; 3] = [0.0, 0.25, -0.25];
/// Polygons that agree to this part of the distance of the two points are the same geodesic, and stopped at slightly different
/// places.
const SAME_POLYGON: f64 = 1e-2;

/// A path of straight pieces, as short as can be in its neighbourhood.
pub(crate) struct Polygon<const N: usize> {
    /// Its length, if evenly divided; a little more, if not.
    pub(crate) length: f64,
    pub(crate) path: Vec<SVector<f64, N>>,
}

impl<const N: usize> Polygon<N> {
    fn is_like(&self, other: &Self) -> bool {
        let apart = self.path.iter().zip(&other.path).map(|(x, y)| (x - y).norm());
        apart.fold(0.0, f64::max) <= SAME_POLYGON * (self.path[SEGMENTS] - self.path[0]).norm()
    }
}

/// The different polygons that come of the straight path from p to q and of those that swing out to every side, the shortest
/// first.
pub(crate) fn relaxed_polygons<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    q: &SVector<f64, N>,
) -> Vec<Polygon<N>> {
    let chord = q - p;
    let mut swings = vec![[SVector::zeros(); 2]];
    for side in sides(space, p, &chord) {
        let across = side * chord.norm();
        let swing = |bow: f64, weave: f64| [across * bow, across * weave];
        let both = BOWS.into_iter().flat_map(|bow| WEAVES.into_iter().map(move |weave| (bow, weave)));
        swings.extend(both.skip(1).map(|(bow, weave)| swing(bow, weave)));
    }
    let start = |[bow, weave]: &[SVector<f64, N>; 2]| -> Option<Vec<SVector<f64, N>>> {
        let node = |i: usize| match i {
            0 => Some(*p),
            SEGMENTS => Some(*q),
            _ => {
                let t = i as f64 / SEGMENTS as f64;
                space.project(&(p + chord * t + bow * (PI * t).sin() + weave * (2.0 * PI * t).sin()))
            }
        };
        (0..=SEGMENTS).map(node).collect()
    };
    let mut relaxed: Vec<Polygon<N>> = swings.iter().filter_map(start).map(|path| relax(space, path)).collect();
    relaxed.retain(|polygon| polygon.length.is_finite());
    relaxed.sort_by(|a, b| a.length.total_cmp(&b.length));
    let mut different: Vec<Polygon<N>> = Vec::new();
    for polygon in relaxed {
        if !different.iter().any(|other| polygon.is_like(other)) {
            different.push(polygon);
        }
    }
    different
}

/// An orthonormal basis of the directions at p across the chord.
fn sides<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    chord: &SVector<f64, N>,
) -> Vec<SVector<f64, N>> {
    let mut basis = vec![chord.normalize()];
    for axis in 0..N {
        let tangent = space.project_tangent(p, &SVector::from_fn(|i, _| if i == axis { 1.0 } else { 0.0 }));
        let across = basis.iter().fold(tangent, |rest, b| rest - b * b.dot(&rest));
        if across.norm() > 0.1 {
            basis.push(across.normalize());
        }
    }
    basis.split_off(1)
}

/// The path pulled tight, its ends fixed.
fn relax<const N: usize>(space: &impl Connection<N>, mut path: Vec<SVector<f64, N>>) -> Polygon<N> {
    let mut now = energy(space, &path);
    let mut step = 1.0;
    for _ in 0..MOST_RELAXATIONS {
        let descent = smoothed_descent(space, &path);
        let moved = |step: f64| -> Option<(f64, Vec<SVector<f64, N>>)> {
            let mut trial = path.clone();
            for (node, change) in trial[1..SEGMENTS].iter_mut().zip(&descent) {
                *node = space.project(&(*node + change * step))?;
            }
            Some((energy(space, &trial), trial))
        };
        let shorter = (0..20).map(|halvings| step * 0.5_f64.powi(halvings)).find_map(|step| {
            let (energy, trial) = moved(step)?;
            (energy < now).then_some((step, energy, trial))
        });
        let Some((accepted, energy, trial)) = shorter else { break };
        let gain = now - energy;
        (path, now) = (trial, energy);
        step = (2.0 * accepted).min(1.0);
        // The polygon itself is off by 1/SEGMENTS² ≈ 1e-3: more digits of it would help no shot.
        if gain < 1e-6 * now {
            break;
        }
    }
    Polygon { length: (now * SEGMENTS as f64).sqrt(), path }
}

/// Σ Δxᵀ·g·Δx with the metric in the middle of each segment; its minimum is the geodesic, evenly divided.
fn energy<const N: usize>(space: &impl Connection<N>, path: &[SVector<f64, N>]) -> f64 {
    path.windows(2)
        .map(|pair| {
            let difference = pair[1] - pair[0];
            (difference.transpose() * space.metric(&((pair[0] + pair[1]) * 0.5)) * difference)[0]
        })
        .sum()
}

/// The direction of steepest descent of the energy among paths, in the norm of their derivative (H¹): −δ″ = g·Dẋ/dt. In that
/// norm the number of steps does not grow with the number of nodes.
fn smoothed_descent<const N: usize>(space: &impl Connection<N>, path: &[SVector<f64, N>]) -> Vec<SVector<f64, N>> {
    let interior = path.len() - 2;
    let mut forces: Vec<SVector<f64, N>> = path
        .windows(3)
        .map(|nodes| {
            let velocity = (nodes[2] - nodes[0]) * 0.5;
            let acceleration = nodes[2] - nodes[1] * 2.0 + nodes[0];
            let covariant = acceleration - space.parallel_rate(&nodes[1], &velocity, &velocity);
            space.metric(&nodes[1]) * space.project_tangent(&nodes[1], &covariant)
        })
        .collect();
    // Thomas' algorithm for the tridiagonal matrix (−1, 2, −1): its pivots are (i + 2)/(i + 1).
    let pivot = |i: usize| (i + 2) as f64 / (i + 1) as f64;
    for i in 1..interior {
        let carried = forces[i - 1] / pivot(i - 1);
        forces[i] += carried;
    }
    for i in (0..interior).rev() {
        let above = if i + 1 < interior { forces[i + 1] } else { SVector::zeros() };
        forces[i] = (forces[i] + above) / pivot(i);
    }
    for (direction, node) in forces.iter_mut().zip(&path[1..]) {
        *direction = space.project_tangent(node, direction);
    }
    forces
}
