//! What a tour costs: distances and turning, with the near ones of every point at hand.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use se3_geom::Manifold;

/// How many nearest points every point may be joined to by one move of the search.
const NEIGHBOURS: usize = 12;

/// What an end of an open path costs, in units of its turning back there: a point goes on nowhere in any order, but an order that
/// could leave a turn unpaid at either end would put its ends in the bends of the curve.
const END: f64 = 0.5;

/// Points on a manifold, and one more node, [`Problem::opening`], that is at distance 0 from all: a closed tour through it is an
/// open path through the points.
pub(crate) struct Problem<'a, M: Manifold> {
    manifold: &'a M,
    points: &'a [M::Point],
    near: Vec<Near<M::Tangent>>,
    /// The nodes of `near` by themselves, which are looked up all the time.
    near_nodes: Vec<u32>,
    each: usize,
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
    /// O(n²) time, O(n) memory.
    pub(crate) fn new(manifold: &'a M, points: &'a [M::Point]) -> Self {
        let each = NEIGHBOURS.min(points.len().saturating_sub(1));
        let mut near = Vec::with_capacity(each * points.len());
        let mut all = Vec::with_capacity(points.len());
        for (v, p) in points.iter().enumerate() {
            all.clear();
            all.extend((0..points.len()).filter(|&w| w != v).map(|w| (manifold.distance(p, &points[w]), w)));
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
        let near_nodes = near.iter().map(|near| near.node as u32).collect();
        Self { manifold, points, near, near_nodes, each, was_cut_short: AtomicBool::new(false) }
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
    fn find(&self, v: usize, w: usize) -> Option<&Near<M::Tangent>> {
        let nodes = &self.near_nodes[v * self.each..(v + 1) * self.each];
        nodes.iter().position(|&node| node == w as u32).map(|k| &self.near[v * self.each + k])
    }
    pub(crate) fn distance(&self, a: usize, b: usize) -> f64 {
        if a == self.opening() || b == self.opening() {
            return 0.0;
        }
        match self.find(a, b) {
            Some(near) => near.distance,
            // From the smaller one, so that no tour is longer in one direction than in the other.
            None => self.manifold.distance(&self.points[a.min(b)], &self.points[a.max(b)]),
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
        match self.log(p, a).zip(self.log(p, b)) {
            Some((u, v)) => self.manifold.norm(&self.points[p], u + v),
            // The most that the sum can be, where the direction is not unique.
            None => self.distance(p, a) + self.distance(p, b),
        }
    }
}
