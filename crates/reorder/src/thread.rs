//! One sequence through all points along edges that need not make up one curve.

use std::collections::VecDeque;

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
///
/// O(n log n + p²) time for p paths, with two distances for every pair of them, and O(n) memory.
pub(crate) fn thread(drawing: &Drawing, distance: impl Fn(usize, usize) -> f64) -> Thread {
    if let Ok(Strand { rows, closed }) = drawing.curve() {
        return Thread { nodes: rows, closed, left_out: Vec::new(), joins: Vec::new() };
    }
    let count = drawing.count();
    let mut edges: Vec<(f64, [usize; 2])> = drawing.edges().iter().map(|&[a, b]| (distance(a, b), [a, b])).collect();
    edges.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (mut degree, mut joined) = (vec![0; count], UnionFind::<usize>::new(count));
    let (mut kept, mut left_out) = (Vec::new(), Vec::new());
    for (_, [a, b]) in edges {
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
    let mut nodes: VecDeque<usize> = if paths.is_empty() { VecDeque::new() } else { paths.remove(0).into() };
    // Of every path left: from its first and last node to the first and last of all that is joined.
    let ends_of = |path: &[usize]| [path[0], path[path.len() - 1]];
    let away = |near: usize, path: &[usize]| ends_of(path).map(|far| distance(near, far));
    let mut ways: Vec<[[f64; 2]; 2]> = match (nodes.front(), nodes.back()) {
        (Some(&first), Some(&last)) => paths.iter().map(|path| [away(first, path), away(last, path)]).collect(),
        _ => Vec::new(),
    };
    while !paths.is_empty() {
        let each = (0..paths.len()).flat_map(|k| [(k, 0, 0), (k, 1, 0), (k, 0, 1), (k, 1, 1)]);
        let shorter =
            |a: &(usize, usize, usize), b: &(usize, usize, usize)| ways[a.0][a.1][a.2].total_cmp(&ways[b.0][b.1][b.2]);
        let Some((k, at_back, far)) = each.min_by(shorter) else { break };
        let mut path = paths.swap_remove(k);
        ways.swap_remove(k);
        joins.push([if at_back == 1 { nodes[nodes.len() - 1] } else { nodes[0] }, ends_of(&path)[far]]);
        if far == 1 {
            path.reverse();
        }
        let end = path[path.len() - 1];
        if at_back == 1 {
            nodes.extend(path);
        } else {
            path.into_iter().for_each(|node| nodes.push_front(node));
        }
        ways.iter_mut().zip(&paths).for_each(|(way, path)| way[at_back] = away(end, path));
    }
    Thread { nodes: nodes.into(), closed: false, left_out, joins }
}
