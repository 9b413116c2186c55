//! Near pairs of points on an ordered curve, found in near-linear time on any manifold.

use se3_geom::Manifold;

use crate::curve::Curve;

/// Runs of at most this many points are not divided further.
const LEAF: usize = 12;

/// A search over pairs of positions.
pub(crate) trait PairSearch {
    /// Pairs within this distance matter wherever they are; it may shrink as the search goes on.
    fn everywhere(&self) -> f64;
    /// A pair of positions i < j and its distance. Pairs that are farther apart than asked for may come too.
    fn visit(&mut self, i: usize, j: usize, distance: f64);
}

/// A ball around a run of consecutive points: `centre` is one of them.
struct Run {
    first: usize,
    end: usize,
    centre: usize,
    radius: f64,
    /// Greatest search radius in the run.
    wanted: f64,
    children: Option<[usize; 2]>,
}

/// A tree of balls around runs of a curve: nothing but the triangle inequality is used, and a curve sampled in order fills
/// its balls with neighbours, so that a join of the tree with itself visits O(n) pairs beyond those that are near.
pub(crate) struct Runs<'a, 'b, M: Manifold> {
    curve: &'a Curve<'b, M>,
    positions: &'a [usize],
    runs: Vec<Run>,
}

impl<'a, 'b, M: Manifold> Runs<'a, 'b, M> {
    /// `positions` ascend; `wanted[k]` is the radius within which `positions[k]` looks for others.
    pub(crate) fn new(curve: &'a Curve<'b, M>, positions: &'a [usize], wanted: &[f64]) -> Self {
        let mut tree = Self { curve, positions, runs: Vec::with_capacity(positions.len() / LEAF * 4 + 1) };
        if !positions.is_empty() {
            tree.divide(0, positions.len(), wanted);
        }
        tree
    }

    fn divide(&mut self, first: usize, end: usize, wanted: &[f64]) -> usize {
        let id = self.runs.len();
        let middle = usize::midpoint(first, end);
        let centre = self.positions[middle];
        let leaf = end - first <= LEAF;
        let wanted_here = if leaf { wanted[first..end].iter().copied().fold(0.0, f64::max) } else { 0.0 };
        self.runs.push(Run { first, end, centre, radius: 0.0, wanted: wanted_here, children: None });
        if leaf {
            let distances = self.positions[first..end].iter().map(|&k| self.curve.distance(centre, k));
            self.runs[id].radius = distances.fold(0.0, f64::max);
        } else {
            let children = [self.divide(first, middle, wanted), self.divide(middle, end, wanted)];
            for child in children {
                let Run { centre: inner, radius, wanted, .. } = self.runs[child];
                let extent = self.curve.distance(centre, inner) + radius;
                self.runs[id].radius = self.runs[id].radius.max(extent);
                self.runs[id].wanted = self.runs[id].wanted.max(wanted);
            }
            self.runs[id].children = Some(children);
        }
        id
    }

    /// Visits every pair nearer than either point's wanted radius, or than [`PairSearch::everywhere`].
    pub(crate) fn join(&self, search: &mut impl PairSearch) {
        if !self.runs.is_empty() {
            self.join_within(0, search);
        }
    }

    fn join_within(&self, id: usize, search: &mut impl PairSearch) {
        let run = &self.runs[id];
        match run.children {
            Some([left, right]) => {
                self.join_within(left, search);
                self.join_within(right, search);
                self.join_between(left, right, search);
            }
            None => {
                for a in run.first..run.end {
                    self.visit_row(a, a + 1..run.end, search);
                }
            }
        }
    }

    fn join_between(&self, left: usize, right: usize, search: &mut impl PairSearch) {
        let (a, b) = (&self.runs[left], &self.runs[right]);
        let apart = self.curve.distance(a.centre, b.centre) - a.radius - b.radius;
        // The sum of two distances is rounded: one part in 1e12 more is many times that.
        if apart > a.wanted.max(b.wanted).max(search.everywhere()) * (1.0 + 1e-12) {
            return;
        }
        match (a.children, b.children) {
            (Some(parts), _) if a.radius >= b.radius || b.children.is_none() => {
                parts.into_iter().for_each(|part| self.join_between(part, right, search));
            }
            (_, Some(parts)) => parts.into_iter().for_each(|part| self.join_between(left, part, search)),
            _ => {
                for k in a.first..a.end {
                    self.visit_row(k, b.first..b.end, search);
                }
            }
        }
    }

    fn visit_row(&self, a: usize, others: std::ops::Range<usize>, search: &mut impl PairSearch) {
        let i = self.positions[a];
        for &j in &self.positions[others] {
            search.visit(i, j, self.curve.distance(i, j));
        }
    }
}
