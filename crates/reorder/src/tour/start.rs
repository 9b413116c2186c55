//! Where the search starts: short edges, joined to one path.

use petgraph::unionfind::UnionFind;
use se3_geom::Manifold;

use super::problem::Problem;

/// Edges joined to one path through all points: those of `preferred` first, then the shortest to near points, then the shortest
/// between the ends of what is there; never a third edge at a point, and never a loop.
pub(crate) fn greedy<M: Manifold>(problem: &Problem<M>, preferred: &[(usize, usize)]) -> Vec<usize> {
    let n = problem.len();
    let by_length = |pairs: &mut Vec<(usize, usize)>| {
        let mut edges: Vec<_> = pairs.drain(..).map(|(a, b)| (problem.distance(a, b), a.min(b), a.max(b))).collect();
        edges.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        edges.dedup();
        edges
    };
    let mut paths = Paths::new(n);
    for (_, a, b) in by_length(&mut preferred.to_vec()) {
        paths.join(a, b);
    }
    let mut near: Vec<_> = (0..n).flat_map(|v| problem.near(v).iter().map(move |near| (v, near.node))).collect();
    for (_, a, b) in by_length(&mut near) {
        paths.join(a, b);
    }
    let ends: Vec<usize> = (0..n).filter(|&v| paths.beside[v].len() < 2).collect();
    let mut pairs: Vec<_> =
        ends.iter().enumerate().flat_map(|(k, &a)| ends[k + 1..].iter().map(move |&b| (a, b))).collect();
    for (_, a, b) in by_length(&mut pairs) {
        paths.join(a, b);
    }
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
