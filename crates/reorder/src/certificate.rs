//! When an order is certified.

use se3_geom::Manifold;
use serde::Serialize;

use crate::curve::Curve;
use crate::doubts::longest_to_usual;
use crate::independence::look_independent;
use crate::smoothness::{MISS_TO_GAP, Smoothness, smoothness};
use crate::sweep::{Sweep, sweep};
use crate::topology::{beyond_ends, closing_bound, longest_to_next};

/// ε = max_gap/(2·reach) up to which an order is certified: the true reach may then be half the estimate before the theorem
/// fails.
const EPSILON: f64 = 0.5;
/// The ends of a certified open curve are at least this many times the longest gap apart.
const OPENING: f64 = 4.0;
/// The closing gap of a certified loop is at most this many times the longest other gap.
const CLOSING: f64 = 2.0;
/// Where gaps do not look like those of independent points, a gap of a certified order is at most this many times those around it: a step
/// that is left out makes one of twice the others.
const LONGEST_TO_USUAL: f64 = 1.9;
/// Fewer points say too little about the curve between them.
const FEWEST_POINTS: usize = 12;
/// Samples of a smooth curve miss the parabola through their neighbours by (gap/radius)²/6 gaps or so: 0.25 of a gap is a turn of 70
/// degrees a gap, or noise of a tenth of a gap.
const CLEAN_NOISE: f64 = 0.25;
/// Noise turns back at every second point: of thirty noisy points, six in a row do as a rule.
const CLEAN_ZIGZAG: usize = 5;
/// A smooth curve turns back at an inflection, and there once.
const ZIGZAG: usize = 3;

/// Figures on how densely the points sample the curve that the order draws. Lengths are in the unit of the manifold's metric.
///
/// These are **estimates from the points**: the true curve may bend between them. They prove nothing by themselves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Certificate {
    /// The greatest distance between neighbours in the order (the closing gap of a closed curve included).
    pub max_gap: f64,
    /// Federer's reach, min over ordered pairs of ‖v‖²/(2‖v⊥‖) with v = log_p(q) and v⊥ its part normal to the tangent at p,
    /// the tangent being that of the parabola through p and its two neighbours (H. Federer, *Curvature measures*, 1959,
    /// Theorem 4.18, carried to the tangent space by log). Exact in flat space, for exact tangents and dense points.
    /// `None` where nothing is normal (a geodesic), where there are fewer than three points, or where the order is no curve.
    pub reach: Option<f64>,
    /// ε = max_gap / (2·reach): half the greatest gap in units of the reach. Below 1 is what the reconstruction theorems ask for.
    pub epsilon: Option<f64>,
    /// Radius within which geodesics are unique; `None` where it is infinite.
    pub injectivity_radius: Option<f64>,
    /// injectivity_radius − max_gap; `None` where that is infinite. Positive is what the theorems ask for. On SE(3) a gap that is
    /// long in position alone makes it negative without making any geodesic ambiguous, so that this alone is no doubt.
    pub margin: Option<f64>,
    /// max_gap/2: a curve through the points whose reach is greater than this, and whose own gaps are all shorter than twice its
    /// reach, has no other order.
    pub required_reach: f64,
    /// Number of distinct points.
    pub distinct: usize,
    /// The smaller of the reach, corrected for curvature up to (π/injectivity_radius)², and of what the injectivity radius allows:
    /// atan(√K·reach)/√K. `None` where both are infinite.
    pub usable_reach: Option<f64>,
    /// The greatest ε = gap/(2·smallest ball at either end) of a single gap.
    pub edge_epsilon: Option<f64>,
    /// Input rows of the ends of that gap.
    pub weakest: Option<[usize; 2]>,
    /// 1/κ by the samples: the smallest ball through two neighbours, tangent at one of them. No tubular neighbourhood is wider
    /// (thesis, Proposition 5.4).
    pub curvature_radius: Option<f64>,
    /// Greatest turn of the order at a point.
    pub turn_rad: f64,
    /// Greatest miss of a point from the parabola through the point before and two points after it, in units of what a smooth
    /// curve of that reach allows there. Above 1 the samples are noisy, or too sparse to show that they are not.
    pub roughness: f64,
    /// Nine of ten points miss that parabola by no more than this share of the shortest gap around: noise, or sparse samples.
    pub noise: f64,
    /// Half of the points miss it by no more than this share. Noise is everywhere and makes both shares large; a curve that is
    /// sampled too sparsely in its bends only makes the other one large.
    pub usual_miss: f64,
    /// How many points in a row turn back against the turn before. A smooth curve does so at inflections only.
    pub zigzag: usize,
    /// Distance of the ends in units of the longest gap (open), or the longest gap in units of the next (closed): the spanning tree closes
    /// a loop there.
    pub opening: Option<f64>,
    /// The greatest ratio of a gap to the median of the gaps around it; 1 where the gaps look like those of independent points, of which
    /// any may be long. Elsewhere the order may jump there: two strokes that are written one from its end to the other's end.
    pub longest_to_usual: f64,
    /// What the opening of a loop is compared with: 1.1; where the gaps look like those of independent points, what a gap of 3.5 mean gaps
    /// more than the next comes to; never more than 2. `None` for an open curve.
    pub closing_bound: Option<f64>,
}

/// One thing that a certified order needs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Condition {
    /// What is compared, in words.
    pub what: &'static str,
    /// What was found.
    pub value: f64,
    /// What it is compared with.
    pub bound: f64,
    /// Whether it holds.
    pub holds: bool,
}

impl Certificate {
    /// What a certified order needs besides the absence of doubts.
    pub fn conditions(&self, closed: bool) -> Vec<Condition> {
        let at_most = |what, value: f64, bound| Condition { what, value, bound, holds: value <= bound };
        let at_least = |what, value: f64, bound| Condition { what, value, bound, holds: value >= bound };
        let epsilon = self.usable_reach.map_or(0.0, |reach| self.required_reach / reach);
        let opening = self.opening.unwrap_or(f64::INFINITY);
        vec![
            at_least("distinct points", self.distinct as f64, FEWEST_POINTS as f64),
            at_most("half the longest gap, in units of the reach", epsilon, EPSILON),
            at_most("miss of a point from its neighbours' parabola, in units of what is allowed", self.roughness, 1.0),
            at_most("points in a row that turn back", self.zigzag as f64, ZIGZAG as f64),
            at_most(
                "longest gap, in units of the median of the gaps around it",
                self.longest_to_usual,
                LONGEST_TO_USUAL,
            ),
            if closed {
                at_most("longest gap, in units of the next", opening, self.closing_bound.unwrap_or(CLOSING))
            } else {
                at_least("distance of the ends, in units of the longest gap", opening, OPENING)
            },
        ]
    }

    /// Whether the points look like a clean sample of a smooth curve, so that searches can tell one order from another: next to
    /// none is off by so much that it could have changed places, or few enough are and no stretch turns back like noise.
    pub(crate) fn is_clean(&self) -> bool {
        let few_miss = self.noise <= CLEAN_NOISE || self.usual_miss <= MISS_TO_GAP;
        self.noise <= MISS_TO_GAP || (few_miss && self.zigzag <= CLEAN_ZIGZAG)
    }

    /// Figures where the order is no curve: nothing holds.
    pub(crate) fn of_no_curve<M: Manifold>(manifold: &M, max_gap: f64) -> Self {
        let injectivity_radius = finite(manifold.injectivity_radius());
        Self {
            max_gap,
            reach: None,
            epsilon: None,
            injectivity_radius,
            margin: injectivity_radius.map(|radius| radius - max_gap),
            required_reach: 0.5 * max_gap,
            distinct: 0,
            usable_reach: None,
            edge_epsilon: None,
            weakest: None,
            curvature_radius: None,
            turn_rad: 0.0,
            roughness: f64::MAX,
            zigzag: 0,
            noise: f64::MAX,
            usual_miss: f64::MAX,
            opening: None,
            closing_bound: None,
            longest_to_usual: f64::MAX,
        }
    }

    pub(crate) fn of_curve<M: Manifold>(curve: &Curve<M>, gaps: &[f64], found: &Sweep) -> Self {
        let max_gap = gaps.iter().copied().fold(0.0, f64::max);
        let Smoothness { turn_rad, roughness, zigzag, noise, usual_miss } = smoothness(curve, found.reach);
        let epsilons = edge_epsilons(gaps, found);
        let weakest = (0..epsilons.len()).max_by(|&a, &b| epsilons[a].total_cmp(&epsilons[b]));
        let opening = if curve.closed { longest_to_next(gaps) } else { curve.distance(curve.len() - 1, 0) / max_gap };
        Self {
            reach: finite(found.reach),
            epsilon: finite(found.reach).map(|reach| max_gap / (2.0 * reach)),
            distinct: curve.len(),
            usable_reach: finite(usable_reach(found.reach, curve.manifold.injectivity_radius())),
            edge_epsilon: weakest.map(|k| epsilons[k]),
            weakest: weakest.map(|k| curve.rows_at(k, (k + 1) % curve.len())),
            curvature_radius: finite(found.curvature_radius),
            turn_rad,
            roughness,
            zigzag,
            noise,
            usual_miss,
            opening: finite(opening),
            longest_to_usual: if look_independent(gaps, curve.closed) {
                1.0
            } else {
                longest_to_usual(gaps, curve.closed)
            },
            closing_bound: curve.closed.then(|| closing_bound(gaps).min(CLOSING)),
            ..Self::of_no_curve(curve.manifold, max_gap)
        }
    }
}

/// Whether a path of unevenly spaced points is a loop whose certificate holds. The tree leaves out a loop's longest gap, which on
/// independent points is easily half as long again as the next.
pub(crate) fn closes<M: Manifold>(path: &Curve<M>) -> bool {
    let longest = path.gaps().into_iter().fold(0.0, f64::max);
    if path.len() < FEWEST_POINTS || path.distance(0, path.len() - 1) > CLOSING * longest {
        return false;
    }
    let ring = path.joined();
    let gaps = ring.gaps();
    if !look_independent(&gaps, true) {
        return false;
    }
    let found = sweep(&ring, beyond_ends(&gaps));
    let sound = found.rivals.iter().all(Option::is_none) && found.sparse.iter().all(Option::is_none);
    // Whether it may as well be open there is another question, and a doubt.
    let certificate = Certificate { closing_bound: None, ..Certificate::of_curve(&ring, &gaps, &found) };
    sound && certificate.conditions(true).iter().all(|c| c.holds)
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// A ball that touches a line at radius R in flat space does so at atan(√K·R)/√K in a space of curvature K. Here √K = π/i with the
/// injectivity radius i, which is what a sphere has and more than SO(3) and SE(3) have; it also keeps the reach below i/2.
fn usable_reach(reach: f64, injectivity_radius: f64) -> f64 {
    if !injectivity_radius.is_finite() {
        return reach;
    }
    let root = std::f64::consts::PI / injectivity_radius;
    (root * reach).atan() / root
}

/// For every gap ε = gap/(2·smallest ball at its ends).
pub(crate) fn edge_epsilons(gaps: &[f64], found: &Sweep) -> Vec<f64> {
    let n = found.balls.len();
    gaps.iter().enumerate().map(|(k, gap)| gap / (2.0 * found.balls[k].min(found.balls[(k + 1) % n]))).collect()
}
