//! The order itself: tree, topology, start.

use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use se3_geom::Manifold;
use tracing::debug_span;

use crate::certificate::closes;
use crate::curve::Curve;
use crate::duplicates::{Distinct, merge};
use crate::error::OrderError;
use crate::ordering::{Options, TopologyChoice};
use crate::spanning_tree::{Tree, minimum_spanning_tree};
use crate::topology::{Closing, closing, may_be_open, rotate_to};
use crate::walk::{far_end, is_path, walk};

/// Distinct points in order: `rows` holds the first row of every group of equal points.
pub(crate) struct Recovery {
    pub(crate) distinct: Distinct,
    pub(crate) rows: Vec<usize>,
    pub(crate) closed: bool,
    /// The topology was told from the points, and they leave it open.
    pub(crate) unsure_of_ends: bool,
}

pub(crate) fn recover<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    options: &Options,
    wanted_start: Option<usize>,
) -> Result<Recovery, OrderError> {
    let distinct = distinct_points(manifold, points, options.topology, wanted_start)?;
    let tree = &distinct.tree;
    let mut rows = rows_along(tree, far_end(tree));
    let path = Curve::new(manifold, points, &rows, false);
    let ends = closing(&path);
    let closed = match options.topology {
        TopologyChoice::Auto => ends == Closing::Meets || (is_path(tree) && closes(&path)),
        TopologyChoice::Open => false,
        TopologyChoice::Closed => true,
    };
    let unsure = if closed { may_be_open(&path.joined().gaps()) } else { ends == Closing::Near };
    let unsure_of_ends = options.topology == TopologyChoice::Auto && unsure;
    let start = options.start.map(|row| (row, distinct.node_of(row)));
    match start {
        _ if closed => rotate_to(&mut rows, start.map_or(0, |(_, node)| tree[node])),
        Some((_, node)) if tree.neighbors(node).count() == 1 => rows = rows_along(tree, node),
        Some((start, _)) => {
            return Err(OrderError::start_not_an_end(start, [rows[0], rows[rows.len() - 1]]));
        }
        None if rows[0] > rows[rows.len() - 1] => rows = rows_along(tree, distinct.node_of(rows[rows.len() - 1])),
        None => {}
    }
    Ok(Recovery { distinct, rows, closed, unsure_of_ends })
}

impl Recovery {
    /// For every row the first row of those that hold the same point.
    pub(crate) fn names(&self, count: usize) -> Vec<usize> {
        let mut names = vec![0; count];
        for group in &self.distinct.groups {
            for &row in group {
                names[row] = group[0];
            }
        }
        names
    }
    /// Which rows stand for several equal points.
    pub(crate) fn repeated(&self, count: usize) -> Vec<bool> {
        let mut repeated = vec![false; count];
        for group in &self.distinct.groups {
            repeated[group[0]] = group.len() > 1;
        }
        repeated
    }
    /// The edges of the tree as (smaller row, greater row), ascending.
    pub(crate) fn tree_edges(&self) -> Vec<(usize, usize)> {
        let tree = &self.distinct.tree;
        let rows = tree.edge_references().map(|edge| (tree[edge.source()], tree[edge.target()]));
        let mut edges: Vec<_> = rows.map(|(a, b)| (a.min(b), a.max(b))).collect();
        edges.sort_unstable();
        edges
    }
    /// The neighbours, or, where the tree branches, its edges: whom its walk puts beside each other depends on the end it starts from.
    pub(crate) fn bonds(&self) -> Vec<(usize, usize)> {
        let tree = &self.distinct.tree;
        let branches = tree.node_indices().any(|node| tree.neighbors(node).count() > 2);
        if branches { self.tree_edges() } else { self.edges() }
    }
    /// The neighbours as (smaller row, greater row), ascending.
    pub(crate) fn edges(&self) -> Vec<(usize, usize)> {
        let closing = self.rows.last().zip(self.rows.first()).filter(|_| self.closed);
        let consecutive = self.rows.iter().zip(&self.rows[1..]);
        let mut edges: Vec<_> = consecutive.chain(closing).map(|(&a, &b)| (a.min(b), a.max(b))).collect();
        edges.sort_unstable();
        edges
    }
}

/// Equal points merged, with the minimum spanning tree of the distinct ones.
pub(crate) fn distinct_points<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    topology: TopologyChoice,
    start: Option<usize>,
) -> Result<Distinct, OrderError> {
    let count = points.len();
    let needed = if topology == TopologyChoice::Closed { 3 } else { 2 };
    if count < needed {
        return Err(OrderError::TooFewPoints { count, needed });
    }
    if let Some(start) = start.filter(|&start| start >= count) {
        return Err(OrderError::StartOutOfRange { start, count });
    }
    let _phase = debug_span!("spanning tree").entered();
    let merged = merge(manifold, points, minimum_spanning_tree(manifold, points)?);
    match merged.groups.len() {
        1 => Err(OrderError::AllEqual { count }),
        distinct if distinct < needed => Err(OrderError::TooFewDistinct { count, distinct, needed }),
        _ => Ok(merged),
    }
}

pub(crate) fn rows_along(tree: &Tree, root: NodeIndex) -> Vec<usize> {
    walk(tree, root).into_iter().map(|node| tree[node]).collect()
}
