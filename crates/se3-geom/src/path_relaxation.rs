//! Paths that are pulled tight: coarse geodesics from any start, for shots to begin with.

use std::f64::consts::PI;

use nalgebra::SVector;

use crate::geodesic_flow::Connection;

const SEGMENTS: usize = 32;
const MOST_RELAXATIONS: usize = 300;
/// How paths swing out before they are pulled tight: half waves, and how far as a part of the distance of the two points.
const SWINGS: [(f64, f64); 5] = [(1.0, 0.25), (1.0, 0.5), (1.0, 1.0), (2.0, 0.25), (3.0, 0.25)];
/// Polygons whose velocities agree to this part at both ends are the same geodesic, and stopped at slightly different places.
const SAME_POLYGON: f64 = 1e-2;

/// A path of straight pieces, as short as can be in its neighbourhood.
pub(crate) struct Polygon<const N: usize> {
    /// Its squared length, if evenly divided.
    pub(crate) energy: f64,
    /// Velocity at its start, for unit time.
    pub(crate) leaving_start: SVector<f64, N>,
    /// Velocity at its end, backwards.
    pub(crate) leaving_end: SVector<f64, N>,
}

impl<const N: usize> Polygon<N> {
    fn of(energy: f64, path: &[SVector<f64, N>]) -> Self {
        let slope = |[a, b, c]: [SVector<f64, N>; 3]| (b * 4.0 - a * 3.0 - c) * (0.5 * SEGMENTS as f64);
        let leaving_end = slope([path[SEGMENTS], path[SEGMENTS - 1], path[SEGMENTS - 2]]);
        Self { energy, leaving_start: slope([path[0], path[1], path[2]]), leaving_end }
    }

    pub(crate) fn turn_round(&mut self) {
        std::mem::swap(&mut self.leaving_start, &mut self.leaving_end);
    }

    fn is_like(&self, other: &Self) -> bool {
        let alike = |u: &SVector<f64, N>, v: &SVector<f64, N>| (u - v).norm() <= SAME_POLYGON * v.norm();
        alike(&self.leaving_start, &other.leaving_start) && alike(&self.leaving_end, &other.leaving_end)
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
    let mut swings = vec![(0.0, SVector::zeros())];
    for side in sides(space, p, &chord) {
        let both_ways =
            |(half_waves, part): (f64, f64)| [part, -part].map(|part| (half_waves, side * (part * chord.norm())));
        swings.extend(SWINGS.into_iter().flat_map(both_ways));
    }
    let start = |(half_waves, swing): &(f64, SVector<f64, N>)| -> Option<Vec<SVector<f64, N>>> {
        let node = |i: usize| match i {
            0 => Some(*p),
            SEGMENTS => Some(*q),
            _ => {
                let t = i as f64 / SEGMENTS as f64;
                space.project(&(p + chord * t + swing * (half_waves * PI * t).sin()))
            }
        };
        (0..=SEGMENTS).map(node).collect()
    };
    let mut relaxed: Vec<Polygon<N>> = swings.iter().filter_map(start).map(|path| relax(space, path)).collect();
    relaxed.retain(|polygon| polygon.energy.is_finite());
    relaxed.sort_by(|a, b| a.energy.total_cmp(&b.energy));
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
        if gain < 1e-7 * now {
            break;
        }
    }
    Polygon::of(now, &path)
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
