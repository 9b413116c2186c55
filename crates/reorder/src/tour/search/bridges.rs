//! Moves that no chain of shorter ones leads to: two stretches far apart that change places.
//!
//! Where two passes of a curve run beside each other, an order may jump from the one to the other and back. Mending a single jump would
//! cut the circle in two, so that no exchange of two edges does it; mending two at once does not (the double bridge of Martin, Otto
//! and Felten, 1991; Helsgaun, 2000, searches for it among pairs of gainful cuts as here).

use se3_geom::Manifold;

use super::{Move, RELATIVE_GAIN, Search};

/// Two edges of a circle, each given by its first position, that are exchanged for two that make it two circles.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cut {
    first: usize,
    second: usize,
    delta: f64,
}

impl<M: Manifold> Search<'_, '_, M> {
    /// Moves while two cuts together gain, once for every node at most: a search that wants more goes in circles of rounding.
    pub(super) fn bridge(&mut self) {
        for _ in 0..self.ring.len() {
            if self.problem.was_cut_short() {
                return;
            }
            let Some(chosen) = self.best_trade() else { return };
            self.apply(chosen, &mut Vec::new());
            self.improve();
        }
        self.problem.cut_short();
    }

    /// The pair of cuts that gains most, of those that interleave: together they leave one circle.
    fn best_trade(&self) -> Option<Move> {
        let cuts = self.cuts();
        let mut best = None;
        for gainful in cuts.iter().take_while(|cut| cut.delta < 0.0) {
            for other in &cuts {
                let least = best.map_or(0.0, |(_, delta)| delta);
                // Ascending by delta.
                if gainful.delta + other.delta >= least {
                    break;
                }
                if let Some(trade) = self.trade(gainful, other) {
                    let [before, after] = self.delta(trade);
                    if after - before < least.min(-RELATIVE_GAIN * before) {
                        best = Some((trade, after - before));
                    }
                }
            }
        }
        best.map(|(trade, _)| trade)
    }

    fn trade(&self, a: &Cut, b: &Cut) -> Option<Move> {
        let (a, b) = if a.first < b.first { (a, b) } else { (b, a) };
        let [i, k, j, l] = [a.first, b.first, a.second, b.second];
        let at = |position: usize| self.ring.node(position);
        (i < k && k < j && j < l && i + self.ring.len() > l + 1)
            .then(|| Move::Trade([at(i), at(i + 1), at(k), at(k + 1), at(j), at(j + 1), at(l), at(l + 1)]))
    }

    /// Cuts that join at least one point to a near one, ascending by what they change the cost by.
    fn cuts(&self) -> Vec<Cut> {
        let n = self.ring.len();
        let mut cuts: Vec<(usize, usize)> = Vec::new();
        for v in 0..self.problem.len() {
            let k = self.ring.position(v);
            for near in self.problem.near(v) {
                let c = self.ring.position(near.node);
                // v is followed by c, or c by v.
                for (a, b) in [(k, (c + n - 1) % n), ((k + n - 1) % n, c)] {
                    // The circle that is cut off has three nodes at least, as has the other.
                    if a.abs_diff(b) > 2 && a.abs_diff(b) + 2 < n {
                        cuts.push((a.min(b), a.max(b)));
                    }
                }
            }
        }
        cuts.sort_unstable();
        cuts.dedup();
        let mut cuts: Vec<Cut> = cuts
            .into_iter()
            .map(|(first, second)| Cut { first, second, delta: self.delta_of_cut(first, second) })
            .collect();
        cuts.sort_unstable_by(|a, b| a.delta.total_cmp(&b.delta).then((a.first, a.second).cmp(&(b.first, b.second))));
        cuts
    }

    fn delta_of_cut(&self, first: usize, second: usize) -> f64 {
        let n = self.ring.len();
        let around = |k: usize| [k + n - 1, k, k + 1, k + 2].map(|k| self.ring.node(k));
        let ([o, a, b, c], [w, x, y, z]) = (around(first), around(second));
        let problem = self.problem;
        let length = problem.distance(a, y) + problem.distance(x, b) - problem.distance(a, b) - problem.distance(x, y);
        let turns = [a, b, x, y].iter().map(|&v| self.turns[v]).sum::<f64>();
        let turn = |u, v, w| if self.turning == 0.0 { 0.0 } else { self.turning * problem.turn(u, v, w) };
        length + turn(o, a, y) + turn(a, y, z) + turn(w, x, b) + turn(x, b, c) - turns
    }
}

#[cfg(test)]
mod tests {
    use se3_geom::nalgebra::Vector2;

    use super::*;
    use crate::tour::problem::Problem;

    /// Two rounds of a spiral that change places on half a round: each of the two jumps alone is mended by no single move.
    #[test]
    fn passes_that_changed_places_change_back() {
        let radius = |angle: f64| 10.0 + angle / std::f64::consts::PI;
        let spiral =
            (0..126).map(|k| 0.1 * f64::from(k)).map(|angle| radius(angle) * Vector2::new(angle.cos(), angle.sin()));
        let points: Vec<_> = spiral.collect();
        let problem = Problem::new(&se3_geom::Euclidean::<2>, &points);
        let along: Vec<usize> = (0..=126).collect();
        let least = Search::new(&problem, 3.0, along.clone()).cost();
        let stretches = [0..10, 73..103, 40..73, 10..40, 103..127];
        let mut search = Search::new(&problem, 3.0, stretches.into_iter().flatten().collect());
        (0..=126).for_each(|v| search.enqueue(v));
        search.improve();
        // A jump across two units costs more than one unit of length above a step along of one.
        assert!(search.cost() > least + 1.0);
        search.bridge();
        // The circle begins anywhere and goes either way.
        let mut nodes = search.into_nodes();
        let opening = nodes.iter().position(|&v| v == 126).unwrap();
        nodes.rotate_left((opening + 1) % 127);
        if nodes[0] != 0 {
            nodes[..126].reverse();
        }
        assert_eq!(nodes, along);
    }
}
