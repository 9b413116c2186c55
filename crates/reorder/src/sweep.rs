//! One pass over all pairs of points: reach, and points that come between neighbours.

use se3_geom::{Manifold, Tangent};

use crate::curve::Curve;

/// What the pass finds.
pub(crate) struct Sweep {
    /// Smallest Federer quotient; infinite where nothing is normal to any tangent.
    pub(crate) reach: f64,
    /// For every position the nearest point that disputes one of its neighbours' places.
    pub(crate) rivals: Vec<Option<usize>>,
    /// For every position the point that makes the local sampling parameter ε greatest, with that ε, where it exceeds
    /// [`LOCAL_EPSILON`].
    pub(crate) sparse: Vec<Option<(usize, f64)>>,
}

/// NN-CRUST is correct on ε-samples up to this ε in any dimension (Bjerkevik, arXiv 2112.03656): every point of the curve has a
/// sample within ε times its distance to the medial axis. Here ε at p = (longer gap at p)/(2r), r the radius of the smallest ball
/// through another sample that touches the tangent at p.
pub(crate) const LOCAL_EPSILON: f64 = 0.66;

struct Vertex<T> {
    nearer: usize,
    nearer_gap: f64,
    farther_gap: f64,
    /// Unit tangent; `None` at an open end or on a cut locus.
    tangent: Option<T>,
}

/// A point disputes the neighbours of p if it is nearer than p's nearer neighbour, or nearer than the farther one and on that
/// one's side (at more than 90° from the nearer one, by log at p). No rival anywhere means that every point's edges are the ones
/// which NN-CRUST (Dey and Kumar, 1999) draws. At an open end the missing neighbour counts as `beyond_end` away.
pub(crate) fn sweep<M: Manifold>(curve: &Curve<M>, beyond_end: [f64; 2]) -> Sweep {
    let n = curve.len();
    let vertices: Vec<Vertex<M::Tangent>> = (0..n).map(|k| vertex(curve, k, beyond_end)).collect();
    let mut reach = f64::INFINITY;
    let mut rivals = vec![None; n];
    let mut sparse = vec![None; n];
    let mut rival_distance = vec![f64::INFINITY; n];
    let adjacent = |i: usize, j: usize| j == i + 1 || (curve.closed && i == 0 && j + 1 == n);

    for (k, next) in (0..n).filter_map(|k| Some((k, curve.next(k)?))) {
        for (at, other) in [(k, next), (next, k)] {
            let radius = federer(curve, &vertices[at], at, other);
            reach = reach.min(radius);
            note_sparse(&mut sparse[at], other, 0.5 * vertices[at].farther_gap / radius);
        }
    }
    for i in 0..n {
        for j in (i + 1)..n {
            if adjacent(i, j) {
                continue;
            }
            let d = curve.distance(i, j);
            // The normal part is at most the whole, so that no pair farther apart can lower the reach.
            for (at, other) in [(i, j), (j, i)] {
                if d < 2.0 * reach || d * crate::par("EPS",0.66) < vertices[at].farther_gap {
                    let radius = federer(curve, &vertices[at], at, other);
                    reach = reach.min(radius);
                    note_sparse(&mut sparse[at], other, 0.5 * vertices[at].farther_gap / radius);
                }
                if d < vertices[at].farther_gap
                    && d < rival_distance[at]
                    && disputes(curve, &vertices[at], at, other, d)
                {
                    rival_distance[at] = d;
                    rivals[at] = Some(other);
                }
            }
        }
    }
    Sweep { reach, rivals, sparse }
}

fn note_sparse(worst: &mut Option<(usize, f64)>, other: usize, epsilon: f64) {
    if epsilon > worst.map_or(crate::par("EPS",0.66), |(_, most)| most) {
        *worst = Some((other, epsilon));
    }
}

fn vertex<M: Manifold>(curve: &Curve<M>, k: usize, beyond_end: [f64; 2]) -> Vertex<M::Tangent> {
    match (curve.previous(k), curve.next(k)) {
        (Some(a), Some(b)) => {
            let (gap_a, gap_b) = (curve.distance(k, a), curve.distance(k, b));
            let (nearer, nearer_gap, farther_gap) = if gap_a <= gap_b { (a, gap_a, gap_b) } else { (b, gap_b, gap_a) };
            Vertex { nearer, nearer_gap, farther_gap, tangent: parabola_tangent(curve, k, a, b, gap_a, gap_b) }
        }
        (a, b) => {
            let nearer = a.or(b).unwrap_or(k);
            let beyond = beyond_end[usize::from(b.is_none())];
            let nearer_gap = curve.distance(k, nearer);
            Vertex { nearer, nearer_gap, farther_gap: beyond.max(nearer_gap), tangent: None }
        }
    }
}

/// Unit velocity at position k of the parabola through k and its neighbours: second-order accurate for uneven gaps too.
fn parabola_tangent<M: Manifold>(
    curve: &Curve<M>,
    k: usize,
    a: usize,
    b: usize,
    gap_a: f64,
    gap_b: f64,
) -> Option<M::Tangent> {
    let velocity = curve.log(k, b)? * (gap_a / gap_b) - curve.log(k, a)? * (gap_b / gap_a);
    unit(curve, k, velocity)
}

fn unit<M: Manifold>(curve: &Curve<M>, k: usize, v: M::Tangent) -> Option<M::Tangent> {
    let length = curve.manifold.norm(curve.point(k), v);
    (length > 0.0).then(|| v * (1.0 / length))
}

/// ‖v‖²/(2‖v⊥‖) with v = log_p(q); infinite without a tangent, or where q lies on the tangent up to rounding.
fn federer<M: Manifold>(curve: &Curve<M>, vertex: &Vertex<M::Tangent>, p: usize, q: usize) -> f64 {
    let (Some(tangent), Some(v)) = (vertex.tangent, curve.log(p, q)) else { return f64::INFINITY };
    normal_quotient(curve, p, tangent, v)
}

fn normal_quotient<M: Manifold>(curve: &Curve<M>, p: usize, tangent: M::Tangent, v: M::Tangent) -> f64 {
    let (m, at) = (curve.manifold, curve.point(p));
    let length = m.norm(at, v);
    let normal = m.norm(at, rejected(m, at, v, tangent));
    if normal <= 8.0 * f64::EPSILON * length { f64::INFINITY } else { length * length / (2.0 * normal) }
}

fn rejected<M: Manifold, T: Tangent>(m: &M, at: &M::Point, v: T, unit: T) -> T
where
    M: Manifold<Tangent = T>,
{
    v - unit * m.inner(at, v, unit)
}

fn disputes<M: Manifold>(curve: &Curve<M>, vertex: &Vertex<M::Tangent>, at: usize, other: usize, d: f64) -> bool {
    d < vertex.nearer_gap || curve.cosine(at, vertex.nearer, other).is_none_or(|c| c < 0.0)
}
