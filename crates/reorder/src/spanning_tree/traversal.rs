//! A search for all points of one leaf at once.

use super::chord::Chords;
use super::kd_tree::{Below, KdTree, LANES, Leaf};
use super::vectorised::{self, Task};

/// What a search wants: for each point of the querying leaf, partners within a squared reach that shrinks as they are found.
pub(super) trait Seeker {
    /// The squared reach of each lane; negative where a lane seeks nothing.
    fn reach(&self) -> &[f64; LANES];
    /// Reaches may also shrink for reasons of the seeker's own, before a leaf is looked at.
    fn refresh(&mut self);
    /// The lanes, as bits, that may want a point below the node.
    fn wanting(&self, node: usize) -> u32;
    /// Whether the point at `slot` can be wanted by the lane.
    fn admits(&self, lane: usize, slot: usize) -> bool;
    /// The squared distances of the points of a leaf from the lane, before any of them is shown.
    fn foresee(&mut self, _lane: usize, _first_slot: usize, _squared_distances: &[f64; LANES]) {}
    /// A partner within reach.
    fn take(&mut self, lane: usize, slot: usize, squared_distance: f64);
}

/// Shows a seeker everything within reach of the points of a leaf, nearest boxes first.
pub(super) fn search<const F: usize, const R: usize>(
    tree: &KdTree<F, R>,
    chords: &Chords,
    leaf: usize,
    stack: &mut Stack,
    seeker: &mut impl Seeker,
) {
    vectorised::run(Search { tree, chords, leaf, stack, seeker });
}

/// Nodes put off, with the lower bounds of the squared distances to them: room that one search leaves to the next.
pub(super) type Stack = Vec<(usize, [f64; LANES])>;

struct Search<'a, const F: usize, const R: usize, S> {
    tree: &'a KdTree<F, R>,
    chords: &'a Chords,
    leaf: usize,
    stack: &'a mut Stack,
    seeker: &'a mut S,
}

impl<const F: usize, const R: usize, S: Seeker> Task for Search<'_, F, R, S> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(mut self) {
        let points = &self.tree.leaves[self.leaf];
        self.visit_own::<FUSED>(points);
        self.visit_rest::<FUSED>(points);
        if self.chords.antipodes_identified {
            self.stack.push((0, [0.0; LANES]));
            self.visit_rest::<FUSED>(&points.opposite());
        }
    }
}

impl<const F: usize, const R: usize, S: Seeker> Search<'_, F, R, S> {
    /// Goes straight down to the querying leaf itself, where the nearest points mostly are, and puts off what hangs beside the way:
    /// the smallest subtree will come first.
    #[inline(always)]
    fn visit_own<const FUSED: bool>(&mut self, points: &Leaf<F, R>) {
        let own = self.tree.node_of_leaf[self.leaf] as usize;
        let mut node = 0;
        while let Below::Nodes([left, right]) = self.tree.below(node) {
            // Nodes are in preorder.
            let (ahead, beside) = if own < right { (left, right) } else { (right, left) };
            if self.seeker.wanting(beside) != 0 {
                let bounds = self.chords.to_cell::<FUSED, F, R>(points, &self.tree.cells[beside]);
                if within(&bounds, self.seeker.reach()) != 0 {
                    self.stack.push((beside, bounds));
                }
            }
            node = ahead;
        }
        self.seeker.refresh();
        self.visit::<FUSED>(points, self.wanting(own, &[0.0; LANES]), self.leaf);
    }

    /// Visits what was put off.
    #[inline(always)]
    fn visit_rest<const FUSED: bool>(&mut self, points: &Leaf<F, R>) {
        while let Some((mut node, mut bounds)) = self.stack.pop() {
            while self.wanting(node, &bounds) != 0 {
                match self.tree.below(node) {
                    Below::Leaf(leaf) => {
                        self.seeker.refresh();
                        self.visit::<FUSED>(points, self.wanting(node, &bounds), leaf);
                        break;
                    }
                    Below::Nodes([left, right]) => {
                        let a = self.chords.to_cell::<FUSED, F, R>(points, &self.tree.cells[left]);
                        let b = self.chords.to_cell::<FUSED, F, R>(points, &self.tree.cells[right]);
                        let reach = self.seeker.reach();
                        let (near, far) = if remoteness(&b, reach) < remoteness(&a, reach) {
                            ((right, b), (left, a))
                        } else {
                            ((left, a), (right, b))
                        };
                        if within(&far.1, reach) != 0 {
                            self.stack.push(far);
                        }
                        (node, bounds) = near;
                    }
                }
            }
        }
    }

    /// The lanes that may find something below a node.
    #[inline(always)]
    fn wanting(&self, node: usize, bounds: &[f64; LANES]) -> u32 {
        let lanes = within(bounds, self.seeker.reach());
        if lanes == 0 { 0 } else { lanes & self.seeker.wanting(node) }
    }

    #[inline(always)]
    fn visit<const FUSED: bool>(&mut self, points: &Leaf<F, R>, mut lanes: u32, leaf: usize) {
        let others = &self.tree.leaves[leaf];
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let to_leaf = self.chords.to_leaf::<FUSED, F, R>(points, lane, others);
            if R == 0 {
                self.seeker.foresee(lane, leaf * LANES, &to_leaf.bound);
            }
            let mut hits = vectorised::at_most::<FUSED>(&to_leaf.bound, self.seeker.reach()[lane]);
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

/// The sum of the bounds, none counted beyond its reach.
#[inline(always)]
fn remoteness(bounds: &[f64; LANES], reach: &[f64; LANES]) -> f64 {
    let mut sums = [0.0; 4];
    for k in 0..LANES {
        sums[k % 4] += if bounds[k] < reach[k] { bounds[k] } else { reach[k] };
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
