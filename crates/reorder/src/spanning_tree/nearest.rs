//! The first few nearest neighbours of every point.

use rayon::prelude::*;

use super::candidates::{Candidates, NOBODY, tie_precedes};
use super::chord::Chords;
use super::kd_tree::{KdTree, LANES};
use super::traversal::{Seeker, Stack, search};
use super::vectorised::{greater, lesser};

/// The candidates of every slot.
pub(super) fn nearest_neighbours<const F: usize, const R: usize, const K: usize>(
    tree: &KdTree<F, R>,
    chords: &Chords,
) -> Vec<Candidates<K>> {
    let mut all = vec![Candidates::NONE; tree.rows.len()];
    all.par_chunks_mut(LANES).enumerate().for_each_init(Stack::new, |stack, (leaf, candidates)| {
        let mut reach = [-1.0; LANES];
        reach[..candidates.len()].fill(f64::MAX);
        let mut seeker = Nearest { rows: &tree.rows, first_slot: leaf * LANES, candidates, reach };
        search(tree, chords, leaf, stack, &mut seeker);
        for candidates in seeker.candidates {
            // A list that is not full holds everyone.
            if candidates.slots[K - 1] != NOBODY {
                candidates.bound = candidates.squared[K - 1];
            }
        }
    });
    all
}

struct Nearest<'a, const K: usize> {
    rows: &'a [u32],
    first_slot: usize,
    candidates: &'a mut [Candidates<K>],
    reach: [f64; LANES],
}

impl<const K: usize> Seeker for Nearest<'_, K> {
    #[inline(always)]
    fn reach(&self) -> &[f64; LANES] {
        &self.reach
    }
    #[inline(always)]
    fn refresh(&mut self) {}
    #[inline(always)]
    fn wanting(&self, _: usize) -> u32 {
        u32::MAX
    }
    #[inline(always)]
    fn admits(&self, lane: usize, slot: usize) -> bool {
        slot != self.first_slot + lane
    }
    /// In each of K parts of the leaf is one point within the greatest of the parts' least distances: no reach need be longer.
    #[inline(always)]
    fn foresee(&mut self, lane: usize, first_slot: usize, squared_distances: &[f64; LANES]) {
        if self.reach[lane] < f64::MAX {
            return;
        }
        let mut least = [f64::MAX; K];
        for (k, &squared) in squared_distances.iter().enumerate() {
            let squared = if first_slot + k == self.first_slot + lane { f64::MAX } else { squared };
            least[k % K] = lesser(least[k % K], squared);
        }
        self.reach[lane] = least.into_iter().fold(0.0, greater);
    }
    #[inline(always)]
    fn take(&mut self, lane: usize, slot: usize, squared_distance: f64) {
        let (rows, own) = (self.rows, self.first_slot + lane);
        let candidates = &mut self.candidates[lane];
        candidates.insert(squared_distance, slot as u32, |a, b| tie_precedes(rows, own, a, b));
        self.reach[lane] = lesser(self.reach[lane], candidates.squared[K - 1]);
    }
}
