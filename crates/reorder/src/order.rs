//! The order of points on any manifold.

use petgraph::graph::NodeIndex;
use se3_geom::Manifold;

use crate::curve::Curve;
use crate::doubts;
use crate::duplicates::{Distinct, merge};
use crate::error::OrderError;
use crate::ordering::{Certificate, Doubt, Method, Options, Ordering, Topology, TopologyChoice, Verdict};
use crate::spanning_tree::{Tree, minimum_spanning_tree};
use crate::sweep::sweep;
use crate::topology::{Closing, closing, ends_beyond, rotate_to};
use crate::walk::{far_end, walk};

pub fn order<M: Manifold>(manifold: &M, points: &[M::Point], options: &Options) -> Result<Ordering, OrderError> {
    let distinct = distinct_points(manifold, points, options)?;
    let start = options.start.map(|row| node_of(&distinct, row));
    let mut rows = rows_along(&distinct.tree, far_end(&distinct.tree));
    let ends = closing(&Curve::new(manifold, points, &rows, false));
    let closed = match options.topology {
        TopologyChoice::Auto => ends == Closing::Meets,
        TopologyChoice::Open => false,
        TopologyChoice::Closed => true,
    };
    if closed {
        rotate_to(&mut rows, start.map_or(0, |node| distinct.tree[node]));
    } else if let Some(node) = start {
        if distinct.tree.neighbors(node).count() > 1 {
            let ends = [rows[0], rows[rows.len() - 1]];
            return Err(OrderError::StartNotAnEnd { start: options.start.unwrap_or_default(), ends });
        }
        rows = rows_along(&distinct.tree, node);
    } else if rows[0] > rows[rows.len() - 1] {
        rows.reverse();
    }

    let curve = Curve::new(manifold, points, &rows, closed);
    let unsure_of_ends = options.topology == TopologyChoice::Auto && ends == Closing::Near;
    let (certificate, doubts) = judge(&curve, &distinct, unsure_of_ends);
    let repeated: Vec<Vec<usize>> = distinct.groups.iter().filter(|g| g.len() > 1).cloned().collect();
    let order: Vec<usize> = {
        let mut group_of_row = vec![0; points.len()];
        distinct.groups.iter().enumerate().for_each(|(k, group)| group_of_row[group[0]] = k);
        rows.iter().flat_map(|&row| &distinct.groups[group_of_row[row]]).copied().collect()
    };
    Ok(Ordering {
        n: points.len(),
        components: vec![order.clone()],
        order,
        topology: if closed { Topology::Closed } else { Topology::Open },
        method: Method::Mst,
        verdict: if doubts.is_empty() { Verdict::Plausible } else { Verdict::Ambiguous },
        weight_stable: None,
        metres_per_radian: None,
        duplicates: repeated,
        certificate,
        doubts,
    })
}

fn distinct_points<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    options: &Options,
) -> Result<Distinct, OrderError> {
    let count = points.len();
    let needed = if options.topology == TopologyChoice::Closed { 3 } else { 2 };
    if count < needed {
        return Err(OrderError::TooFewPoints { count, needed });
    }
    if let Some(start) = options.start.filter(|&start| start >= count) {
        return Err(OrderError::StartOutOfRange { start, count });
    }
    let merged = merge(manifold, points, &minimum_spanning_tree(manifold, points)?);
    match merged.groups.len() {
        1 => Err(OrderError::AllEqual { count }),
        distinct if distinct < needed => Err(OrderError::TooFewDistinct { count, distinct, needed }),
        _ => Ok(merged),
    }
}

fn node_of(distinct: &Distinct, row: usize) -> NodeIndex {
    NodeIndex::new(distinct.groups.iter().position(|group| group.contains(&row)).unwrap_or(0))
}

fn rows_along(tree: &Tree, root: NodeIndex) -> Vec<usize> {
    walk(tree, root).into_iter().map(|node| tree[node]).collect()
}

fn judge<M: Manifold>(curve: &Curve<M>, distinct: &Distinct, unsure_of_ends: bool) -> (Certificate, Vec<Doubt>) {
    let tree_doubts = doubts::branches(&distinct.tree);
    if !tree_doubts.is_empty() {
        let max_gap = distinct.tree.edge_weights().copied().fold(0.0, f64::max);
        return (certificate(curve.manifold, max_gap, f64::INFINITY), tree_doubts);
    }
    let gaps = curve.gaps();
    let found = sweep(curve, ends_beyond(&gaps));
    let mut repeated = vec![false; curve.rows.iter().max().map_or(0, |m| m + 1)];
    distinct.groups.iter().for_each(|group| repeated[group[0]] = group.len() > 1);

    let mut doubts = doubts::gaps(curve, &gaps);
    doubts.extend(doubts::half_turns(curve, &gaps));
    doubts.extend(doubts::turns(curve));
    doubts.extend(doubts::rivals(curve, &found.rivals));
    doubts.extend(doubts::sparse(curve, &found.sparse));
    doubts.extend(doubts::repeats(curve, |row| repeated[row]));
    if unsure_of_ends {
        doubts.push(Doubt {
            at: curve.rows_at(0, curve.len() - 1),
            why: "the ends come so near that the curve may be closed".to_owned(),
        });
    }
    let max_gap = gaps.iter().copied().fold(0.0, f64::max);
    (certificate(curve.manifold, max_gap, found.reach), doubts)
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
