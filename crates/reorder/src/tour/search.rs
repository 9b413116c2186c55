//! Local search with kicks.

mod bridges;
mod moves;

use std::collections::VecDeque;

use se3_geom::Manifold;

use super::problem::Problem;
use super::random::Random;
use super::ring::Ring;

/// Only gains of more than this share of what is exchanged count: smaller ones are rounding, on which the search would go in
/// circles.
const RELATIVE_GAIN: f64 = 1e-9;
/// Moves that an improvement makes at most, for every node: thirty times as many as any was seen to need.
const MOST_MOVES: usize = 100;
/// Stretches that a kick exchanges are at most this long, so that it can be mended near by.
const KICK: usize = 8;
/// No fewer kicks in a round than this, where there is anything to kick.
const FEWEST_KICKS: usize = 50;
/// After so many rounds in a row that gained nothing, another one seldom does.
const IN_VAIN: usize = 2;
const SEED: u64 = 0x5EED;

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
    /// See [`Ring::trade`].
    Trade([usize; 8]),
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

    /// Until no move gains, nor two together.
    pub(super) fn descend(&mut self) {
        // In a circle of four or fewer there is nothing to exchange that an exchange of two edges would not reach.
        if self.ring.len() < 4 {
            return;
        }
        for k in 0..self.ring.len() {
            self.enqueue(self.ring.node(k));
        }
        self.improve();
        self.move_opening();
        self.bridge();
        self.ring.keep();
    }

    /// From a tour that was descended to: rounds of a kick for every node whose neighbours are not the obvious ones.
    pub(super) fn shake(&mut self, rounds: usize) {
        if self.ring.len() < 4 {
            return;
        }
        let mut random = Random::seeded(SEED);
        let mut in_vain = 0;
        for _ in 0..rounds {
            let unsettled = self.unsettled();
            if unsettled.is_empty() {
                break;
            }
            let mut gained = false;
            for _ in 0..unsettled.len().max(FEWEST_KICKS) {
                if self.problem.was_cut_short() {
                    return;
                }
                let v = unsettled[random.below(unsettled.len())];
                gained |= self.kick(v, &mut random);
            }
            in_vain = if gained { 0 } else { in_vain + 1 };
            if in_vain == IN_VAIN {
                break;
            }
            self.bridge();
            self.ring.keep();
        }
        self.move_opening();
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
    /// Any exchange, swap or trade of stretches, in either direction; the circle must have five nodes or more.
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
        if second + 2 < n && random.below(2) == 0 {
            let third = second + 1 + random.below(n - 2 - second);
            let cuts = [0, first, second, third];
            return Move::Trade(std::array::from_fn(|k| walk[cuts[k / 2] + k % 2]));
        }
        let nodes = [walk[0], walk[1], walk[first], walk[first + 1], walk[second], walk[second + 1]];
        Move::Swap(nodes, random.below(2) == 0)
    }

    /// Exchanges two stretches around v, improves there, and takes it all back unless it gained; whether it did.
    fn kick(&mut self, v: usize, random: &mut Random) -> bool {
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
        let gained = delta < -RELATIVE_GAIN * before;
        if gained {
            self.ring.keep();
        } else {
            self.ring.take_back();
            for v in touched {
                self.turns[v] = self.turn_at(v);
            }
        }
        gained
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
        let mut moves_left = MOST_MOVES * self.ring.len();
        while let Some(v) = self.queue.pop_front() {
            self.queued[v] = false;
            while let Some((best, delta)) = self.best_move(v) {
                if moves_left == 0 {
                    self.problem.cut_short();
                    self.queue.clear();
                    self.queued.fill(false);
                    return sum;
                }
                moves_left -= 1;
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
            Move::Trade(nodes) => nodes,
        };
        match chosen {
            Move::Exchange([a, b, c, d]) => self.ring.exchange(a, b, c, d),
            Move::Swap(nodes, turned) => self.ring.swap(nodes, turned),
            Move::Trade(nodes) => self.ring.trade(nodes),
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
}
