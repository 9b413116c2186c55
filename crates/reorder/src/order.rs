//! The order of points on any manifold, with what speaks for and against it.

use se3_geom::Manifold;

use crate::agreement::{Variant, examine_sequence};
use crate::curve::Curve;
use crate::doubts;
use crate::error::OrderError;
use crate::ordering::{Certificate, Doubt, Method, MethodChoice, Options, Ordering, Repair, Repaired, Topology, Verdict};
use crate::recovery::{Recovery, recover};
use crate::repair::{Sequence, TURNING, sequence};
use crate::sweep::sweep;
use crate::topology::{beyond_ends, rotate_to};
use crate::tour::Problem;

/// Sets of more points are repaired only on demand: the searches would take minutes.
pub const MOST_REPAIRED_UNASKED: usize = 3000;

/// Orders points sampled from a curve, by the exact minimum spanning tree under the manifold's own distance, and by a short path
/// of little turning where that tree is no order to trust.
///
/// Where the tree is a path that nothing speaks against, that path is the order, and the verdict [`Verdict::Plausible`]. Elsewhere,
/// unless [`Options::repair`] says otherwise, the order is repaired: see [`Method::Repaired`]. What may stand in
/// [`Ordering::doubts`] is listed in the [crate documentation](crate#verdict).
///
/// O(n²) time, O(n) memory. The neighbourhoods found do not depend on the order of the input, except between equal distances,
/// where smaller rows win, nor on isometries of the manifold beyond rounding.
///
/// # Errors
/// [`OrderError`]: fewer than two distinct points (three for a closed curve), coordinates that are not finite, a start that is out of
/// range or no end of the open curve.
pub fn order<M: Manifold>(manifold: &M, points: &[M::Point], options: &Options) -> Result<Ordering, OrderError> {
    order_among(manifold, &[], points, options)
}

/// As [`order`]; the order must be the same under every variant of the metric.
pub(crate) fn order_among<M: Manifold>(
    manifold: &M,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Ordering, OrderError> {
    let wanted_start = options.start;
    let recovery = recover(manifold, points, &Options { start: None, ..*options })?;
    let (certificate, mut doubts) = examine(manifold, points, &recovery);
    let of_weight = crate::agreement::of_trees(&recovery, variants, points, options)?;
    let weighed = !variants.is_empty();
    let weight_stable = of_weight.is_empty();
    doubts.extend(of_weight);
    let repairable = match options.repair {
        Repair::Auto => points.len() <= MOST_REPAIRED_UNASKED,
        Repair::Always => true,
        Repair::Off => false,
    };
    if doubts.is_empty() || !repairable || options.method != MethodChoice::Auto {
        let recovery = match wanted_start {
            Some(_) => recover(manifold, points, options)?,
            None => recovery,
        };
        return Ok(answer(points, recovery, weighed.then_some(weight_stable), certificate, doubts));
    }
    let before = recovery.tree_edges();
    let problem = Problem::new(manifold, points);
    let mut found = sequence(manifold, points, &problem, TURNING, &[], options.topology);
    let name = recovery.names(points.len());
    let (stable, doubts) = examine_sequence(manifold, variants, points, &problem, &found, &before, &name, options)?;
    turn_to_start(&mut found, &name, wanted_start)?;
    let curve = Curve::new(manifold, points, &found.rows, found.closed);
    let max_gap = curve.gaps().into_iter().fold(0.0, f64::max);
    let after = found.edges(&name);
    let repaired = Repaired {
        dropped: missing(&before, &after),
        added: missing(&after, &before),
    };
    let mut answer = answer(points, recovery, weighed.then_some(stable), self::certificate(manifold, max_gap, f64::INFINITY), doubts);
    answer.order.clone_from(&found.rows);
    answer.components = vec![found.rows];
    answer.topology = if found.closed { Topology::Closed } else { Topology::Open };
    answer.method = Method::Repaired;
    answer.repaired = Some(repaired);
    Ok(answer)
}

/// Edges of `these` that are not among `those`; both ascending.
fn missing(these: &[(usize, usize)], those: &[(usize, usize)]) -> Vec<[usize; 2]> {
    these.iter().filter(|edge| those.binary_search(edge).is_err()).map(|&(a, b)| [a, b]).collect()
}

fn turn_to_start(found: &mut Sequence, name: &[usize], start: Option<usize>) -> Result<(), OrderError> {
    let (first, last) = (found.rows[0], found.rows[found.rows.len() - 1]);
    match start {
        _ if found.closed => rotate_to(&mut found.rows, start.unwrap_or(0)),
        Some(start) if name[start] == name[first] => {}
        Some(start) if name[start] == name[last] => found.rows.reverse(),
        Some(start) => return Err(OrderError::StartNotAnEnd { start, ends: [first, last] }),
        None if first > last => found.rows.reverse(),
        None => {}
    }
    Ok(())
}

fn answer<P>(
    points: &[P],
    recovery: Recovery,
    weight_stable: Option<bool>,
    certificate: Certificate,
    doubts: Vec<Doubt>,
) -> Ordering {
    let groups = recovery.distinct.groups;
    let mut group_of = vec![0; points.len()];
    for (k, group) in groups.iter().enumerate() {
        group_of[group[0]] = k;
    }
    let order: Vec<usize> = recovery.rows.iter().flat_map(|&row| &groups[group_of[row]]).copied().collect();
    Ordering {
        n: points.len(),
        components: vec![order.clone()],
        order,
        topology: if recovery.closed { Topology::Closed } else { Topology::Open },
        method: Method::Mst,
        verdict: if doubts.is_empty() { Verdict::Plausible } else { Verdict::Ambiguous },
        weight_stable,
        metres_per_radian: None,
        duplicates: groups.into_iter().filter(|group| group.len() > 1).collect(),
        certificate,
        repaired: None,
        doubts,
    }
}

fn examine<M: Manifold>(manifold: &M, points: &[M::Point], recovery: &Recovery) -> (Certificate, Vec<Doubt>) {
    let tree = &recovery.distinct.tree;
    let mut doubts = doubts::of_tree(tree);
    if !doubts.is_empty() {
        let longest = tree.edge_weights().copied().fold(0.0, f64::max);
        return (certificate(manifold, longest, f64::INFINITY), doubts);
    }
    let curve = Curve::new(manifold, points, &recovery.rows, recovery.closed);
    let gaps = curve.gaps();
    let found = sweep(&curve, beyond_ends(&gaps));
    let mut repeated = vec![false; points.len()];
    for group in &recovery.distinct.groups {
        repeated[group[0]] = group.len() > 1;
    }
    doubts.extend(doubts::of_curve(&curve, &gaps, &found, &repeated));
    if recovery.unsure_of_ends {
        doubts.push(doubts::of_ends(curve.rows_at(0, curve.len() - 1)));
    }
    let max_gap = gaps.iter().copied().fold(0.0, f64::max);
    (certificate(manifold, max_gap, found.reach), doubts)
}

fn certificate<M: Manifold>(manifold: &M, max_gap: f64, reach: f64) -> Certificate {
    let finite = |x: f64| x.is_finite().then_some(x);
    let injectivity_radius = finite(manifold.injectivity_radius());
    Certificate {
        max_gap,
        reach: finite(reach),
        epsilon: finite(reach).map(|reach| max_gap / (2.0 * reach)),
        injectivity_radius,
        margin: injectivity_radius.map(|radius| radius - max_gap),
    }
}
