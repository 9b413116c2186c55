//! A balanced search tree over points of a flat and a round factor.

use std::cmp::Ordering;

use super::vectorised::greater;

/// Points in a leaf: a whole number of vectors of any width.
pub(super) const LANES: usize = 16;
/// Subtrees of fewer points are built on one thread.
const SERIAL: usize = 1 << 13;
/// Marks a link that names a leaf, not a node.
const LEAF: u32 = 1 << 31;

/// A point with the input row that it stands for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record<const F: usize, const R: usize> {
    pub(super) flat: [f64; F],
    pub(super) round: [f64; R],
    pub(super) row: u32,
}

/// The points of a leaf by coordinate. Lanes that hold no point are at infinity: no distance to them is a number that precedes
/// any.
#[derive(Debug, Clone)]
pub(super) struct Leaf<const F: usize, const R: usize> {
    pub(super) flat: [[f64; LANES]; F],
    pub(super) round: [[f64; LANES]; R],
}

/// The tight box, [least, greatest] of each coordinate, around the points below a node.
#[derive(Debug, Clone)]
pub(super) struct Cell<const F: usize, const R: usize> {
    pub(super) flat: [[f64; 2]; F],
    pub(super) round: [[f64; 2]; R],
}

/// Nodes in preorder: the left child of node k is k + 1. Slot s is lane s mod 16 of leaf ⌊s/16⌋; all leaves but the last are
/// full.
pub(super) struct KdTree<const F: usize, const R: usize> {
    pub(super) leaves: Vec<Leaf<F, R>>,
    /// Node of each leaf.
    pub(super) node_of_leaf: Vec<u32>,
    /// Input row of each slot.
    pub(super) rows: Vec<u32>,
    pub(super) cells: Vec<Cell<F, R>>,
    links: Vec<u32>,
}

/// What hangs below a node.
pub(super) enum Below {
    Leaf(usize),
    Nodes([usize; 2]),
}

impl<const F: usize, const R: usize> KdTree<F, R> {
    /// Splits at the median of the widest coordinate, where a squared unit of a flat and a round coordinate counts `weights`.
    ///
    /// There must be a record, and fewer than 2³¹ of them.
    pub(super) fn new(mut records: Vec<Record<F, R>>, weights: [f64; 2]) -> Self {
        let leaf_count = records.len().div_ceil(LANES);
        let node_count = 2 * leaf_count - 1;
        let mut leaves =
            vec![Leaf { flat: [[f64::INFINITY; LANES]; F], round: [[f64::INFINITY; LANES]; R] }; leaf_count];
        let mut cells = vec![Cell::EMPTY; node_count];
        let mut links = vec![0; node_count];
        let part = Part { records: &mut records, leaves: &mut leaves, cells: &mut cells, links: &mut links };
        part.build(0, 0, weights.map(f64::sqrt));
        let mut node_of_leaf = vec![0; leaf_count];
        for (node, link) in links.iter().enumerate().filter(|(_, link)| *link & LEAF != 0) {
            node_of_leaf[(link ^ LEAF) as usize] = node as u32;
        }
        let rows = records.iter().map(|record| record.row).collect();
        Self { leaves, node_of_leaf, rows, cells, links }
    }

    /// Whether all points of some full leaf are equal.
    pub(super) fn has_heap(&self) -> bool {
        let is_point = |cell: &Cell<F, R>| cell.flat.iter().chain(&cell.round).all(|[low, high]| low == high);
        let full = &self.node_of_leaf[..self.rows.len() / LANES];
        full.iter().any(|&node| is_point(&self.cells[node as usize]))
    }

    #[inline(always)]
    pub(super) fn below(&self, node: usize) -> Below {
        let link = self.links[node];
        if link & LEAF != 0 { Below::Leaf((link ^ LEAF) as usize) } else { Below::Nodes([node + 1, link as usize]) }
    }
}

/// A subtree under construction.
struct Part<'a, const F: usize, const R: usize> {
    records: &'a mut [Record<F, R>],
    leaves: &'a mut [Leaf<F, R>],
    cells: &'a mut [Cell<F, R>],
    links: &'a mut [u32],
}

impl<const F: usize, const R: usize> Part<'_, F, R> {
    fn build(self, first_node: usize, first_leaf: usize, scales: [f64; 2]) {
        let Self { records, leaves, cells, links } = self;
        let cell = Cell::around(records);
        if let [leaf] = leaves {
            leaf.fill(records);
            cells[0] = cell;
            links[0] = first_leaf as u32 | LEAF;
            return;
        }
        let left_leaves = leaves.len().div_ceil(2);
        let left_nodes = 2 * left_leaves - 1;
        let middle = left_leaves * LANES;
        match cell.widest(scales) {
            Axis::Flat(k) => records.select_nth_unstable_by(middle, |a, b| compare(a.flat[k], b.flat[k])),
            Axis::Round(k) => records.select_nth_unstable_by(middle, |a, b| compare(a.round[k], b.round[k])),
        };
        let (cell_here, cells) = cells.split_at_mut(1);
        let (link_here, links) = links.split_at_mut(1);
        cell_here[0] = cell;
        link_here[0] = (first_node + 1 + left_nodes) as u32;
        let serial = records.len() < SERIAL;
        let (records, right_records) = records.split_at_mut(middle);
        let (leaves, right_leaves) = leaves.split_at_mut(left_leaves);
        let (cells, right_cells) = cells.split_at_mut(left_nodes);
        let (links, right_links) = links.split_at_mut(left_nodes);
        let left = Part { records, leaves, cells, links };
        let right = Part { records: right_records, leaves: right_leaves, cells: right_cells, links: right_links };
        let left = || left.build(first_node + 1, first_leaf, scales);
        let right = || right.build(first_node + 1 + left_nodes, first_leaf + left_leaves, scales);
        if serial {
            left();
            right();
        } else {
            rayon::join(left, right);
        }
    }
}

/// Of finite numbers: in fewer instructions than `f64::total_cmp`.
#[inline(always)]
fn compare(a: f64, b: f64) -> Ordering {
    if a < b {
        Ordering::Less
    } else if a > b {
        Ordering::Greater
    } else {
        Ordering::Equal
    }
}

enum Axis {
    Flat(usize),
    Round(usize),
}

impl<const F: usize, const R: usize> Cell<F, R> {
    const EMPTY: Self =
        Self { flat: [[f64::INFINITY, f64::NEG_INFINITY]; F], round: [[f64::INFINITY, f64::NEG_INFINITY]; R] };

    fn around(records: &[Record<F, R>]) -> Self {
        let mut cell = Self::EMPTY;
        let widen = |[low, high]: &mut [f64; 2], x: f64| (*low, *high) = (-greater(-*low, -x), greater(*high, x));
        for record in records {
            cell.flat.iter_mut().zip(record.flat).for_each(|(range, x)| widen(range, x));
            cell.round.iter_mut().zip(record.round).for_each(|(range, x)| widen(range, x));
        }
        cell
    }

    fn widest(&self, scales: [f64; 2]) -> Axis {
        let widths = |ranges: &[[f64; 2]], scale: f64| -> Option<(usize, f64)> {
            let widths = ranges.iter().map(|[low, high]| (high - low) * scale).enumerate();
            widths.max_by(|a, b| a.1.total_cmp(&b.1))
        };
        match (widths(&self.flat, scales[0]), widths(&self.round, scales[1])) {
            (Some((k, flat)), Some((_, round))) if flat >= round => Axis::Flat(k),
            (_, Some((k, _))) => Axis::Round(k),
            (flat, None) => Axis::Flat(flat.map_or(0, |(k, _)| k)),
        }
    }
}

impl<const F: usize, const R: usize> Leaf<F, R> {
    fn fill(&mut self, records: &[Record<F, R>]) {
        for (lane, record) in records.iter().enumerate() {
            self.flat.iter_mut().zip(record.flat).for_each(|(lanes, x)| lanes[lane] = x);
            self.round.iter_mut().zip(record.round).for_each(|(lanes, x)| lanes[lane] = x);
        }
    }

    /// The same points with their unit vectors turned over.
    pub(super) fn opposite(&self) -> Self {
        Self { flat: self.flat, round: self.round.map(|lanes| lanes.map(|x| -x)) }
    }
}
