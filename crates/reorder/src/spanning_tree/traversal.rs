//! A search for all points of one leaf at once.

use super::chord::Chords;
use super::kd_tree::{Below, Cell, KdTree, LANES, Leaf};
use super::vectorised::{self, Task};

/// What a search wants: for each point of the querying leaf, partners within a squared reach that shrinks as they are found.
pub(super) trait Seeker {
    /// The squared reach of each lane; negative where a lane seeks nothing.
    fn reach(&self) -> &[f64; LANES];
    /// Reaches may also shrink for reasons of the seeker's own, before a leaf is looked at.
    fn refresh(&mut self);
    /// Whether any point below the node can be wanted.
    fn wants(&self, node: usize) -> bool;
    /// Whether any point of the leaf below `node` can be wanted by the lane.
    fn lane_wants(&self, lane: usize, node: usize) -> bool;
    /// Whether the point at `slot` can be wanted by the lane.
    fn admits(&self, lane: usize, slot: usize) -> bool;
    /// A partner within reach.
    fn take(&mut self, lane: usize, slot: usize, squared_distance: f64);
}

/// Shows a seeker everything within reach of the points of a leaf, nearest boxes first.
pub(super) fn search<const F: usize, const R: usize>(
    tree: &KdTree<F, R>,
    chords: &Chords,
    leaf: usize,
    seeker: &mut impl Seeker,
) {
    vectorised::run(Search { tree, chords, leaf, seeker });
}

struct Search<'a, const F: usize, const R: usize, S> {
    tree: &'a KdTree<F, R>,
    chords: &'a Chords,
    leaf: usize,
    seeker: &'a mut S,
}

impl<const F: usize, const R: usize, S: Seeker> Task for Search<'_, F, R, S> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(mut self) {
        let (points, cell) = (&self.tree.leaves[self.leaf], self.tree.cell_of_leaf(self.leaf));
        self.descend::<FUSED>(points, cell);
        if self.chords.antipodes_identified {
            self.descend::<FUSED>(&points.opposite(), &cell.opposite());
        }
    }
}

impl<const F: usize, const R: usize, S: Seeker> Search<'_, F, R, S> {
    #[inline(always)]
    fn descend<const FUSED: bool>(&mut self, points: &Leaf<F, R>, cell: &Cell<F, R>) {
        // Never deeper than the tree, whose leaves are numbered in 31 bits.
        let mut stack = [(0.0, 0_u32); 32];
        let mut height = 1;
        stack[0].0 = self.chords.between_cells::<FUSED, F, R>(cell, &self.tree.cells[0]);
        let mut radius = largest(self.seeker.reach());
        while height > 0 {
            height -= 1;
            let (bound, node) = stack[height];
            let mut node = node as usize;
            if bound > radius || !self.seeker.wants(node) {
                continue;
            }
            loop {
                match self.tree.below(node) {
                    Below::Leaf(leaf) => {
                        self.seeker.refresh();
                        self.visit::<FUSED>(points, node, leaf);
                        radius = largest(self.seeker.reach());
                        break;
                    }
                    Below::Nodes([left, right]) => {
                        let a = (self.chords.between_cells::<FUSED, F, R>(cell, &self.tree.cells[left]), left as u32);
                        let b = (self.chords.between_cells::<FUSED, F, R>(cell, &self.tree.cells[right]), right as u32);
                        let (near, far) = if b.0 < a.0 { (b, a) } else { (a, b) };
                        if far.0 <= radius {
                            stack[height] = far;
                            height += 1;
                        }
                        node = near.1 as usize;
                        if near.0 > radius || !self.seeker.wants(node) {
                            break;
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn visit<const FUSED: bool>(&mut self, points: &Leaf<F, R>, node: usize, leaf: usize) {
        let to_cell = self.chords.to_cell::<FUSED, F, R>(points, &self.tree.cells[node]);
        let others = &self.tree.leaves[leaf];
        let mut lanes = within(&to_cell, self.seeker.reach());
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            if !self.seeker.lane_wants(lane, node) {
                continue;
            }
            let to_leaf = self.chords.to_leaf::<FUSED, F, R>(points, lane, others);
            let mut hits = within(&to_leaf.bound, &[self.seeker.reach()[lane]; LANES]);
            while hits != 0 {
                let k = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                let slot = leaf * LANES + k;
                if !self.seeker.admits(lane, slot) {
                    continue;
                }
                let squared_distance = self.chords.exact::<FUSED, F, R>(&to_leaf, k, points, lane, others);
                if squared_distance <= self.seeker.reach()[lane] {
                    self.seeker.take(lane, slot, squared_distance);
                }
            }
        }
    }
}

/// Bit k: `values[k]` is at most `limits[k]`.
#[inline(always)]
fn within(values: &[f64; LANES], limits: &[f64; LANES]) -> u32 {
    let mut mask = 0;
    for k in 0..LANES {
        mask |= u32::from(values[k] <= limits[k]) << k;
    }
    mask
}

#[inline(always)]
fn largest(values: &[f64; LANES]) -> f64 {
    let mut largest = values[0];
    for &value in &values[1..] {
        largest = if value > largest { value } else { largest };
    }
    largest
}
