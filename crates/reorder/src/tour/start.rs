//! Where the search starts: short edges, joined to one path.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use petgraph::unionfind::UnionFind;
use se3_geom::Manifold;

use super::problem::Problem;

/// Paths through all points to search from, that hold the edges of `preferred`, the shortest first, as far as they branch nowhere and
/// close no loop: of the shortest edges, of the edges that go on well, and two whose edges are weighed anew as the paths grow.
///
/// Where a curve runs beside itself, the shortest edges lead across, and from a path that zigzags no few exchanges lead back. The edges
/// that cost least with what goes on best at either end lead along, and the more surely, the more turning costs: one path is grown at
/// the price of turning that the search is for, one at twice that and a little more, so that there are two where turning is free.
/// Where a curve crosses itself, short edges are the better guess.
pub(crate) fn starts<M: Manifold>(problem: &Problem<M>, turning: f64, preferred: &[(usize, usize)]) -> [Vec<usize>; 4] {
    let distance = |_: &Paths, a: usize, b: usize| problem.distance(a, b);
    let goes_on = |v: usize, w: usize| {
        let beyond = problem.near(w).iter().filter(|near| near.node != v);
        beyond.map(|near| near.distance + turning * problem.turn(v, w, near.node)).fold(f64::INFINITY, f64::min)
    };
    let smooth = |_: &Paths, a: usize, b: usize| problem.distance(a, b) + 0.5 * (goes_on(a, b) + goes_on(b, a));
    [
        joined(problem, preferred, distance, distance),
        joined(problem, preferred, smooth, distance),
        grown(problem, turning, preferred),
        grown(problem, 2.0 * turning + 1.0, preferred),
    ]
}

/// What goes on at an end of an edge is known where the path goes on there; else it is the best that points with a free end allow.
fn grown<M: Manifold>(problem: &Problem<M>, turning: f64, preferred: &[(usize, usize)]) -> Vec<usize> {
    let onward = |v: usize, w: usize, x: usize| problem.distance(w, x) + turning * problem.turn(v, w, x);
    let goes_on = |paths: &Paths, v: usize, w: usize| match paths.beside[w][..] {
        [x] => onward(v, w, x),
        _ => {
            let free = problem.near(w).iter().map(|near| near.node).filter(|&x| x != v && paths.has_free_end(x));
            free.map(|x| onward(v, w, x)).fold(f64::INFINITY, f64::min)
        }
    };
    let turns_at = |paths: &Paths, v: usize, w: usize| match paths.beside[w][..] {
        [x] => turning * problem.turn(v, w, x),
        _ => 0.0,
    };
    let near = |paths: &Paths, a: usize, b: usize| {
        problem.distance(a, b) + 0.5 * (goes_on(paths, a, b) + goes_on(paths, b, a))
    };
    let far =
        |paths: &Paths, a: usize, b: usize| problem.distance(a, b) + turns_at(paths, a, b) + turns_at(paths, b, a);
    joined(problem, preferred, near, far)
}

/// Edges joined to one path through all points: those of `preferred` first, then those to near points by the cost `near`, then those
/// between the ends of what is there by the cost `far`; never a third edge at a point, and never a loop.
fn joined<M: Manifold>(
    problem: &Problem<M>,
    preferred: &[(usize, usize)],
    near: impl Fn(&Paths, usize, usize) -> f64,
    far: impl Fn(&Paths, usize, usize) -> f64,
) -> Vec<usize> {
    let n = problem.len();
    let mut paths = Paths::new(n);
    paths.grow(preferred.iter().copied(), |_, a, b| problem.distance(a, b));
    paths.grow((0..n).flat_map(|v| problem.near(v).iter().map(move |near| (v, near.node))), near);
    let ends: Vec<usize> = (0..n).filter(|&v| paths.has_free_end(v)).collect();
    paths.grow(ends.iter().enumerate().flat_map(|(k, &a)| ends[k + 1..].iter().map(move |&b| (a, b))), far);
    paths.walk()
}

struct Paths {
    beside: Vec<Vec<usize>>,
    joined: UnionFind<usize>,
}

impl Paths {
    fn new(n: usize) -> Self {
        Self { beside: vec![Vec::new(); n], joined: UnionFind::new(n) }
    }
    fn has_free_end(&self, v: usize) -> bool {
        self.beside[v].len() < 2
    }
    /// Joins pairs, the cheapest first. A cost must not fall while the paths grow: then it needs to be looked at again only when it
    /// has come to be the least.
    fn grow(&mut self, pairs: impl Iterator<Item = (usize, usize)>, cost: impl Fn(&Self, usize, usize) -> f64) {
        let mut pairs: Vec<_> = pairs.map(|(a, b)| (a.min(b), a.max(b))).collect();
        pairs.sort_unstable();
        pairs.dedup();
        // Of numbers that are not negative, the greater has the greater bits.
        let ranked = |paths: &Self, a: usize, b: usize| Reverse((cost(paths, a, b).to_bits(), a, b));
        let mut queue: BinaryHeap<_> = pairs.into_iter().map(|(a, b)| ranked(self, a, b)).collect();
        while let Some(cheapest) = queue.pop() {
            let Reverse((_, a, b)) = cheapest;
            if !self.has_free_end(a) || !self.has_free_end(b) || self.joined.equiv(a, b) {
                continue;
            }
            let now = ranked(self, a, b);
            // The other way round, as what costs least comes first.
            if now < cheapest {
                queue.push(now);
            } else {
                self.beside[a].push(b);
                self.beside[b].push(a);
                self.joined.union(a, b);
            }
        }
    }
    fn walk(&self) -> Vec<usize> {
        let mut at = (0..self.beside.len()).find(|&v| self.beside[v].len() < 2);
        let mut path = Vec::with_capacity(self.beside.len());
        while let Some(v) = at {
            at = self.beside[v].iter().copied().find(|&w| path.last() != Some(&w));
            path.push(v);
        }
        path
    }
}
