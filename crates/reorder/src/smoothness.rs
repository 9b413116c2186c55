//! Whether points in order look like samples of a smooth curve without noise.

use se3_geom::Manifold;

use crate::curve::Curve;

/// How rough the samples are, and how sharply the order turns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smoothness {
    /// Greatest turn from one edge to the next.
    pub(crate) turn_rad: f64,
    /// Greatest miss of a point from the parabola through the point before and the two after it, in units of what is allowed.
    pub(crate) roughness: f64,
    /// Most points in a row at which the order turns back against the turn before.
    pub(crate) zigzag: usize,
    /// Nine of ten points miss by no more than this share of the shortest gap around.
    pub(crate) noise: f64,
    /// Half of the points miss by no more than this share.
    pub(crate) usual_miss: f64,
}

/// A third derivative by length of up to this many times 1/reach² is smooth.
const THIRD_DERIVATIVE: f64 = 20.0;
/// A miss of at most this share of the shortest gap around cannot have swapped two points.
pub(crate) const MISS_TO_GAP: f64 = 0.1;

/// A miss of at most this share of the shorter gap turns nowhere: the points lie on a geodesic, up to rounding in coordinates of
/// up to a thousand million gaps.
const STRAIGHT: f64 = 1e-6;

pub(crate) fn smoothness<M: Manifold>(curve: &Curve<M>, reach: f64) -> Smoothness {
    let mut found = Smoothness { turn_rad: 0.0, roughness: 0.0, zigzag: 0, noise: 0.0, usual_miss: 0.0 };
    let mut misses = Vec::with_capacity(curve.len());
    // Whether the order turns back between a point and the next.
    let mut back = vec![false; curve.len()];
    for (k, back) in back.iter_mut().enumerate() {
        let Some((before, after)) = curve.previous(k).zip(curve.next(k)) else { continue };
        if let Some(cosine) = curve.cosine(k, before, after) {
            found.turn_rad = found.turn_rad.max(std::f64::consts::PI - cosine.clamp(-1.0, 1.0).acos());
        }
        let Some(beyond) = curve.next(after).filter(|&beyond| beyond != before) else { continue };
        let (Some(here), Some(there), Some(along)) = (bend(curve, k), bend(curve, after), curve.log(k, after)) else {
            continue;
        };
        let [g0, g1, g2] = [(before, k), (k, after), (after, beyond)].map(|(a, b)| curve.distance(a, b));
        let (p, q) = (curve.point(k), curve.point(after));
        let here = curve.manifold.transport(p, along, here);
        let third = curve.manifold.norm(q, there - here) / (g0 + g1 + g2);
        // Of the two points inside, the one that misses the parabola through the other three by more.
        let spans = g1 * (g0 * (g1 + g2)).max(g2 * (g0 + g1));
        let shortest = g0.min(g1).min(g2);
        misses.push(third * spans / shortest);
        let allowed = (THIRD_DERIVATIVE / 6.0 * spans / (reach * reach)).max(MISS_TO_GAP * shortest);
        found.roughness = found.roughness.max(third * spans / allowed);
        let turns = |bend, a: f64, b: f64| curve.manifold.norm(q, bend) * a.max(b) > STRAIGHT;
        *back = turns(here, g0, g1) && turns(there, g1, g2) && curve.manifold.inner(q, here, there) < 0.0;
    }
    found.zigzag = longest_run(&back, curve.closed);
    misses.sort_unstable_by(f64::total_cmp);
    let at_rank = |rank: usize| misses.get(rank).copied().unwrap_or(0.0);
    found.noise = at_rank(misses.len() * 9 / 10);
    found.usual_miss = at_rank(misses.len() / 2);
    found
}

/// The second divided difference at a point and its neighbours.
fn bend<M: Manifold>(curve: &Curve<M>, k: usize) -> Option<M::Tangent> {
    let (before, after) = curve.previous(k).zip(curve.next(k))?;
    let (a, b) = (curve.log(k, before)?, curve.log(k, after)?);
    let [g, h] = [before, after].map(|other| curve.distance(k, other));
    Some((b * (1.0 / h) + a * (1.0 / g)) * (1.0 / (g + h)))
}

/// Most in a row that hold; around a loop the last is followed by the first.
pub(crate) fn longest_run(holds: &[bool], closed: bool) -> usize {
    let again = if closed { holds } else { &[] };
    let run = |run: &mut usize, &holds: &bool| {
        *run = if holds { *run + 1 } else { 0 };
        Some(*run)
    };
    holds.iter().chain(again).scan(0, run).max().unwrap_or(0).min(holds.len())
}
