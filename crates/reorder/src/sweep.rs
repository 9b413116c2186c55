//! One pass over all pairs of near points: reach, local sampling density, and points that come between neighbours.

use se3_geom::Manifold;

use crate::curve::Curve;
use crate::near_pairs::{PairSearch, Runs};

/// The local sampling parameter above which a point is doubted.
///
/// NN-CRUST is correct in any dimension if every point of the curve has a sample within ε = 0.66 times its distance to the medial
/// axis; at 0.72 there are samples that two different curves share (Bjerkevik, arXiv 2112.03656).
pub(crate) const LOCAL_EPSILON: f64 = 0.72;

/// A curve of at most this many points is searched for its reach pair by pair.
const EXACT_REACH: usize = 2000;
/// How many steps of a thinned curve are searched around each of its points.
const THINNED_STEPS: f64 = 4.0;

/// There, points that are no more than this many steps apart show the curvature, which neighbours show too.
const ALONG_STEPS: usize = 8;

/// What the pass finds.
pub(crate) struct Sweep {
    /// Smallest radius of a ball that touches the tangent at one point and passes through another; infinite where all points
    /// lie on all tangents.
    pub(crate) reach: f64,
    /// For every position the smallest such ball that touches there, among those that were measured: all through neighbours, and
    /// all that are small enough to make that position's ε exceed [`LOCAL_EPSILON`].
    pub(crate) balls: Vec<f64>,
    /// Smallest ball through a neighbour: the radius of curvature, as far as the samples show it.
    pub(crate) curvature_radius: f64,
    /// For every position the nearest point that disputes one of its neighbours' places.
    pub(crate) rivals: Vec<Option<usize>>,
    /// For every position where ε = (longer gap)/(2·radius) exceeds [`LOCAL_EPSILON`]: the point on the smallest ball, and ε.
    pub(crate) sparse: Vec<Option<(usize, f64)>>,
}

struct Vertex<T> {
    nearer: usize,
    nearer_gap: f64,
    farther_gap: f64,
    /// Unit tangent; `None` at an open end or on a cut locus.
    tangent: Option<T>,
}

/// A point disputes the neighbours of p if it is nearer than p's nearer neighbour, or nearer than the farther one and on that
/// one's side (at more than 90° from the nearer one, by log at p). No rival anywhere means that every point's edges are the ones
/// which NN-CRUST (Dey and Kumar, 1999) draws. At an open end the missing neighbour counts as `beyond_ends` away.
///
/// The ball at p through q has radius ‖v‖²/(2‖v⊥‖) ≥ ‖v‖/2, v = log_p(q): only near pairs need their logarithm taken. Rivals and sparse
/// points are found exactly. So is the reach of up to 2000 points; beyond that, balls that reach farther than four gaps are
/// measured on thinned curves, every second point, every fourth, and so on: where two strands are w apart, the nearest kept point across
/// is at most half a step ≤ w/4 beside the nearest point, so that (w² + w²/16)/2w overstates the reach by 1/16 at most, and a certified
/// order allows for a factor of 2.
pub(crate) fn sweep<M: Manifold>(curve: &Curve<M>, beyond_ends: [f64; 2]) -> Sweep {
    let n = curve.len();
    let vertices: Vec<Vertex<M::Tangent>> = (0..n).map(|k| vertex(curve, k, beyond_ends)).collect();
    let (unbounded, none) = (f64::INFINITY, vec![None; n]);
    let mut found = Sweep {
        reach: unbounded,
        balls: vec![unbounded; n],
        curvature_radius: unbounded,
        rivals: none,
        sparse: vec![None; n],
    };
    // Neighbours first: they bound the reach, so that most other pairs are told by their distance alone.
    for (k, next) in (0..n).filter_map(|k| Some((k, curve.next(k)?))) {
        found.measure_ball(curve, &vertices[k], k, next);
        found.measure_ball(curve, &vertices[next], next, k);
    }
    found.curvature_radius = found.reach;
    let exact = n <= EXACT_REACH;
    let positions: Vec<usize> = (0..n).collect();
    let farther_than_sparse = if exact { 1.0 / LOCAL_EPSILON } else { THINNED_STEPS };
    let wanted: Vec<f64> = vertices.iter().map(|v| farther_than_sparse * v.farther_gap).collect();
    let rival_distances = vec![f64::INFINITY; n];
    let curvature_radius = found.curvature_radius;
    let mut search = Disputes { curve, vertices: &vertices, wanted: &wanted, found, rival_distances, exact };
    let thinned = || if exact { curvature_radius } else { thinned_reach(curve, &vertices, curvature_radius) };
    let ((), thinned) = rayon::join(|| Runs::new(curve, &positions, &wanted).join(&mut search), thinned);
    let mut found = search.found;
    found.reach = found.reach.min(thinned);
    found
}

/// The reach of ever thinner curves, down to one that is searched pair by pair.
fn thinned_reach<M: Manifold>(curve: &Curve<M>, vertices: &[Vertex<M::Tangent>], mut reach: f64) -> f64 {
    for step in std::iter::successors(Some(2), |step| Some(2 * step)) {
        let kept: Vec<usize> = (0..curve.len()).step_by(step).collect();
        let coarse = kept.len() <= EXACT_REACH;
        let gaps: Vec<f64> = kept.windows(2).map(|w| curve.distance(w[0], w[1])).collect();
        let around = |k: usize| gaps[k.saturating_sub(1)..(k + 1).min(gaps.len())].iter().copied().fold(0.0, f64::max);
        let wanted: Vec<f64> = (0..kept.len()).map(|k| THINNED_STEPS * around(k)).collect();
        let mut search = SmallestBall { curve, vertices, wanted: &wanted, reach, step, coarse };
        Runs::new(curve, &kept, &wanted).join(&mut search);
        reach = search.reach;
        if coarse {
            break;
        }
    }
    reach
}

/// The search at full density.
struct Disputes<'a, 'b, M: Manifold> {
    curve: &'a Curve<'b, M>,
    vertices: &'a [Vertex<M::Tangent>],
    wanted: &'a [f64],
    found: Sweep,
    rival_distances: Vec<f64>,
    exact: bool,
}

impl<M: Manifold> PairSearch for Disputes<'_, '_, M> {
    fn everywhere(&self) -> f64 {
        if self.exact { 2.0 * self.found.reach } else { 0.0 }
    }
    fn visit(&mut self, i: usize, j: usize, distance: f64) {
        // Farther pairs come only as it happens, and the thinned curves have their like.
        let across = self.exact || (j - i > ALONG_STEPS && distance <= self.wanted[i].max(self.wanted[j]));
        let Self { curve, vertices, found, .. } = self;
        if curve.are_neighbours(i, j) {
            return;
        }
        for (at, other) in [(i, j), (j, i)] {
            let vertex = &vertices[at];
            if (across && distance < 2.0 * found.reach) || LOCAL_EPSILON * distance < vertex.farther_gap {
                found.measure_ball(curve, vertex, at, other);
            }
            let near = distance < vertex.farther_gap && distance < self.rival_distances[at];
            if near && disputes(curve, vertex, at, other, distance) {
                self.rival_distances[at] = distance;
                found.rivals[at] = Some(other);
            }
        }
    }
}

/// The search on a thinned curve, with the tangents of the full one.
struct SmallestBall<'a, 'b, M: Manifold> {
    curve: &'a Curve<'b, M>,
    vertices: &'a [Vertex<M::Tangent>],
    /// Of the positions that are kept.
    wanted: &'a [f64],
    reach: f64,
    step: usize,
    coarse: bool,
}

impl<M: Manifold> PairSearch for SmallestBall<'_, '_, M> {
    fn everywhere(&self) -> f64 {
        if self.coarse { 2.0 * self.reach } else { 0.0 }
    }
    fn visit(&mut self, i: usize, j: usize, distance: f64) {
        let wanted = |k: usize| self.wanted[k / self.step];
        let across = self.coarse || (j - i > ALONG_STEPS * self.step && distance <= wanted(i).max(wanted(j)));
        if across && distance < 2.0 * self.reach {
            for (at, other) in [(i, j), (j, i)] {
                let radius = self.vertices[at].tangent.and_then(|tangent| ball_radius(self.curve, tangent, at, other));
                self.reach = self.reach.min(radius.unwrap_or(f64::INFINITY));
            }
        }
    }
}

impl Sweep {
    fn measure_ball<M: Manifold>(&mut self, curve: &Curve<M>, vertex: &Vertex<M::Tangent>, at: usize, other: usize) {
        let Some(radius) = vertex.tangent.and_then(|tangent| ball_radius(curve, tangent, at, other)) else { return };
        self.reach = self.reach.min(radius);
        self.balls[at] = self.balls[at].min(radius);
        let epsilon = vertex.farther_gap / (2.0 * radius);
        if epsilon > self.sparse[at].map_or(LOCAL_EPSILON, |(_, worst)| worst) {
            self.sparse[at] = Some((other, epsilon));
        }
    }
}

fn vertex<M: Manifold>(curve: &Curve<M>, k: usize, beyond_ends: [f64; 2]) -> Vertex<M::Tangent> {
    match (curve.previous(k), curve.next(k)) {
        (Some(a), Some(b)) => {
            let (gap_a, gap_b) = (curve.distance(k, a), curve.distance(k, b));
            let (nearer, nearer_gap, farther_gap) = if gap_a <= gap_b { (a, gap_a, gap_b) } else { (b, gap_b, gap_a) };
            Vertex { nearer, nearer_gap, farther_gap, tangent: parabola_tangent(curve, k, (a, gap_a), (b, gap_b)) }
        }
        (a, b) => {
            let nearer = a.or(b).unwrap_or(k);
            let nearer_gap = curve.distance(k, nearer);
            let farther_gap = beyond_ends[usize::from(b.is_none())].max(nearer_gap);
            Vertex { nearer, nearer_gap, farther_gap, tangent: None }
        }
    }
}

/// Unit velocity at position k of the parabola through k and its neighbours: second-order accurate for uneven gaps too.
fn parabola_tangent<M: Manifold>(
    curve: &Curve<M>,
    k: usize,
    (a, gap_a): (usize, f64),
    (b, gap_b): (usize, f64),
) -> Option<M::Tangent> {
    let velocity = curve.log(k, b)? * (gap_a / gap_b) - curve.log(k, a)? * (gap_b / gap_a);
    let speed = curve.manifold.norm(curve.point(k), velocity);
    (speed > 0.0).then(|| velocity * (1.0 / speed))
}

/// `None` where `other` lies on the tangent up to rounding, or on the cut locus, which is farther than any reach that matters.
fn ball_radius<M: Manifold>(curve: &Curve<M>, tangent: M::Tangent, at: usize, other: usize) -> Option<f64> {
    let (manifold, p) = (curve.manifold, curve.point(at));
    let v = curve.log(at, other)?;
    let length = manifold.norm(p, v);
    let normal = manifold.norm(p, v - tangent * manifold.inner(p, v, tangent));
    (normal > 8.0 * f64::EPSILON * length).then(|| length * length / (2.0 * normal))
}

fn disputes<M: Manifold>(
    curve: &Curve<M>,
    vertex: &Vertex<M::Tangent>,
    at: usize,
    other: usize,
    distance: f64,
) -> bool {
    distance < vertex.nearer_gap || curve.cosine(at, vertex.nearer, other).is_none_or(|cosine| cosine < 0.0)
}
