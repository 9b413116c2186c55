//! What each point knows of the points around it.

use super::edge::Edge;

/// No point.
pub(super) const NOBODY: u32 = u32::MAX;

/// The K nearest partners of a point, nearest first by (squared distance, smaller row, greater row).
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub(super) struct Candidates<const K: usize> {
    pub(super) squared: [f64; K],
    pub(super) slots: [u32; K],
    /// No partner outside the list is nearer than this.
    pub(super) bound: f64,
    /// How many at the front of the list are already in the point's own component.
    pub(super) used: u32,
}

impl<const K: usize> Candidates<K> {
    /// Finite numbers reach as far as this: a distance that overflows is no candidate.
    pub(super) const NONE: Self = Self { squared: [f64::MAX; K], slots: [NOBODY; K], bound: f64::INFINITY, used: 0 };

    /// Puts a partner in its place; the last falls out.
    #[inline(always)]
    pub(super) fn insert(&mut self, squared: f64, slot: u32, precedes: impl Fn(u32, u32) -> bool) {
        let (mut squared, mut slot) = (squared, slot);
        // No branch but the last is taken at random: it would be mispredicted half of the time.
        let mut ties = false;
        for own in &self.squared {
            ties |= *own == squared;
        }
        for k in 0..K {
            let mut here = squared < self.squared[k];
            if ties {
                here |= squared == self.squared[k] && precedes(slot, self.slots[k]);
            }
            let (next, next_slot) = (self.squared[k], self.slots[k]);
            self.squared[k] = if here { squared } else { next };
            self.slots[k] = if here { slot } else { next_slot };
            squared = if here { next } else { squared };
            slot = if here { next_slot } else { slot };
        }
    }

    /// The first partner in another component, where one is left in the list.
    #[inline(always)]
    pub(super) fn foreign(&mut self, own: u32, components: &[u32]) -> Option<(f64, u32)> {
        while let Some(&slot) = self.slots.get(self.used as usize) {
            if slot == NOBODY {
                return None;
            }
            if components[slot as usize] != own {
                return Some((self.squared[self.used as usize], slot));
            }
            self.used += 1;
        }
        None
    }

    /// The list is now this partner alone, and nobody else is nearer.
    pub(super) fn replace(&mut self, squared: f64, slot: u32) {
        (self.squared[K - 1], self.slots[K - 1], self.used, self.bound) = (squared, slot, K as u32 - 1, squared);
    }
}

/// Whether slot a is before slot b among equally distant partners of a slot.
#[inline(always)]
pub(super) fn tie_precedes(rows: &[u32], of: usize, a: u32, b: u32) -> bool {
    b == NOBODY || Edge::new(0.0, rows[of], rows[a as usize]).precedes(&Edge::new(0.0, rows[of], rows[b as usize]))
}
