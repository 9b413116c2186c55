//! Borůvka's algorithm: in every round each component but the largest takes its shortest edge to another.

use std::sync::atomic::AtomicU64;

use petgraph::unionfind::UnionFind;
use rayon::prelude::*;

use super::candidates::Candidates;
use super::chord::Chords;
use super::edge::Edge;
use super::foreign::{Components, search_foreign};
use super::kd_tree::{Below, KdTree, LANES};
use super::nearest::nearest_neighbours;
use super::traversal::Stack;

/// A node whose slots are of several components.
pub(super) const MIXED: u32 = u32::MAX;

/// The edges of the minimum spanning tree as pairs of rows. Fewer than n − 1 where all distances left are too large for a
/// number: then the components cannot be joined.
///
/// K is how many nearest neighbours are sought at first. Most points never need a fifth; without a round factor a search is cheap enough
/// to do again for those that need a fourth.
pub(super) fn spanning_pairs<const F: usize, const R: usize, const K: usize>(
    tree: &KdTree<F, R>,
    chords: &Chords,
) -> Vec<[u32; 2]> {
    let mut candidates = nearest_neighbours::<F, R, K>(tree, chords);
    let mut forest = Forest::of_single_slots(tree);
    while forest.sizes.len() > 1 && forest.grow(tree, chords, &mut candidates) {}
    forest.pairs
}

struct Forest {
    pairs: Vec<[u32; 2]>,
    of_slot: Vec<u32>,
    of_node: Vec<u32>,
    /// Slots in each component.
    sizes: Vec<u32>,
    leaves: Vec<LeafState>,
}

/// What need not be asked of the sixteen slots again in every round.
#[derive(Clone)]
struct LeafState {
    /// Some slot may have candidates left.
    stocked: bool,
    /// Some slot may have the shortest edge of its component in this round.
    hopeful: bool,
    /// To no slot that has run out of candidates a foreign one is nearer.
    bound: f64,
}

impl LeafState {
    /// Passes over the candidates that have joined the component, and tells the component of the first that has not.
    fn advance<const K: usize>(&mut self, candidates: &mut [Candidates<K>], components: &Components, leaf: usize) {
        self.hopeful = false;
        if self.stocked {
            self.summarise(candidates, components, leaf);
        }
    }

    fn summarise<const K: usize>(&mut self, candidates: &mut [Candidates<K>], components: &Components, leaf: usize) {
        *self = Self { stocked: false, hopeful: self.hopeful, bound: f64::INFINITY };
        for (candidates, &own) in candidates.iter_mut().zip(&components.of_slot[leaf * LANES..]) {
            match candidates.foreign(own, components.of_slot) {
                Some((squared, _)) => {
                    self.stocked = true;
                    if own != components.largest {
                        components.shorten(own, squared);
                        self.hopeful |= squared <= components.shortest(own);
                    }
                }
                None => self.bound = self.bound.min(candidates.bound),
            }
        }
    }
}

impl Forest {
    fn of_single_slots<const F: usize, const R: usize>(tree: &KdTree<F, R>) -> Self {
        let count = tree.rows.len();
        let (of_slot, of_node) = ((0..count as u32).collect(), vec![MIXED; tree.cells.len()]);
        let leaves = vec![LeafState { stocked: true, hopeful: false, bound: f64::INFINITY }; tree.leaves.len()];
        Self { pairs: Vec::with_capacity(count), of_slot, of_node, sizes: vec![1; count], leaves }
    }

    /// One round; whether any components were joined.
    fn grow<const F: usize, const R: usize, const K: usize>(
        &mut self,
        tree: &KdTree<F, R>,
        chords: &Chords,
        candidates: &mut [Candidates<K>],
    ) -> bool {
        let largest = (0..self.sizes.len()).max_by_key(|&c| self.sizes[c]).unwrap_or(0) as u32;
        let shortest: Vec<_> = self.sizes.iter().map(|_| AtomicU64::new(f64::MAX.to_bits())).collect();
        let components = Components { of_slot: &self.of_slot, of_node: &self.of_node, shortest: &shortest, largest };
        let busy = |leaf: usize| components.of_node[tree.node_of_leaf[leaf] as usize] != largest;
        let leaves = candidates.par_chunks_mut(LANES).zip(&mut self.leaves).enumerate();
        leaves.filter(|(leaf, _)| busy(*leaf)).for_each(|(leaf, (candidates, state))| {
            state.advance(candidates, &components, leaf);
        });
        let leaves = candidates.par_chunks_mut(LANES).zip(&mut self.leaves).enumerate();
        leaves.filter(|(leaf, _)| busy(*leaf)).for_each_init(Stack::new, |stack, (leaf, (candidates, state))| {
            let component = components.of_node[tree.node_of_leaf[leaf] as usize];
            let reach = if component == MIXED { f64::MAX } else { components.shortest(component) };
            if state.bound <= reach && search_foreign(tree, chords, &components, leaf, candidates, stack) {
                state.summarise(candidates, &components, leaf);
            }
        });

        // Of a component's edges of the shortest length, the first.
        let mut chosen = vec![(Edge::new(f64::INFINITY, MIXED, MIXED), [MIXED; 2]); self.sizes.len()];
        for (leaf, _) in self.leaves.iter().enumerate().filter(|(leaf, state)| state.hopeful && busy(*leaf)) {
            let slots = leaf * LANES..((leaf + 1) * LANES).min(candidates.len());
            for slot in slots {
                let own = self.of_slot[slot];
                let Some((squared, partner)) = candidates[slot].foreign(own, &self.of_slot) else { continue };
                if own != largest && squared <= components.shortest(own) {
                    let edge = Edge::new(squared, tree.rows[slot], tree.rows[partner as usize]);
                    let (first, joins) = &mut chosen[own as usize];
                    if edge.precedes(first) {
                        (*first, *joins) = (edge, [own, self.of_slot[partner as usize]]);
                    }
                }
            }
        }
        self.join(tree, &chosen)
    }

    /// Joins components along their chosen edges, and numbers them anew.
    fn join<const F: usize, const R: usize>(&mut self, tree: &KdTree<F, R>, chosen: &[(Edge, [u32; 2])]) -> bool {
        let mut joined = UnionFind::<u32>::new(self.sizes.len());
        let before = self.pairs.len();
        for (edge, [a, b]) in chosen.iter().filter(|(edge, _)| edge.length.is_finite()) {
            // Two components may have chosen the same edge.
            if joined.union(*a, *b) {
                self.pairs.push([edge.i, edge.j]);
            }
        }
        let mut sizes = Vec::with_capacity(self.sizes.len() / 2);
        let mut number_of_root = vec![MIXED; self.sizes.len()];
        let numbers: Vec<u32> = (0..self.sizes.len() as u32)
            .map(|component| {
                let number = &mut number_of_root[joined.find_mut(component) as usize];
                if *number == MIXED {
                    *number = sizes.len() as u32;
                    sizes.push(0);
                }
                sizes[*number as usize] += self.sizes[component as usize];
                *number
            })
            .collect();
        self.sizes = sizes;
        self.of_slot.par_iter_mut().with_min_len(1 << 14).for_each(|c| *c = numbers[*c as usize]);
        // Children come after their parents.
        for node in (0..self.of_node.len()).rev() {
            self.of_node[node] = match tree.below(node) {
                Below::Leaf(leaf) => {
                    let slots = &self.of_slot[leaf * LANES..((leaf + 1) * LANES).min(self.of_slot.len())];
                    if slots.iter().all(|c| *c == slots[0]) { slots[0] } else { MIXED }
                }
                Below::Nodes([left, right]) if self.of_node[left] == self.of_node[right] => self.of_node[left],
                Below::Nodes(_) => MIXED,
            };
        }
        self.pairs.len() > before
    }
}
