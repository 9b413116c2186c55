//! What a tour costs: distances and turning, with the near ones of every point at hand.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use se3_geom::Manifold;

/// How many nearest points every point may be joined to by one move of the search.
const NEIGHBOURS: usize = 12;

/// Pairs of them.
const PAIRS: usize = NEIGHBOURS * (NEIGHBOURS - 1) / 2;
const NOBODY: u32 = u32::MAX;
/// Of up to so many points all distances are kept: 32 MB at most.
const MOST_KEPT: usize = 2000;

/// What an end of an open path costs, in units of its turning back there: a point goes on nowhere in any order, but an order that
/// could leave a turn unpaid at either end would put its ends in the bends of the curve.
const END: f64 = 0.5;

/// Points on a manifold, and one more node, [`Problem::opening`], that is at distance 0 from all: a closed tour through it is an
/// open path through the points.
pub(crate) struct Problem<'a, M: Manifold> {
    manifold: &'a M,
    points: &'a [M::Point],
    near: Vec<Near<M::Tangent>>,
    /// The nodes of `near` by themselves, which are looked up all the time; [`NOBODY`] beyond the last.
    near_nodes: Vec<[u32; NEIGHBOURS]>,
    /// [`Problem::turn`] at every point between two of its near ones, by [`pair`]: most of what a search asks for.
    turns: Vec<[f64; PAIRS]>,
    each: usize,
    /// All distances, row by row; none where there are too many.
    distances: Vec<f64>,
    was_cut_short: AtomicBool,
}

/// A near point, with what joins it.
pub(crate) struct Near<T> {
    pub(crate) node: usize,
    pub(crate) distance: f64,
    /// `None` on the cut locus.
    log: Option<T>,
}

impl<T: Copy> Near<T> {
    /// The tangent vector that leads there; `None` on the cut locus.
    pub(crate) fn log(&self) -> Option<T> {
        self.log
    }
}

impl<'a, M: Manifold> Problem<'a, M> {
    /// O(n²) time, O(n) memory beyond [`MOST_KEPT`] points.
    pub(crate) fn new(manifold: &'a M, points: &'a [M::Point]) -> Self {
        let n = points.len();
        let each = NEIGHBOURS.min(n.saturating_sub(1));
        // From the smaller one, so that no tour is longer in one direction than in the other.
        let measured = |a: usize, b: usize| manifold.distance(&points[a.min(b)], &points[a.max(b)]);
        let mut distances = Vec::new();
        if n <= MOST_KEPT {
            distances = vec![0.0; n * n];
            for (a, b) in (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b))) {
                let distance = measured(a, b);
                distances[a * n + b] = distance;
                distances[b * n + a] = distance;
            }
        }
        let distance = |a: usize, b: usize| distances.get(a * n + b).copied().unwrap_or_else(|| measured(a, b));
        let mut near = Vec::with_capacity(each * n);
        let mut all = Vec::with_capacity(n);
        for (v, p) in points.iter().enumerate() {
            all.clear();
            all.extend((0..n).filter(|&w| w != v).map(|w| (distance(v, w), w)));
            let closer = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
            if each > 0 && each < all.len() {
                all.select_nth_unstable_by(each - 1, closer);
                all.truncate(each);
            }
            all.sort_unstable_by(closer);
            near.extend(all.iter().map(|&(distance, node)| Near {
                node,
                distance,
                log: manifold.log(p, &points[node]).ok(),
            }));
        }
        let of_point = |v: usize| &near[v * each..(v + 1) * each];
        let nodes = |v| std::array::from_fn(|k| of_point(v).get(k).map_or(NOBODY, |near| near.node as u32));
        let near_nodes = (0..points.len()).map(nodes).collect();
        let turns = points.iter().enumerate().map(|(v, p)| turns_between(manifold, p, of_point(v))).collect();
        Self { manifold, points, near, near_nodes, turns, each, distances, was_cut_short: AtomicBool::new(false) }
    }
    /// Notes that a search ended before no move gained.
    pub(super) fn cut_short(&self) {
        self.was_cut_short.store(true, Relaxed);
    }
    /// Whether a search ended before no move gained.
    pub(crate) fn was_cut_short(&self) -> bool {
        self.was_cut_short.load(Relaxed)
    }
    /// How many points there are.
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }
    /// The node that stands between the last and the first point of an open path.
    pub(crate) fn opening(&self) -> usize {
        self.points.len()
    }
    /// Ascending by distance; none for the opening.
    pub(crate) fn near(&self, v: usize) -> &[Near<M::Tangent>] {
        if v == self.opening() { &[] } else { &self.near[v * self.each..(v + 1) * self.each] }
    }
    /// Where w stands among the near points of v. All of them are compared, without a branch: so the processor does it at once.
    fn slot(&self, v: usize, w: usize) -> Option<usize> {
        let found = |mask, (k, &node): (usize, &u32)| mask | (u32::from(node == w as u32) << k);
        let mask = self.near_nodes[v].iter().enumerate().fold(0, found);
        (mask != 0).then(|| mask.trailing_zeros() as usize)
    }
    fn find(&self, v: usize, w: usize) -> Option<&Near<M::Tangent>> {
        self.slot(v, w).map(|k| &self.near[v * self.each + k])
    }
    pub(crate) fn distance(&self, a: usize, b: usize) -> f64 {
        if a == self.opening() || b == self.opening() {
            return 0.0;
        }
        match self.distances.get(a * self.points.len() + b) {
            Some(&distance) => distance,
            None => self.find(a, b).map_or_else(
                || self.manifold.distance(&self.points[a.min(b)], &self.points[a.max(b)]),
                |near| near.distance,
            ),
        }
    }
    fn log(&self, p: usize, q: usize) -> Option<M::Tangent> {
        match self.find(p, q) {
            Some(near) => near.log,
            None => self.manifold.log(&self.points[p], &self.points[q]).ok(),
        }
    }
    /// Whether a and b are the neighbours that NN-CRUST (Dey and Kumar, 1999) gives v: the nearest point, and the nearest on
    /// its other side.
    pub(crate) fn are_natural(&self, a: usize, v: usize, b: usize) -> bool {
        let near = self.near(v);
        let Some((first, Some(ahead))) = near.first().map(|first| (first, first.log)) else { return false };
        let behind = |near: &&Near<M::Tangent>| {
            near.log.is_some_and(|log| self.manifold.inner(&self.points[v], ahead, log) < 0.0)
        };
        let Some(second) = near.iter().find(behind) else { return false };
        (first.node, second.node) == (a, b) || (first.node, second.node) == (b, a)
    }
    /// ‖log_p(a) + log_p(b)‖: 0 where the path goes straight on through p in even steps, twice the step where it turns back. At an end
    /// half the step.
    pub(crate) fn turn(&self, a: usize, p: usize, b: usize) -> f64 {
        let opening = self.opening();
        if p == opening {
            return 0.0;
        }
        if a == opening || b == opening {
            return END * self.distance(p, if a == opening { b } else { a });
        }
        match (self.slot(p, a), self.slot(p, b)) {
            (Some(i), Some(j)) if i != j => self.turns[p][pair(i.min(j), i.max(j))],
            _ => {
                let logs = self.log(p, a).zip(self.log(p, b));
                turn_of(self.manifold, &self.points[p], logs, || self.distance(p, a) + self.distance(p, b))
            }
        }
    }
}

/// Where the pair i < j stands in a list of all pairs.
fn pair(i: usize, j: usize) -> usize {
    j * (j - 1) / 2 + i
}

fn turns_between<M: Manifold>(manifold: &M, p: &M::Point, near: &[Near<M::Tangent>]) -> [f64; PAIRS] {
    let mut turns = [0.0; PAIRS];
    for (j, b) in near.iter().enumerate() {
        for (i, a) in near[..j].iter().enumerate() {
            turns[pair(i, j)] = turn_of(manifold, p, a.log.zip(b.log), || a.distance + b.distance);
        }
    }
    turns
}

/// Where a direction is not unique, the most that the sum can be: both distances.
fn turn_of<M: Manifold>(
    manifold: &M,
    p: &M::Point,
    logs: Option<(M::Tangent, M::Tangent)>,
    both_distances: impl FnOnce() -> f64,
) -> f64 {
    logs.map_or_else(both_distances, |(u, v)| manifold.norm(p, u + v))
}
