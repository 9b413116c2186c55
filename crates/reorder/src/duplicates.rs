//! Equal points merged, with every input row kept.

use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use se3_geom::Manifold;

use crate::equality::Equality;
use crate::ordering::Doubt;
use crate::spanning_tree::Tree;

/// With so few distinct points left, what was merged may be the whole curve.
const FEW: usize = 10;

/// Distinct points: `groups[k]` are the rows of node k of `tree`, ascending, and `groups[k][0]` stands for them.
pub(crate) struct Distinct {
    pub(crate) groups: Vec<Vec<usize>>,
    group_of_row: Vec<usize>,
    pub(crate) tree: Tree,
    /// What speaks against taking the rows of a group for one point.
    pub(crate) doubt: Option<Doubt>,
}

/// Contracts the edges between points that are equal up to rounding. What is left is the minimum spanning tree of the distinct points.
///
/// Rounding does not add up: every point of a group is within rounding of one of them, and a row of points each within rounding of
/// the next falls into several groups, which is a doubt.
pub(crate) fn merge<M: Manifold>(manifold: &M, points: &[M::Point], tree: Tree) -> Distinct {
    let mut equality = Equality::new(manifold);
    let mut are_one = |a: usize, b: usize| {
        manifold.distance(&points[a], &points[b]) == 0.0 || equality.is_rounding(&points[a], &points[b])
    };
    let is_rounding: Vec<bool> =
        tree.edge_references().map(|e| are_one(e.source().index(), e.target().index())).collect();
    if !is_rounding.contains(&true) {
        let rows = 0..points.len();
        let groups = rows.clone().map(|row| vec![row]).collect();
        return Distinct { groups, group_of_row: rows.collect(), tree, doubt: None };
    }

    let mut chained = None;
    // The row that a group is spread around.
    let mut centre_of = vec![usize::MAX; points.len()];
    for first in 0..points.len() {
        if centre_of[first] != usize::MAX {
            continue;
        }
        centre_of[first] = first;
        let mut reached = vec![first];
        while let Some(row) = reached.pop() {
            for edge in tree.edges(NodeIndex::new(row)).filter(|edge| is_rounding[edge.id().index()]) {
                let other = edge.target().index();
                if centre_of[other] != usize::MAX {
                    continue;
                }
                let joins = are_one(centre_of[row], other);
                centre_of[other] = if joins { centre_of[row] } else { other };
                if !joins {
                    chained = chained.or(Some([row, other]));
                }
                reached.push(other);
            }
        }
    }

    let mut group_of_centre = vec![usize::MAX; points.len()];
    let mut group_of_row = Vec::with_capacity(points.len());
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (row, &centre) in centre_of.iter().enumerate() {
        if group_of_centre[centre] == usize::MAX {
            group_of_centre[centre] = groups.len();
            groups.push(Vec::new());
        }
        groups[group_of_centre[centre]].push(row);
        group_of_row.push(group_of_centre[centre]);
    }

    let mut contracted = Tree::with_capacity(groups.len(), groups.len().saturating_sub(1));
    for group in &groups {
        contracted.add_node(group[0]);
    }
    for edge in tree.edge_references() {
        let [a, b] = [edge.source(), edge.target()].map(|v| group_of_row[v.index()]);
        if a != b {
            let length = manifold.distance(&points[groups[a][0]], &points[groups[b][0]]);
            contracted.add_edge(NodeIndex::new(a), NodeIndex::new(b), length);
        }
    }
    let few = if groups.len() < FEW { groups.as_slice() } else { &[] };
    let inexact = few.iter().flat_map(|group| group[1..].iter().map(|&row| [group[0], row]));
    let inexact = inexact.into_iter().find(|&[a, b]| !equality.is_exact(&points[a], &points[b]));
    let doubt = chained.or(inexact).map(|at| Doubt {
        at,
        why: "these two differ by no more than rounding, and what order such points have is not told".to_owned(),
    });
    Distinct { groups, group_of_row, tree: contracted, doubt }
}

impl Distinct {
    /// The node of a row.
    pub(crate) fn node_of(&self, row: usize) -> NodeIndex {
        NodeIndex::new(self.group_of_row[row])
    }
}
