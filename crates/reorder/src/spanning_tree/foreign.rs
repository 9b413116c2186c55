//! The nearest point of another component, for points that have run out of candidates.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::boruvka::MIXED;
use super::candidates::{Candidates, NOBODY, tie_precedes};
use super::chord::Chords;
use super::kd_tree::{KdTree, LANES};
use super::traversal::{Seeker, Stack, search};

/// The components of a round and the shortest squared distance that each has found to any other.
pub(super) struct Components<'a> {
    pub(super) of_slot: &'a [u32],
    /// The component that all slots below a node belong to, or `MIXED`.
    pub(super) of_node: &'a [u32],
    pub(super) shortest: &'a [AtomicU64],
    /// The component that need not search: the others reach it.
    pub(super) largest: u32,
}

impl Components<'_> {
    #[inline(always)]
    pub(super) fn shortest(&self, component: u32) -> f64 {
        f64::from_bits(self.shortest[component as usize].load(Relaxed))
    }
    /// Numbers that are not negative compare as their bits do.
    #[inline(always)]
    pub(super) fn shorten(&self, component: u32, squared: f64) {
        let shortest = &self.shortest[component as usize];
        if squared.to_bits() < shortest.load(Relaxed) {
            shortest.fetch_min(squared.to_bits(), Relaxed);
        }
    }
}

/// Searches for those points of a leaf that have no candidate left and may yet have the shortest edge of their component,
/// and tells whether there were any.
pub(super) fn search_foreign<const F: usize, const R: usize, const K: usize>(
    tree: &KdTree<F, R>,
    chords: &Chords,
    components: &Components,
    leaf: usize,
    candidates: &mut [Candidates<K>],
    stack: &mut Stack,
) -> bool {
    let first_slot = leaf * LANES;
    let mut own = [MIXED; LANES];
    let mut seeks = [false; LANES];
    for (lane, candidates) in candidates.iter().enumerate() {
        own[lane] = components.of_slot[first_slot + lane];
        seeks[lane] = own[lane] != components.largest
            && candidates.used as usize == K
            && candidates.bound <= components.shortest(own[lane]);
    }
    if !seeks.contains(&true) {
        return false;
    }
    let mut seeker = Foreign {
        rows: &tree.rows,
        components,
        first_slot,
        own,
        seeks,
        found: [(f64::INFINITY, NOBODY); LANES],
        reach: [-1.0; LANES],
    };
    seeker.refresh();
    search(tree, chords, leaf, stack, &mut seeker);
    for (lane, candidates) in candidates.iter_mut().enumerate().filter(|(lane, _)| seeks[*lane]) {
        let (squared, slot) = seeker.found[lane];
        // Every reach on the way was at least the present one, so that nothing within it was passed over.
        let shortest = components.shortest(own[lane]);
        if squared <= shortest {
            candidates.replace(squared, slot);
        } else {
            candidates.bound = shortest.next_up();
        }
    }
    true
}

struct Foreign<'a> {
    rows: &'a [u32],
    components: &'a Components<'a>,
    first_slot: usize,
    own: [u32; LANES],
    seeks: [bool; LANES],
    found: [(f64, u32); LANES],
    reach: [f64; LANES],
}

impl Seeker for Foreign<'_> {
    #[inline(always)]
    fn reach(&self) -> &[f64; LANES] {
        &self.reach
    }
    #[inline(always)]
    fn refresh(&mut self) {
        for lane in 0..LANES {
            if self.seeks[lane] {
                self.reach[lane] = self.components.shortest(self.own[lane]);
            }
        }
    }
    #[inline(always)]
    fn wanting(&self, node: usize) -> u32 {
        let component = self.components.of_node[node];
        let mut lanes = 0;
        for lane in 0..LANES {
            lanes |= u32::from(self.own[lane] != component) << lane;
        }
        lanes
    }
    #[inline(always)]
    fn admits(&self, lane: usize, slot: usize) -> bool {
        self.components.of_slot[slot] != self.own[lane]
    }
    #[inline(always)]
    fn take(&mut self, lane: usize, slot: usize, squared_distance: f64) {
        let (best, partner) = self.found[lane];
        let (slot, own) = (slot as u32, self.first_slot + lane);
        if squared_distance < best || (squared_distance == best && tie_precedes(self.rows, own, slot, partner)) {
            self.found[lane] = (squared_distance, slot);
            self.reach[lane] = squared_distance;
            self.components.shorten(self.own[lane], squared_distance);
        }
    }
}
