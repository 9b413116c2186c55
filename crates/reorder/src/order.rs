//! The order of points on any manifold, with what speaks for and against it.

use se3_geom::Manifold;

use crate::certificate::Certificate;
use crate::curve::Curve;
use crate::doubts;
use crate::error::OrderError;
use crate::independence::look_independent;
use crate::ordering::{Doubt, Method, Options, Ordering, Topology, Verdict};
use crate::recovery::{Recovery, recover};
use crate::sweep::sweep;
use crate::topology::beyond_ends;

/// Orders points sampled from a curve, by the exact minimum spanning tree under the manifold's own distance.
///
/// Where the tree is a path, that path is the order. Where it branches, the longest path is followed and side branches are walked
/// where they leave it, so that every row still comes once; the verdict is then [`Verdict::Ambiguous`]. Equal points are
/// merged first and come out next to each other. The verdict is [`Verdict::Plausible`] if nothing stands in
/// [`Ordering::doubts`]; what may stand there is listed in the [crate documentation](crate#verdict).
///
/// O(n²) time, O(n) memory. The neighbourhoods found do not depend on the order of the input, except between equal distances,
/// where smaller rows win, nor on isometries of the manifold beyond rounding.
///
/// # Errors
/// [`OrderError`]: fewer than two distinct points (three for a closed curve), coordinates that are not finite, a start that is out of
/// range or no end of the open curve.
pub fn order<M: Manifold>(manifold: &M, points: &[M::Point], options: &Options) -> Result<Ordering, OrderError> {
    Ok(judge(manifold, points, recover(manifold, points, options)?))
}

pub(crate) fn judge<M: Manifold>(manifold: &M, points: &[M::Point], recovery: Recovery) -> Ordering {
    let (certificate, doubts, verdict) = examine(manifold, points, &recovery);
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
        verdict,
        weight_stable: None,
        metres_per_radian: None,
        duplicates: groups.into_iter().filter(|group| group.len() > 1).collect(),
        certificate,
        doubts,
    }
}

fn examine<M: Manifold>(manifold: &M, points: &[M::Point], recovery: &Recovery) -> (Certificate, Vec<Doubt>, Verdict) {
    let tree = &recovery.distinct.tree;
    let mut doubts = doubts::of_tree(tree);
    if !doubts.is_empty() {
        let longest = tree.edge_weights().copied().fold(0.0, f64::max);
        return (Certificate::of_no_curve(manifold, longest), doubts, Verdict::Ambiguous);
    }
    let curve = Curve::new(manifold, points, &recovery.rows, recovery.closed);
    let gaps = curve.gaps();
    let found = sweep(&curve, beyond_ends(&gaps));
    let certificate = Certificate::of_curve(&curve, &gaps, &found);
    let certified = certificate.conditions(recovery.closed).iter().all(|condition| condition.holds);
    let mut repeated = vec![false; points.len()];
    for group in &recovery.distinct.groups {
        repeated[group[0]] = group.len() > 1;
    }
    let explained = certified && look_independent(&gaps);
    doubts.extend(doubts::of_curve(&curve, &gaps, &found, &repeated, explained));
    if recovery.unsure_of_ends {
        let why = "the ends come so near to each other that the curve may be closed".to_owned();
        doubts.push(Doubt { at: curve.rows_at(0, curve.len() - 1), why });
    }
    let verdict = match (doubts.is_empty(), certified) {
        (false, _) => Verdict::Ambiguous,
        (true, false) => Verdict::Plausible,
        (true, true) => Verdict::Certified,
    };
    (certificate, doubts, verdict)
}
