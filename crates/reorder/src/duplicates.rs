//! Equal points merged, with every input row kept.

use petgraph::graph::NodeIndex;
use petgraph::unionfind::UnionFind;
use petgraph::visit::EdgeRef;
use se3_geom::Manifold;

use crate::spanning_tree::Tree;

/// Two points nearer than this share of the longest tree edge are one point. Distances come from differences of coordinates
/// that are rounded to ε/2 each, and go through a square root or an arcsine: a few ε of the data's extent is what equal points
/// can differ by, and the longest tree edge is never more than that extent.
pub(crate) const ROUNDING_SHARE: f64 = 4.0 * f64::EPSILON;

/// Distinct points: `groups[k]` are the rows of node k of `tree`, ascending, and `groups[k][0]` stands for them.
pub(crate) struct Distinct {
    pub(crate) groups: Vec<Vec<usize>>,
    group_of_row: Vec<usize>,
    pub(crate) tree: Tree,
}

/// Contracts the edges of rounding length. What is left is the minimum spanning tree of the distinct points.
pub(crate) fn merge<M: Manifold>(manifold: &M, points: &[M::Point], tree: Tree) -> Distinct {
    let longest = tree.edge_weights().copied().fold(0.0, f64::max);
    let is_rounding = |length: f64| length <= ROUNDING_SHARE * longest;
    if !tree.edge_weights().any(|length| is_rounding(*length)) {
        let rows = 0..points.len();
        return Distinct { groups: rows.clone().map(|row| vec![row]).collect(), group_of_row: rows.collect(), tree };
    }
    let mut merged = UnionFind::<usize>::new(points.len());
    for edge in tree.edge_references().filter(|e| is_rounding(*e.weight())) {
        merged.union(edge.source().index(), edge.target().index());
    }

    let mut group_of_root = vec![usize::MAX; points.len()];
    let mut group_of_row = Vec::with_capacity(points.len());
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for row in 0..points.len() {
        let root = merged.find_mut(row);
        if group_of_root[root] == usize::MAX {
            group_of_root[root] = groups.len();
            groups.push(Vec::new());
        }
        groups[group_of_root[root]].push(row);
        group_of_row.push(group_of_root[root]);
    }

    let mut contracted = Tree::with_capacity(groups.len(), groups.len().saturating_sub(1));
    for group in &groups {
        contracted.add_node(group[0]);
    }
    for edge in tree.edge_references().filter(|e| !is_rounding(*e.weight())) {
        let [a, b] = [edge.source(), edge.target()].map(|v| group_of_row[v.index()]);
        let length = manifold.distance(&points[groups[a][0]], &points[groups[b][0]]);
        contracted.add_edge(NodeIndex::new(a), NodeIndex::new(b), length);
    }
    Distinct { groups, group_of_row, tree: contracted }
}

impl Distinct {
    /// The node of a row.
    pub(crate) fn node_of(&self, row: usize) -> NodeIndex {
        NodeIndex::new(self.group_of_row[row])
    }
}
