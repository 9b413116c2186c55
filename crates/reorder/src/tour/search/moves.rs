//! Which moves there are, and what each would change the cost by.

use se3_geom::Manifold;

use super::{Move, RELATIVE_GAIN, Search};
use crate::tour::ring::Ring;

/// The longest stretch that is moved as a whole.
const LONGEST_MOVED: usize = 3;
/// Parts the nodes in a list of those around a move: what lies between is unchanged by it.
const BREAK: usize = usize::MAX;

impl<M: Manifold> Search<'_, '_, M> {
    pub(super) fn best_move(&self, v: usize) -> Option<(Move, f64)> {
        let mut best = None;
        self.exchanges(v, &mut best);
        self.swaps(v, &mut best);
        best
    }

    /// Exchanges of two edges that join v to a near point.
    fn exchanges(&self, v: usize, best: &mut Option<(Move, f64)>) {
        for forward in [true, false] {
            let b = self.ring.step(v, forward);
            let freed = self.problem.distance(v, b) + self.turns[v] + self.turns[b];
            for near in self.problem.near(v) {
                let c = near.node;
                let d = self.ring.step(c, forward);
                let budget = freed + self.problem.distance(c, d) + self.turns[c] + self.turns[d];
                let worthless = near.distance >= budget || near.distance + self.problem.distance(b, d) >= budget;
                if c != b && d != v && !worthless {
                    self.consider(Move::Exchange([v, b, c, d]), best);
                }
            }
        }
    }

    /// Moves of a stretch that ends at v to where v is beside a near point.
    fn swaps(&self, v: usize, best: &mut Option<(Move, f64)>) {
        for away in [true, false] {
            // The stretch goes from v to w, away from o; z follows w.
            let o = self.ring.step(v, !away);
            let mut w = v;
            for count in 1..=LONGEST_MOVED.min(self.ring.len().saturating_sub(3)) {
                if count > 1 {
                    w = self.ring.step(w, away);
                }
                let z = self.ring.step(w, away);
                let problem = self.problem;
                let freed = problem.distance(o, v) + problem.distance(w, z) - problem.distance(o, z)
                    + self.turns[o]
                    + self.turns[v]
                    + self.turns[z]
                    + if count > 1 { self.turns[w] } else { 0.0 };
                for near in problem.near(v) {
                    if self.ring.count(v, near.node, away) <= count {
                        continue;
                    }
                    for beyond in [true, false] {
                        self.swap_between([o, v, w, z], near.node, near.distance, away, beyond, freed, best);
                    }
                }
            }
        }
    }

    /// The stretch v…w between c and its neighbour e, with v beside c.
    #[expect(clippy::too_many_arguments, reason = "what the loops around it have found")]
    fn swap_between(
        &self,
        [o, v, w, z]: [usize; 4],
        c: usize,
        distance: f64,
        away: bool,
        beyond: bool,
        freed: f64,
        best: &mut Option<(Move, f64)>,
    ) {
        // Seen from v in direction `away`: `beyond` inserts past c, else before it.
        let e = self.ring.step(c, away == beyond);
        if (c == o && e == v) || (c == z && e == w) || self.ring.count(v, e, away) <= self.ring.count(v, w, away) {
            return;
        }
        let budget = freed + self.problem.distance(c, e) + self.turns[c] + self.turns[e];
        if distance >= budget || distance + self.problem.distance(w, e) >= budget {
            return;
        }
        let (x, y) = if beyond { (c, e) } else { (e, c) };
        // o v…w z…x y…: in this direction the stretch lands between x and y, as y…o in the other.
        let (ahead, behind) = (self.ring.count(z, x, away), self.ring.count(y, o, away));
        let lands_turned = !beyond;
        let nodes = if ahead <= behind { [o, v, w, z, x, y] } else { [z, w, v, o, y, x] };
        if ahead.min(behind) + self.ring.count(v, w, away) + 2 > self.ring.len() {
            return;
        }
        // Unturned, v follows x; v is to be beside c.
        self.consider(Move::Swap(nodes, lands_turned), best);
    }

    pub(super) fn consider(&self, candidate: Move, best: &mut Option<(Move, f64)>) {
        let [before, after] = self.around(candidate);
        let before = self.cost_now(before.nodes());
        // A gain on short edges, however real, is no bound for one on edges so long that it is their rounding.
        let least = best.map_or(0.0, |(_, least)| least).min(-RELATIVE_GAIN * before);
        if let Some(after) = self.cost_below(after.nodes(), before + least) {
            *best = Some((candidate, after - before));
        }
    }

    /// What a move changes the cost by.
    pub(in crate::tour) fn delta(&self, candidate: Move) -> [f64; 2] {
        let [before, after] = self.around(candidate);
        [self.cost_now(before.nodes()), self.cost_below(after.nodes(), f64::INFINITY).unwrap_or(f64::INFINITY)]
    }

    /// The nodes whose edges or turning a move changes, before and after it.
    fn around(&self, candidate: Move) -> [Around; 2] {
        let (mut before, mut after) = (Around::default(), Around::default());
        match candidate {
            Move::Exchange([a, b, c, d]) => {
                let forward = self.ring.next(a) == b;
                // a b…c d becomes a c…b d.
                let outer = [self.ring.step(a, !forward), a];
                let beyond = [d, self.ring.step(d, forward)];
                before.extend(&outer);
                before.stretch(&self.ring, b, c, forward);
                before.extend(&beyond);
                after.extend(&outer);
                after.stretch(&self.ring, c, b, !forward);
                after.extend(&beyond);
            }
            Move::Swap([p, s1, s2, m1, m2, y], turned) => {
                let forward = self.ring.next(p) == s1;
                let outer = [self.ring.step(p, !forward), p];
                let beyond = [y, self.ring.step(y, forward)];
                before.extend(&outer);
                before.stretch(&self.ring, s1, s2, forward);
                before.stretch(&self.ring, m1, m2, forward);
                before.extend(&beyond);
                after.extend(&outer);
                after.stretch(&self.ring, m1, m2, forward);
                if turned {
                    after.stretch(&self.ring, s2, s1, !forward);
                } else {
                    after.stretch(&self.ring, s1, s2, forward);
                }
                after.extend(&beyond);
            }
            Move::Trade([p, s1, s2, q, x, t1, t2, y]) => {
                let forward = self.ring.next(p) == s1;
                let outer = [self.ring.step(p, !forward), p];
                let beyond = [y, self.ring.step(y, forward)];
                let [s, middle, t] = [(s1, s2), (q, x), (t1, t2)];
                for (around, stretches) in [(&mut before, [s, middle, t]), (&mut after, [t, middle, s])] {
                    around.extend(&outer);
                    stretches.iter().for_each(|&(first, last)| around.stretch(&self.ring, first, last, forward));
                    around.extend(&beyond);
                }
            }
        }
        [before, after]
    }

    /// Cost of runs of nodes as they stand in the ring.
    fn cost_now(&self, nodes: &[usize]) -> f64 {
        let runs = || nodes.split(|&v| v == BREAK);
        let length: f64 = runs().flat_map(|run| run.windows(2)).map(|w| self.problem.distance(w[0], w[1])).sum();
        length + runs().flat_map(|run| run.windows(3)).map(|w| self.turns[w[1]]).sum::<f64>()
    }

    /// Cost of runs of nodes in any sequence; `None` where it is not below `limit`.
    fn cost_below(&self, nodes: &[usize], limit: f64) -> Option<f64> {
        let runs = || nodes.split(|&v| v == BREAK);
        let mut sum: f64 = runs().flat_map(|run| run.windows(2)).map(|w| self.problem.distance(w[0], w[1])).sum();
        if self.turning > 0.0 {
            for w in runs().flat_map(|run| run.windows(3)) {
                if sum >= limit {
                    return None;
                }
                sum += self.turning * self.problem.turn(w[0], w[1], w[2]);
            }
        }
        (sum < limit).then_some(sum)
    }
}

/// The nodes around a move in sequence: two before and after, and of every stretch the two at either end.
#[derive(Default)]
struct Around {
    nodes: [usize; 19],
    count: usize,
}

impl Around {
    fn nodes(&self) -> &[usize] {
        &self.nodes[..self.count]
    }
    fn extend(&mut self, more: &[usize]) {
        self.nodes[self.count..self.count + more.len()].copy_from_slice(more);
        self.count += more.len();
    }
    fn stretch(&mut self, ring: &Ring, first: usize, last: usize, forward: bool) {
        let (second, second_last) = (ring.step(first, forward), ring.step(last, !forward));
        match ring.count(first, last, forward) {
            1 => self.extend(&[first]),
            2 => self.extend(&[first, last]),
            3 => self.extend(&[first, second, last]),
            _ => self.extend(&[first, second, BREAK, second_last, last]),
        }
    }
}
