//! Everything that may speak against an order.

use petgraph::visit::EdgeRef;
use se3_geom::Manifold;

use crate::curve::Curve;
use crate::ordering::Doubt;
use crate::spanning_tree::Tree;
use crate::sweep::LOCAL_EPSILON;

/// A gap longer than this many times the median of the gaps around it is doubted.
const GAP_TO_LOCAL_MEDIAN: f64 = 3.0;
/// How many gaps on either side of a gap are around it.
const GAP_WINDOW: usize = 5;

/// One doubt for every vertex where the tree branches, at its longest side edge.
pub(crate) fn branches(tree: &Tree) -> Vec<Doubt> {
    tree.node_indices()
        .filter_map(|v| {
            let mut edges: Vec<_> = tree.edges(v).collect();
            edges.sort_by(|a, b| a.weight().total_cmp(b.weight()).then(a.target().cmp(&b.target())));
            let side = edges.get(2..)?.last()?;
            let why = format!(
                "the minimum spanning tree branches here into {} arms, so that the curve crosses or touches itself, or the samples are too sparse or too noisy",
                edges.len()
            );
            Some(Doubt { at: [tree[v], tree[side.target()]], why })
        })
        .collect()
}

/// Gaps much longer than those around them: the curve may come from elsewhere, or be two curves.
pub(crate) fn gaps<M: Manifold>(curve: &Curve<M>, gaps: &[f64]) -> Vec<Doubt> {
    (0..gaps.len())
        .filter_map(|k| {
            let mut around = around(gaps, k, curve.closed);
            let middle = around.len() / 2;
            let (_, &mut median, _) = (!around.is_empty()).then(|| around.select_nth_unstable_by(middle, f64::total_cmp))?;
            (gaps[k] > crate::par("GAP",3.0) * median || gaps[k] * crate::par("LOW",1e9) < median).then(|| Doubt {
                at: curve.rows_at(k, (k + 1) % curve.len()),
                why: format!("the gap {:.4} is {:.1} times the median gap around it", gaps[k], gaps[k] / median),
            })
        })
        .collect()
}

fn around(gaps: &[f64], k: usize, closed: bool) -> Vec<f64> {
    let n = gaps.len();
    let reach = GAP_WINDOW.min((n - 1) / 2).max(usize::from(n > 1));
    (1..=reach)
        .flat_map(|step| {
            let (before, after) = (k.checked_sub(step), k + step);
            if closed {
                [Some((k + n - step) % n), Some(after % n)]
            } else {
                [before, (after < n).then_some(after)]
            }
        })
        .flatten()
        .map(|j| gaps[j])
        .collect()
}

/// Points where the order turns by 90° or more.
pub(crate) fn turns<M: Manifold>(curve: &Curve<M>) -> Vec<Doubt> {
    (0..curve.len())
        .filter_map(|k| {
            let (a, b) = (curve.previous(k)?, curve.next(k)?);
            let why = match curve.cosine(k, a, b) {
                None => "the points lie on each other's cut locus, so that the way between them is not unique".to_owned(),
                Some(c) if c >= -crate::par("TURN",0.0) => {
                    let turn = 180.0 - c.min(1.0).acos().to_degrees();
                    format!("the order turns by {turn:.0} degrees at point {}", curve.rows[k])
                }
                Some(_) => return None,
            };
            Some(Doubt { at: curve.rows_at(a, b), why })
        })
        .collect()
}

/// Points that come nearer than neighbours in the order.
pub(crate) fn rivals<M: Manifold>(curve: &Curve<M>, rivals: &[Option<usize>]) -> Vec<Doubt> {
    rivals
        .iter()
        .enumerate()
        .filter_map(|(k, rival)| {
            let other = (*rival)?;
            let why = format!("point {} comes as near as a neighbour of point {}", curve.rows[other], curve.rows[k]);
            Some(Doubt { at: curve.rows_at(k, other), why })
        })
        .collect()
}

/// Gaps beyond which the shortest way is not unique.
pub(crate) fn half_turns<M: Manifold>(curve: &Curve<M>, gaps: &[f64]) -> Vec<Doubt> {
    let radius = curve.manifold.injectivity_radius();
    (0..gaps.len())
        .filter(|&k| gaps[k] >= radius)
        .map(|k| Doubt {
            at: curve.rows_at(k, (k + 1) % curve.len()),
            why: format!("the gap {:.4} reaches the injectivity radius {radius:.4}", gaps[k]),
        })
        .collect()
}

/// Neighbours that both come more than once: the stretch between them may have been passed twice rather than dwelt on.
pub(crate) fn repeats<M: Manifold>(curve: &Curve<M>, repeated: impl Fn(usize) -> bool) -> Vec<Doubt> {
    (0..curve.len())
        .filter_map(|k| {
            let next = curve.next(k)?;
            (repeated(curve.rows[k]) && repeated(curve.rows[next])).then(|| Doubt {
                at: curve.rows_at(k, next),
                why: "both points occur more than once, so that the curve may pass here twice".to_owned(),
            })
        })
        .collect()
}

/// Points where the samples are too sparse for the bend, or for the distance to another strand.
pub(crate) fn sparse<M: Manifold>(curve: &Curve<M>, sparse: &[Option<(usize, f64)>]) -> Vec<Doubt> {
    sparse
        .iter()
        .enumerate()
        .filter_map(|(k, worst)| {
            let (other, epsilon) = (*worst)?;
            let why = format!(
                "the gaps at point {} are too wide for the bend to point {}: epsilon {epsilon:.2} is above {LOCAL_EPSILON}",
                curve.rows[k], curve.rows[other]
            );
            Some(Doubt { at: curve.rows_at(k, other), why })
        })
        .collect()
}
