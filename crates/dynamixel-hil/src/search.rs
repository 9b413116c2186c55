//! Which servo it is that does not answer, found out while the arm is led to rest: one question a step, so that no goal comes late.

use crate::bus::Bus;
use crate::error::{HilError, Result};

/// So often a servo is asked before it counts as silent.
const ROUNDS: u32 = 6;

/// A search under way.
pub(crate) struct Search {
    /// How many servos there are.
    count: usize,
    /// Still to be asked in this round.
    left: Vec<u8>,
    /// Did not answer in this round; those are asked again in the next, since one lost answer is no silence.
    silent: Vec<u8>,
    rounds: u32,
}

impl Search {
    pub(crate) fn among(mut ids: Vec<u8>) -> Self {
        ids.reverse();
        Self { count: ids.len(), left: ids, silent: Vec::new(), rounds: 0 }
    }

    /// Asks the next one. What came of the search once it is over; [`HilError::GroupMissed`] where all answer by now.
    ///
    /// # Errors
    /// Where the port is gone.
    pub(crate) fn ask(&mut self, bus: &mut Bus) -> Result<Option<HilError>> {
        if let Some(id) = self.left.pop()
            && !bus.answers(id)?
        {
            self.silent.push(id);
        }
        if !self.left.is_empty() {
            return Ok(None);
        }
        self.rounds += 1;
        if self.rounds < ROUNDS && !self.silent.is_empty() {
            self.left = self.silent.drain(..).rev().collect();
            return Ok(None);
        }
        Ok(Some(match self.silent.first() {
            None => HilError::GroupMissed,
            Some(_) if self.silent.len() == self.count => bus.all_silent(),
            Some(&id) => HilError::Silent { servo: bus.label(id) },
        }))
    }
}
