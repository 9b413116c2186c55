//! Local search with kicks.

use std::collections::VecDeque;

use se3_geom::Manifold;

use super::problem::Problem;
use super::random::Random;
use super::ring::Ring;

/// The longest stretch that is moved as a whole.
const LONGEST_MOVED: usize = 3;
/// Only gains of more than this share of what is exchanged count: smaller ones are rounding, on which the search would go in
/// circles.
const RELATIVE_GAIN: f64 = 1e-9;
/// Stretches that a kick exchanges are at most this long, so that it can be mended near by.
const KICK: usize = 8;
/// No fewer kicks than this, where there is anything to kick.
const FEWEST_KICKS: usize = 100;
const SEED: u64 = 0x5EED;
/// Parts the nodes in a list of those around a move: what lies between is unchanged by it.
const BREAK: usize = usize::MAX;

/// A tour of least Σ distance + λ Σ turning, as far as the search finds it.
pub(super) struct Search<'p, 'a, M: Manifold> {
    problem: &'p Problem<'a, M>,
    turning: f64,
    ring: Ring,
    /// λ × turning at every node.
    turns: Vec<f64>,
    queue: VecDeque<usize>,
    queued: Vec<bool>,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Move {
    /// See [`Ring::exchange`].
    Exchange([usize; 4]),
    /// See [`Ring::swap`].
    Swap([usize; 6], bool),
}

impl<'p, 'a, M: Manifold> Search<'p, 'a, M> {
    pub(super) fn new(problem: &'p Problem<'a, M>, turning: f64, nodes: Vec<usize>) -> Self {
        let n = nodes.len();
        let mut search = Self {
            problem,
            turning,
            ring: Ring::new(nodes),
            turns: vec![0.0; n],
            queue: VecDeque::new(),
            queued: vec![false; n],
        };
        for v in 0..n {
            search.turns[v] = search.turn_at(v);
        }
        search
    }

    /// Σ distance + λ Σ turning of the whole tour.
    pub(super) fn cost(&self) -> f64 {
        let edge = |k: usize| self.problem.distance(self.ring.node(k), self.ring.node(k + 1));
        (0..self.ring.len()).map(edge).sum::<f64>() + self.turns.iter().sum::<f64>()
    }

    pub(super) fn into_nodes(self) -> Vec<usize> {
        self.ring.into_nodes()
    }

    /// Improves from every node, then after so many kicks for every node whose neighbours are not the obvious ones.
    pub(super) fn run(mut self, kicks_per_node: usize) -> Vec<usize> {
        // In a circle of four or fewer there is nothing to exchange that an exchange of two edges would not reach.
        if self.ring.len() < 4 {
            return self.ring.into_nodes();
        }
        for k in 0..self.ring.len() {
            self.enqueue(self.ring.node(k));
        }
        self.improve();
        self.move_opening();
        self.ring.keep();
        let unsettled = self.unsettled();
        let mut random = Random::seeded(SEED);
        if !unsettled.is_empty() && kicks_per_node > 0 {
            for _ in 0..(kicks_per_node * unsettled.len()).max(FEWEST_KICKS) {
                let v = unsettled[random.below(unsettled.len())];
                self.kick(v, &mut random);
            }
        }
        self.move_opening();
        self.ring.into_nodes()
    }

    /// Where the tour is not the obvious one: elsewhere a kick gains nothing.
    fn unsettled(&self) -> Vec<usize> {
        let is_settled = |v: usize| self.problem.are_natural(self.ring.previous(v), v, self.ring.next(v));
        (0..self.problem.len()).filter(|&v| !is_settled(v)).collect()
    }

    #[cfg(test)]
    pub(super) fn nodes(&self) -> &[usize] {
        self.ring.nodes()
    }
    #[cfg(test)]
    pub(super) fn take_back(&mut self) {
        self.ring.take_back();
    }
    /// Any exchange or swap of stretches, in either direction; the circle must have five nodes or more.
    #[cfg(test)]
    pub(super) fn random_move(&self, random: &mut Random) -> Move {
        let n = self.ring.len();
        let forward = random.below(2) == 0;
        let start = self.ring.node(random.below(n));
        let walk: Vec<usize> =
            std::iter::successors(Some(start), |&v| Some(self.ring.step(v, forward))).take(n).collect();
        let first = 1 + random.below(n - 3);
        if random.below(2) == 0 {
            return Move::Exchange([walk[0], walk[1], walk[first], walk[first + 1]]);
        }
        let second = first + 1 + random.below(n - 2 - first);
        let nodes = [walk[0], walk[1], walk[first], walk[first + 1], walk[second], walk[second + 1]];
        Move::Swap(nodes, random.below(2) == 0)
    }

    /// Exchanges two stretches around v, improves there, and takes it all back unless it gained.
    fn kick(&mut self, v: usize, random: &mut Random) {
        let n = self.ring.len();
        let longest = KICK.min((n - 2) / 2);
        let (first, second) = (1 + random.below(longest), 1 + random.below(longest));
        let start = self.ring.position(v) + n - random.below(first + second + 2).min(n);
        let at = |offset: usize| self.ring.node(start + offset);
        let nodes = [at(0), at(1), at(first), at(first + 1), at(first + second), at(first + second + 1)];
        let kick = Move::Swap(nodes, false);
        let [before, after] = self.delta(kick);
        let mut delta = after - before;
        let mut touched = Vec::new();
        self.apply(kick, &mut touched);
        delta += self.improve_touching(&mut touched);
        if delta < -RELATIVE_GAIN * before {
            self.ring.keep();
        } else {
            self.ring.take_back();
            for v in touched {
                self.turns[v] = self.turn_at(v);
            }
        }
    }

    /// Moves the opening, which is near to everything, to where it gains most.
    fn move_opening(&mut self) {
        let opening = self.problem.opening();
        if opening >= self.ring.len() || self.ring.len() < 5 {
            return;
        }
        loop {
            let (o, z) = (self.ring.previous(opening), self.ring.next(opening));
            let mut best = None;
            let mut x = z;
            while self.ring.next(x) != o {
                let y = self.ring.next(x);
                let (ahead, behind) = (self.ring.count(z, x, true), self.ring.count(y, o, true));
                let nodes =
                    if ahead <= behind { [o, opening, opening, z, x, y] } else { [z, opening, opening, o, y, x] };
                if ahead.min(behind) + 3 <= self.ring.len() {
                    self.consider(Move::Swap(nodes, false), &mut best);
                }
                x = y;
            }
            let Some((chosen, _)) = best else { return };
            self.apply(chosen, &mut Vec::new());
            self.improve();
        }
    }

    fn improve(&mut self) {
        self.improve_touching(&mut Vec::new());
    }

    /// Moves until no node in the queue gains; the sum of all changes of cost.
    fn improve_touching(&mut self, touched: &mut Vec<usize>) -> f64 {
        let mut sum = 0.0;
        while let Some(v) = self.queue.pop_front() {
            self.queued[v] = false;
            while let Some((best, delta)) = self.best_move(v) {
                sum += delta;
                self.apply(best, touched);
            }
        }
        sum
    }

    fn enqueue(&mut self, v: usize) {
        if !self.queued[v] {
            self.queued[v] = true;
            self.queue.push_back(v);
        }
    }

    pub(super) fn apply(&mut self, chosen: Move, touched: &mut Vec<usize>) {
        let nodes: &[usize] = match &chosen {
            Move::Exchange(nodes) => nodes,
            Move::Swap(nodes, _) => nodes,
        };
        match chosen {
            Move::Exchange([a, b, c, d]) => self.ring.exchange(a, b, c, d),
            Move::Swap(nodes, turned) => self.ring.swap(nodes, turned),
        }
        for &v in nodes {
            self.turns[v] = self.turn_at(v);
            self.enqueue(v);
        }
        touched.extend(nodes);
    }

    fn turn_at(&self, v: usize) -> f64 {
        if self.turning == 0.0 {
            return 0.0;
        }
        self.turning * self.problem.turn(self.ring.previous(v), v, self.ring.next(v))
    }

    fn best_move(&self, v: usize) -> Option<(Move, f64)> {
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

    fn consider(&self, candidate: Move, best: &mut Option<(Move, f64)>) {
        let [before, after] = self.around(candidate);
        let before = self.cost_now(before.nodes());
        let least = best.map_or(-RELATIVE_GAIN * before, |(_, least)| least);
        if let Some(after) = self.cost_below(after.nodes(), before + least) {
            *best = Some((candidate, after - before));
        }
    }

    /// What a move changes the cost by.
    pub(super) fn delta(&self, candidate: Move) -> [f64; 2] {
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
    nodes: [usize; 14],
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
