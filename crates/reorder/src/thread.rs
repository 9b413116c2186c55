//! One sequence through all points along edges that need not make up one curve.

use petgraph::unionfind::UnionFind;

use crate::drawing::{Drawing, Strand};

/// A sequence of all nodes, and where it departs from the edges.
pub(crate) struct Thread {
    pub(crate) nodes: Vec<usize>,
    pub(crate) closed: bool,
    /// Edges that are not followed, since two shorter ones lead on at an end of theirs.
    pub(crate) left_out: Vec<[usize; 2]>,
    /// Neighbours that no edge joins.
    pub(crate) joins: Vec<[usize; 2]>,
}

/// The curve itself, where the edges make up one. Elsewhere the shortest edges that no branch and no small loop comes of; the
/// paths they make up are joined from end to nearest end, starting with the path of the smallest node and going on at either side.
pub(crate) fn thread(drawing: &Drawing, distance: impl Fn(usize, usize) -> f64) -> Thread {
    if let Ok(Strand { rows, closed }) = drawing.curve() {
        return Thread { nodes: rows, closed, left_out: Vec::new(), joins: Vec::new() };
    }
    let count = drawing.count();
    let mut edges: Vec<[usize; 2]> = drawing.edges().to_vec();
    edges.sort_by(|a, b| distance(a[0], a[1]).total_cmp(&distance(b[0], b[1])).then(a.cmp(b)));
    let (mut degree, mut joined) = (vec![0; count], UnionFind::<usize>::new(count));
    let (mut kept, mut left_out) = (Vec::new(), Vec::new());
    for [a, b] in edges {
        if degree[a] == 2 || degree[b] == 2 {
            left_out.push([a, b]);
        } else if joined.union(a, b) {
            degree[a] += 1;
            degree[b] += 1;
            kept.push([a, b]);
        }
    }
    let mut paths: Vec<Vec<usize>> =
        Drawing::new(count, kept).strands().unwrap_or_default().into_iter().map(|strand| strand.rows).collect();
    let mut joins = Vec::new();
    let mut nodes = if paths.is_empty() { Vec::new() } else { paths.remove(0) };
    while !paths.is_empty() {
        let ends = [nodes[0], nodes[nodes.len() - 1]];
        let ways = paths.iter().enumerate().flat_map(|(k, path)| {
            [path[0], path[path.len() - 1]].into_iter().flat_map(move |far| ends.map(|near| (k, near, far)))
        });
        let Some((k, near, far)) = ways.min_by(|a, b| distance(a.1, a.2).total_cmp(&distance(b.1, b.2))) else { break };
        joins.push([near, far]);
        let mut path = paths.swap_remove(k);
        if near != ends[1] {
            nodes.reverse();
        }
        if path[0] != far {
            path.reverse();
        }
        nodes.extend(path);
    }
    Thread { nodes, closed: false, left_out, joins }
}
