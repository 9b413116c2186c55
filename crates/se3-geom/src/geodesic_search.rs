//! Boundary-value problems: the shortest geodesic between two points, where no closed form exists.
//!
//! Shooting (Newton's method on the end point) converges fast from a good start and finds any geodesic. Relaxation, which
//! shortens a polygon between the points, converges slowly from any start and finds a local minimum. So: shoot; only if that
//! proves nothing, relax many paths and let geodesics grow along each from both ends, the shortest first.
//!
//! What is shorter than the injectivity radius is the shortest geodesic. **Beyond, it is the best that was found.** The paths are
//! the same for log(p, q) and for log(q, p), so that both find the same geodesic unless the last shot from one end fails.

use nalgebra::{SMatrix, SVector};

use crate::geodesic_flow::{Connection, flow};
use crate::manifold::LogError;
use crate::path_relaxation::{Polygon, SEGMENTS, relaxed_polygons};

/// A shot that ends this close to the goal, relative to the coordinates and the length, has arrived. The flow's own error is
/// 1e-13 a step and grows along the geodesic.
const ARRIVED: f64 = 1e-11;
/// A miss of a few roundings, which another step would not lessen but for luck.
const FLOOR: f64 = 16.0 * f64::EPSILON;
/// Where a geodesic has more stages to grow, it need not come closer than this.
const UNDERWAY: f64 = 1e-4;
/// Two geodesics are the same if their velocities agree to this part: Newton's method separates them by far more.
const SAME_VELOCITY: f64 = 1e-6;
/// Lengths that agree to this part decide nothing: the square root of the flow's accuracy would be 3e-7, shots are better.
const SAME_LENGTH: f64 = 1e-9;
const MOST_SHOTS: usize = 40;
/// Polygons are off by a few per cent where the space bends within a segment. One longer than the best geodesic by more leads to
/// no shorter one.
const HOPELESS: f64 = 1.1;
/// In so many stages a geodesic grows along a polygon. Each starts close to its goal, as one shot at the end of a long geodesic
/// does not: there the first digits of the velocity are not enough.
const STAGES: usize = 8;

/// The initial velocity of the shortest geodesic from p to q that was found.
pub(crate) fn shortest_geodesic<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    q: &SVector<f64, N>,
    injectivity_radius: f64,
) -> Result<SVector<f64, N>, LogError> {
    if !p.iter().chain(q).all(|x| x.is_finite()) {
        return Err(LogError::NotAPoint);
    }
    if p == q {
        return Ok(SVector::zeros());
    }
    let mut search = Search { space, p, q, found: Vec::new(), least_miss: f64::INFINITY, shots: 0 };
    // Within the injectivity radius there is one geodesic only. On its rim rounding decides nothing.
    let is_proven = |length: f64| length < injectivity_radius * (1.0 - SAME_LENGTH);
    search.take_from_p(shoot(space, p, q, space.project_tangent(p, &(q - p))));
    if !is_proven(search.least_length()) {
        search.take_from_q(shoot(space, q, p, space.project_tangent(q, &(p - q))));
    }
    if !is_proven(search.least_length()) {
        for polygon in polygons_between(space, p, q) {
            if polygon.length < HOPELESS * search.least_length() {
                search.shoot_along(&polygon.path);
            }
        }
    }
    search.outcome()
}

/// The length of that geodesic, sought from the lexicographically smaller point so that it is exactly symmetric; NaN where none
/// was found.
pub(crate) fn shortest_distance<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    q: &SVector<f64, N>,
    injectivity_radius: f64,
) -> f64 {
    let (p, q) = in_order(p, q);
    match shortest_geodesic(space, p, q, injectivity_radius) {
        Ok(v) => length(space, p, &v),
        Err(LogError::CutLocus { distance, .. }) => distance,
        Err(LogError::NotFound { .. } | LogError::NotAPoint) => f64::NAN,
    }
}

fn in_order<'a, const N: usize>(
    p: &'a SVector<f64, N>,
    q: &'a SVector<f64, N>,
) -> (&'a SVector<f64, N>, &'a SVector<f64, N>) {
    if p.as_slice() <= q.as_slice() { (p, q) } else { (q, p) }
}

fn length<const N: usize>(space: &impl Connection<N>, p: &SVector<f64, N>, v: &SVector<f64, N>) -> f64 {
    (v.transpose() * space.metric(p) * v)[0].sqrt()
}

/// Shortened polygons from p to q, the shortest first; the same from q to p but for their direction.
fn polygons_between<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    q: &SVector<f64, N>,
) -> Vec<Polygon<N>> {
    let (start, end) = in_order(p, q);
    let mut polygons = relaxed_polygons(space, start, end);
    if start != p {
        polygons.iter_mut().for_each(|polygon| polygon.path.reverse());
    }
    polygons
}

/// The geodesics from p to q that were found so far.
struct Search<'a, S, const N: usize> {
    space: &'a S,
    p: &'a SVector<f64, N>,
    q: &'a SVector<f64, N>,
    /// Velocities at p, with their lengths.
    found: Vec<(f64, SVector<f64, N>)>,
    least_miss: f64,
    shots: usize,
}

impl<S: Connection<N>, const N: usize> Search<'_, S, N> {
    /// Geodesics that follow a path, from either end.
    fn shoot_along(&mut self, path: &[SVector<f64, N>]) {
        self.take_from_p(grow(self.space, path));
        let back: Vec<_> = path.iter().rev().copied().collect();
        self.take_from_q(grow(self.space, &back));
    }

    fn take_from_p(&mut self, shot: Result<SVector<f64, N>, f64>) {
        self.shots += 1;
        match shot {
            Ok(v) => self.found.push((length(self.space, self.p, &v), v)),
            Err(miss) => self.least_miss = self.least_miss.min(miss),
        }
    }

    /// A geodesic from q to p is one from p to q, whose velocity is minus that on arrival.
    fn take_from_q(&mut self, shot: Result<SVector<f64, N>, f64>) {
        self.take_from_p(shot.and_then(|v| {
            let [_, arrival] = flow(self.space, [*self.q, v]).ok_or(f64::INFINITY)?;
            shoot(self.space, self.p, self.q, -arrival)
        }));
    }

    fn least_length(&self) -> f64 {
        self.found.iter().fold(f64::INFINITY, |least, (length, _)| least.min(*length))
    }

    fn outcome(&self) -> Result<SVector<f64, N>, LogError> {
        let best = self.found.iter().min_by(|u, v| u.0.total_cmp(&v.0));
        let (least, v) = best.ok_or(LogError::NotFound { miss: self.least_miss, starts: self.shots })?;
        let is_rival = |(length, u): &(f64, SVector<f64, N>)| {
            *length <= least * (1.0 + SAME_LENGTH) && (u - v).norm() > SAME_VELOCITY * v.norm()
        };
        if self.found.iter().any(is_rival) {
            return Err(LogError::CutLocus { distance: *least, angle_rad: None });
        }
        Ok(*v)
    }
}

/// The geodesic from the start of a path to its end that follows it; `Err` carries the miss of the stage that failed.
fn grow<const N: usize>(space: &impl Connection<N>, path: &[SVector<f64, N>]) -> Result<SVector<f64, N>, f64> {
    let nodes_a_stage = SEGMENTS / STAGES;
    (1..=STAGES).try_fold(path[nodes_a_stage] - path[0], |v, stage| {
        let longer = v * if stage > 1 { stage as f64 / (stage - 1) as f64 } else { 1.0 };
        let precision = if stage < STAGES { UNDERWAY } else { FLOOR };
        shoot_within(precision, space, &path[0], &path[stage * nodes_a_stage], space.project_tangent(&path[0], &longer))
    })
}

/// Newton's method with a halving line search for exp(p, v) = q; `Err` carries the least miss.
fn shoot<const N: usize>(
    space: &impl Connection<N>,
    p: &SVector<f64, N>,
    q: &SVector<f64, N>,
    start: SVector<f64, N>,
) -> Result<SVector<f64, N>, f64> {
    shoot_within(FLOOR, space, p, q, start)
}

fn shoot_within<const N: usize>(
    precision: f64,
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
        if miss <= precision * (p.norm() + q.norm()) {
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
    if miss <= precision.max(ARRIVED) * (p.norm() + q.norm() + v.norm()) { Ok(v) } else { Err(miss) }
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
        let axis = SVector::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
        let tangent = space.project_tangent(p, &axis);
        jacobi.set_column(k, &((end(v + tangent * h)? - reached) / h));
        normals.set_column(k, &(axis - tangent));
    }
    // Least squares on the tangent space; the normal directions, of which Jacobi fields know nothing, get a zero.
    let step = (jacobi.transpose() * jacobi + normals).cholesky()?.solve(&(jacobi.transpose() * miss));
    Some(space.project_tangent(p, &step))
}
