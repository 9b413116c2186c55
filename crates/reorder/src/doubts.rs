//! Everything that may speak against an order.
//!
//! The constants were set on recorded trajectories with known order and on random harmonic curves in ℝ², ℝ³ and SE(3), sparse, uneven
//! and noisy ones among them, so that no wrong order of the recordings goes undoubted.

use petgraph::visit::EdgeRef;
use se3_geom::Manifold;

use crate::certificate::Certificate;
use crate::curve::Curve;
use crate::ordering::{Doubt, Ordering, Topology};
use crate::passes::of_passes;
use crate::sides::of_sides;
use crate::smoothness::longest_run;
use crate::spanning_tree::Tree;
use crate::sweep::{LOCAL_EPSILON, Sweep};
use crate::topology::longest_to_next;

/// A gap longer than this many times the median of the gaps around it may be a jump to another piece of the curve.
const LONG_GAP: f64 = 3.0;
/// A gap this many times shorter than that median may join two passes of a curve that comes back on itself: there, points of
/// both passes fall between each other at random distances, while one pass spaces its points smoothly.
const SHORT_GAP: f64 = 8.0;
/// How many gaps on either side of a gap are around it.
const GAP_WINDOW: usize = 5;

/// With fewer distinct points than this (but more than two, whose order is no question) some sets of points pass every test,
/// whatever they were sampled from: of random triples in a square every fourth did, of sets of five every twentieth; of eight samples
/// of an arc that were plausible, some in a hundred were wrong.
const FEWEST_POINTS: usize = 10;
/// With fewer distinct points than this, half the longest gap must be at most this share of the reach.
const FEW_IF_SPARSE: usize = 25;
const SPARSE: f64 = 0.6;
/// One doubt for every vertex where the tree branches, at its longest side edge.
pub(crate) fn of_tree(tree: &Tree) -> Vec<Doubt> {
    tree.node_indices()
        .filter(|&v| tree.neighbors(v).nth(2).is_some())
        .filter_map(|v| {
            let mut edges: Vec<_> = tree.edges(v).collect();
            edges.sort_by(|a, b| a.weight().total_cmp(b.weight()).then(a.target().cmp(&b.target())));
            let side = edges.get(2..)?.last()?;
            let why = format!(
                "the minimum spanning tree branches into {} arms at point {}: the curve crosses or touches itself there, or the \
                 samples are too sparse or too noisy",
                edges.len(),
                tree[v]
            );
            Some(Doubt { at: [tree[v], tree[side.target()]], why })
        })
        .collect()
}

/// What speaks against an order.
#[derive(Default)]
pub(crate) struct Doubts {
    /// What no other order would mend.
    pub(crate) firm: Vec<Doubt>,
    /// What may come of a wrong order or of sparse samples: agreement of many searches answers it.
    pub(crate) searchable: Vec<Doubt>,
    /// Most points in a row with such doubts: a few where the curve crosses or nearly touches itself, all where it runs beside
    /// itself.
    pub(crate) stretch: usize,
}

/// Noise across the curve, in units of the root mean square of the moves that take it away: the parabolas follow some of it. On circles
/// in the plane, with noise of a twentieth to a half of a gap, it is about 1.9 times as much.
const NOISE_TO_MOVES: f64 = 2.0;
/// Neighbours that are nearer than so many deviations of the noise in their distance may have changed places.
const SWAPPING: f64 = 3.0;
/// Places where noise may have swapped points that are written out.
const MOST_SWAPS: usize = 20;

/// Neighbours so near each other that noise may have swapped them, the nearest first. Moves take away the noise across the curve only; along
/// it there is no more of it in any one direction, and √2 times that in the distance of two points.
pub(crate) fn of_noise<M: Manifold>(manifold: &M, points: &[M::Point], found: &Ordering, moved: &[f64]) -> Vec<Doubt> {
    let mean_square = moved.iter().map(|m| m * m).sum::<f64>() / moved.len() as f64;
    let reach_of_noise = SWAPPING * std::f64::consts::SQRT_2 * NOISE_TO_MOVES * mean_square.sqrt();
    let rows = found.distinct();
    let closing = (found.topology == Topology::Closed).then(|| [rows[rows.len() - 1], rows[0]]);
    let pairs = rows.windows(2).map(|w| [w[0], w[1]]).chain(closing);
    let gaps = pairs.map(|at| (manifold.distance(&points[at[0]], &points[at[1]]), at));
    let mut near: Vec<_> = gaps.filter(|&(gap, _)| gap < reach_of_noise).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let why = |gap: f64| {
        let share = gap * SWAPPING / reach_of_noise;
        format!(
            "the gap is {share:.1} times what noise of the size of the moves changes it by: both may have changed places"
        )
    };
    near.into_iter().take(MOST_SWAPS).map(|(gap, at)| Doubt { at, why: why(gap) }).collect()
}

/// Every doubt about an order of distinct points; `repeated` tells which rows stand for several equal points.
/// Long, short and alternating gaps are no doubts where they are `explained`: dense samples that were thrown independently have them.
pub(crate) fn of_curve<M: Manifold>(
    curve: &Curve<M>,
    gaps: &[f64],
    found: &Sweep,
    repeated: &[bool],
    explained: bool,
) -> Doubts {
    let few = (3..FEWEST_POINTS).contains(&curve.len()).then(|| Doubt {
        at: curve.rows_at(0, curve.len() - 1),
        why: format!("{} distinct points are too few to tell one curve from another", curve.len()),
    });
    let passes = of_passes(curve, gaps, explained);
    let edges = (0..gaps.len()).flat_map(|k| of_gap(curve, gaps, repeated, k, explained));
    // What comes near an end may be what follows it, which no search would tell.
    let is_end = |k: usize| curve.previous(k).is_none() || curve.next(k).is_none();
    let (ends, inner): (Vec<_>, Vec<_>) = (0..curve.len()).partition(|&k| is_end(k));
    let of_vertices = |all: Vec<usize>| all.into_iter().flat_map(|k| of_vertex(curve, found, k)).collect::<Vec<_>>();
    let firm = few.into_iter().chain(passes).chain(of_sides(curve)).chain(edges).chain(of_vertices(ends)).collect();
    let in_dispute = |k: usize| found.rivals[k].is_some() || found.sparse[k].is_some();
    // A point between two that are in dispute is so too.
    let between = |k: usize| curve.previous(k).zip(curve.next(k)).is_some_and(|(a, b)| in_dispute(a) && in_dispute(b));
    let disputed: Vec<bool> = (0..curve.len()).map(|k| in_dispute(k) || between(k)).collect();
    Doubts { firm, searchable: of_vertices(inner), stretch: longest_run(&disputed, curve.closed) }
}

/// Few points that are sparse as well: of 468 random samples with plausible orders three were wrong, and all of these were such.
pub(crate) fn of_few<M: Manifold>(curve: &Curve<M>, certificate: &Certificate) -> Option<Doubt> {
    let epsilon = certificate.epsilon.filter(|&epsilon| epsilon > SPARSE)?;
    if curve.len() >= FEW_IF_SPARSE {
        return None;
    }
    let at = certificate.weakest.unwrap_or(curve.rows_at(0, curve.len() - 1));
    let count = curve.len();
    let why = format!(
        "{count} distinct points are few for a curve that bends so much between them (half a gap is {epsilon:.2} of the reach)"
    );
    Some(Doubt { at, why })
}

/// The ends of an open curve, where they come near each other, or the longest gap of a loop, where it stands out.
pub(crate) fn of_ends<M: Manifold>(curve: &Curve<M>, gaps: &[f64]) -> Doubt {
    if !curve.closed {
        let why = "the ends come so near to each other that the curve may be closed".to_owned();
        return Doubt { at: curve.rows_at(0, curve.len() - 1), why };
    }
    let longest = (0..gaps.len()).max_by(|&a, &b| gaps[a].total_cmp(&gaps[b])).unwrap_or(0);
    let why = format!("the gap is {:.1} times the longest other: the curve may be open here", longest_to_next(gaps));
    Doubt { at: curve.rows_at(longest, (longest + 1) % curve.len()), why }
}

fn of_gap<M: Manifold>(curve: &Curve<M>, gaps: &[f64], repeated: &[bool], k: usize, explained: bool) -> Vec<Doubt> {
    let at = curve.rows_at(k, (k + 1) % curve.len());
    let median = median_around(gaps, k, curve.closed).unwrap_or(gaps[k]);
    let mut reasons = Vec::new();
    if !explained && gaps[k] > LONG_GAP * median {
        reasons.push(format!("the gap is {:.1} times the median of the gaps around it", gaps[k] / median));
    }
    if !explained && gaps[k] * SHORT_GAP < median {
        let times = median / gaps[k];
        reasons
            .push(format!("the median of the gaps around is {times:.1} times this gap: the curve may come back here"));
    }
    if curve.log(k, (k + 1) % curve.len()).is_none() {
        reasons
            .push("the points lie on each other's cut locus: the shortest way between them is not unique".to_owned());
    }
    if at.iter().all(|&row| repeated[row]) {
        reasons.push("both points occur more than once: the curve may pass here twice".to_owned());
    }
    reasons.into_iter().map(|why| Doubt { at, why }).collect()
}

fn of_vertex<M: Manifold>(curve: &Curve<M>, found: &Sweep, k: usize) -> Vec<Doubt> {
    let row = curve.rows[k];
    let turn = curve.previous(k).zip(curve.next(k)).and_then(|(a, b)| {
        let degrees = 180.0 - curve.turn_back(k)?.min(1.0).acos().to_degrees();
        Some(Doubt { at: curve.rows_at(a, b), why: format!("the order turns by {degrees:.0} degrees at point {row}") })
    });
    let rival = found.rivals[k].map(|other| Doubt {
        at: curve.rows_at(k, other),
        why: format!("point {} comes as near to point {row} as a neighbour", curve.rows[other]),
    });
    let sparse = found.sparse[k].map(|(other, epsilon)| Doubt {
        at: curve.rows_at(k, other),
        why: format!(
            "the gaps at point {row} are too wide for how near the curve bends back to point {}: epsilon is {epsilon:.2}, above {LOCAL_EPSILON}",
            curve.rows[other]
        ),
    });
    [turn, rival, sparse].into_iter().flatten().collect()
}

/// The greatest ratio of a gap to the median of the gaps around it; 1 where there is no other gap.
pub(crate) fn longest_to_usual(gaps: &[f64], closed: bool) -> f64 {
    let ratio = |k: usize| Some(gaps[k] / median_around(gaps, k, closed)?);
    (0..gaps.len()).filter_map(ratio).fold(1.0, f64::max)
}

/// Upper median of up to five gaps on either side of gap k; `None` where there is no other gap.
fn median_around(gaps: &[f64], k: usize, closed: bool) -> Option<f64> {
    let n = gaps.len();
    // Around a small loop no gap may count from both sides.
    let window = if closed { GAP_WINDOW.min((n - 1) / 2) } else { GAP_WINDOW };
    let mut around: Vec<f64> = if closed {
        (1..=window).flat_map(|step| [gaps[(k + step) % n], gaps[(k + n - step) % n]]).collect()
    } else {
        let before = &gaps[k.saturating_sub(window)..k];
        let after = &gaps[k + 1..(k + 1 + window).min(n)];
        before.iter().chain(after).copied().collect()
    };
    around.sort_by(f64::total_cmp);
    around.get(around.len() / 2).copied()
}
