//! Where the search starts: short edges, joined to one path.

use petgraph::unionfind::UnionFind;
use se3_geom::Manifold;

use super::problem::Problem;

/// Two paths through all points to search from: of the shortest edges, and of the edges that go on well.
///
/// Where a curve runs beside itself, the shortest edges lead across, and from a path that zigzags no single exchange leads back. The
/// edges that cost least with what goes on best at either end lead along. Where it crosses itself, short edges are the better guess.
pub(crate) fn starts<M: Manifold>(problem: &Problem<M>, turning: f64, preferred: &[(usize, usize)]) -> [Vec<usize>; 2] {
    let goes_on = |v: usize, w: usize| {
        let beyond = problem.near(w).iter().filter(|near| near.node != v);
        beyond.map(|near| near.distance + turning * problem.turn(v, w, near.node)).fold(f64::INFINITY, f64::min)
    };
    let distance = |v: usize, w: usize| problem.distance(v, w);
    [
        greedy(problem, distance, preferred),
        greedy(problem, |v, w| distance(v, w) + 0.5 * (goes_on(v, w) + goes_on(w, v)), preferred),
    ]
}

/// Edges joined to one path through all points: those of `preferred` first, then the cheapest to near points, then the shortest
/// between the ends of what is there; never a third edge at a point, and never a loop.
fn greedy<M: Manifold>(
    problem: &Problem<M>,
    cost: impl Fn(usize, usize) -> f64,
    preferred: &[(usize, usize)],
) -> Vec<usize> {
    let n = problem.len();
    let mut paths = Paths::new(n);
    let mut join = |pairs: Vec<(usize, usize)>, cost: &dyn Fn(usize, usize) -> f64| {
        let mut edges: Vec<_> =
            pairs.into_iter().map(|(a, b)| (a.min(b), a.max(b))).map(|(a, b)| (cost(a, b), a, b)).collect();
        edges.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        edges.dedup();
        edges.into_iter().for_each(|(_, a, b)| paths.join(a, b));
        (0..n).filter(|&v| paths.beside[v].len() < 2).collect::<Vec<usize>>()
    };
    let distance = |a: usize, b: usize| problem.distance(a, b);
    join(preferred.to_vec(), &distance);
    let near = (0..n).flat_map(|v| problem.near(v).iter().map(move |near| (v, near.node))).collect();
    let ends = join(near, &cost);
    join(ends.iter().enumerate().flat_map(|(k, &a)| ends[k + 1..].iter().map(move |&b| (a, b))).collect(), &distance);
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
    fn join(&mut self, a: usize, b: usize) {
        if self.beside[a].len() < 2 && self.beside[b].len() < 2 && self.joined.union(a, b) {
            self.beside[a].push(b);
            self.beside[b].push(a);
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
