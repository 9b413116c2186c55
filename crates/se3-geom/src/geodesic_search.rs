//! Boundary-value problems: the shortest geodesic between two points, where no closed form exists.
//!
//! Shooting (Newton's method on the end point) converges fast from a good start and finds any geodesic. Relaxation, which
//! shortens a polygon between the points, converges slowly from any start and finds a local minimum. So: shoot; only if that
//! proves nothing, relax from several starts and shoot from each.

use nalgebra::{SMatrix, SVector};

use crate::geodesic_flow::{Connection, flow};
use crate::manifold::LogError;

/// A shot that ends this close to the goal, relative to the coordinates and the length, has arrived. The flow's own error is
/// 1e-13 a step and grows along the geodesic.
const ARRIVED: f64 = 1e-11;
/// A miss of a few roundings, which another step would not lessen but for luck.
const FLOOR: f64 = 16.0 * f64::EPSILON;
/// Two geodesics are the same if their velocities agree to this part: Newton's method separates them by far more.
const SAME_VELOCITY: f64 = 1e-6;
/// Lengths that agree to this part decide nothing: the square root of the flow's accuracy would be 3e-7, shots are better.
const SAME_LENGTH: f64 = 1e-9;
const MOST_SHOTS: usize = 40;
const SEGMENTS: usize = 32;
const MOST_RELAXATIONS: usize = 300;
/// How far bowed starts swing out, as a part of the distance of the two points.
const BOW: f64 = 0.5;

/// The initial velocity of the shortest geodesic from p to q that was found.
pub(crate) fn shortest_geodesic<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    q: &SVector<f64, N>,
    injectivity_radius: f64,
) -> Result<SVector<f64, N>, LogError> {
    if p == q {
        return Ok(SVector::zeros());
    }
    let chord = q - p;
    let length = |v: &SVector<f64, N>| (v.transpose() * space.metric(p) * v)[0].sqrt();
    let mut found: Vec<SVector<f64, N>> = Vec::new();
    let mut least_miss = f64::INFINITY;
    let bows = bows(space, p, &chord);
    let starts = std::iter::once(Some(space.project_tangent(p, &chord)))
        .chain(bows.iter().map(|bow| relaxed_velocity(space, p, q, bow)));
    for start in starts.flatten() {
        match shoot(space, p, q, start) {
            // Within the injectivity radius there is one geodesic only. On its rim rounding decides nothing.
            Ok(v) if length(&v) < injectivity_radius * (1.0 - SAME_LENGTH) => return Ok(v),
            Ok(v) => found.push(v),
            Err(miss) => least_miss = least_miss.min(miss),
        }
    }
    let best = found.iter().min_by(|u, v| length(u).total_cmp(&length(v))).copied();
    let best = best.ok_or(LogError::NotFound { miss: least_miss, starts: 1 + bows.len() })?;
    let rivals = |v: &&SVector<f64, N>| {
        length(v) <= length(&best) * (1.0 + SAME_LENGTH) && (*v - best).norm() > SAME_VELOCITY * best.norm()
    };
    match found.iter().find(rivals) {
        Some(_) => Err(LogError::CutLocus { distance: length(&best) }),
        None => Ok(best),
    }
}

/// Directions in which paths between the points may swing out: none, then both ways along an orthogonal basis across the chord.
fn bows<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    chord: &SVector<f64, N>,
) -> Vec<SVector<f64, N>> {
    let mut basis = vec![chord.normalize()];
    let mut bows = vec![SVector::zeros()];
    for axis in 0..N {
        let tangent = space.project_tangent(p, &unit(axis));
        let across = basis.iter().fold(tangent, |rest, b| rest - b * b.dot(&rest));
        if across.norm() > 0.1 {
            basis.push(across.normalize());
            let bow = across.normalize() * (BOW * chord.norm());
            bows.extend([bow, -bow]);
        }
    }
    bows
}

fn unit<const N: usize>(axis: usize) -> SVector<f64, N> {
    SVector::from_fn(|i, _| if i == axis { 1.0 } else { 0.0 })
}

/// Newton's method with a halving line search for exp(p, v) = q; `Err` carries the least miss.
fn shoot<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    q: &SVector<f64, N>,
    start: SVector<f64, N>,
) -> Result<SVector<f64, N>, f64> {
    let end = |v: SVector<f64, N>| flow(space, [*p, v]).map(|[end, _]| end);
    let mut v = start;
    let mut reached = end(v).ok_or(f64::INFINITY)?;
    for _ in 0..MOST_SHOTS {
        let miss = (q - reached).norm();
        if miss <= FLOOR * (p.norm() + q.norm()) {
            break;
        }
        let Some(step) = newton_step(space, p, &v, &reached, &(q - reached), end) else { break };
        let shorter = (0..10).map(|halvings| v + step * 0.5_f64.powi(halvings)).find_map(|trial| {
            let reached = end(trial)?;
            ((q - reached).norm() < miss).then_some((trial, reached))
        });
        let Some(better) = shorter else { break };
        (v, reached) = better;
    }
    let miss = (q - reached).norm();
    if miss <= ARRIVED * (p.norm() + q.norm() + v.norm()) { Ok(v) } else { Err(miss) }
}

/// The tangent δ at p for which exp(p, v + δ) comes `miss` further, by Jacobi fields from forward differences.
fn newton_step<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    v: &SVector<f64, N>,
    reached: &SVector<f64, N>,
    miss: &SVector<f64, N>,
    end: impl Fn(SVector<f64, N>) -> Option<SVector<f64, N>>,
) -> Option<SVector<f64, N>> {
    // The square root of the flow's accuracy balances its error against the second-order term; the second bound keeps the
    // difference of two ends clear of the rounding of their coordinates where the points are close together.
    let h = (3e-7 * v.norm()).max(1e-8 * p.norm());
    let mut jacobi = SMatrix::<f64, N, N>::zeros();
    let mut normals = SMatrix::<f64, N, N>::identity();
    for k in 0..N {
        let axis = unit(k);
        let tangent = space.project_tangent(p, &axis);
        jacobi.set_column(k, &((end(v + tangent * h)? - reached) / h));
        normals.set_column(k, &(axis - tangent));
    }
    // Least squares on the tangent space; the normal directions, of which Jacobi fields know nothing, get a zero.
    let step = (jacobi.transpose() * jacobi + normals).cholesky()?.solve(&(jacobi.transpose() * miss));
    Some(space.project_tangent(p, &step))
}

/// The initial velocity of a polygon from p to q, shortened from a path that swings out by `bow`; `None` where that path
/// leaves the space.
fn relaxed_velocity<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    q: &SVector<f64, N>,
    bow: &SVector<f64, N>,
) -> Option<SVector<f64, N>> {
    let mut path = vec![*p];
    for i in 1..SEGMENTS {
        let t = i as f64 / SEGMENTS as f64;
        path.push(space.project(&(p + (q - p) * t + bow * (std::f64::consts::PI * t).sin()))?);
    }
    path.push(*q);
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
    let slope = (path[1] * 4.0 - path[0] * 3.0 - path[2]) * (0.5 * SEGMENTS as f64);
    Some(space.project_tangent(p, &slope))
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

/// The distance where there is no logarithm: NaN where no geodesic was found.
pub(crate) fn distance_without_log(error: LogError) -> f64 {
    match error {
        LogError::CutLocus { distance } => distance,
        LogError::NotFound { .. } | LogError::NotAPoint => f64::NAN,
    }
}
