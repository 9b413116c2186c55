//! Distinct points in order, with the geometry that the tests on an order need.

use std::sync::Arc;

use se3_geom::Manifold;

/// A polygon on a manifold: position k holds `point(k)`, which stands in input row `rows[k]`.
///
/// It has its own copy of the points, in order: of many points in input rows every second one would have to be waited for.
pub(crate) struct Curve<'a, M: Manifold> {
    pub(crate) manifold: &'a M,
    points: Arc<[M::Point]>,
    pub(crate) rows: &'a [usize],
    pub(crate) closed: bool,
}

impl<'a, M: Manifold> Curve<'a, M> {
    pub(crate) fn new(manifold: &'a M, points: &'a [M::Point], rows: &'a [usize], closed: bool) -> Self {
        Self { manifold, points: rows.iter().map(|&row| points[row].clone()).collect(), rows, closed }
    }
    /// The same points as a loop.
    pub(crate) fn joined(&self) -> Self {
        Self { points: Arc::clone(&self.points), closed: true, ..*self }
    }
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }
    pub(crate) fn point(&self, k: usize) -> &M::Point {
        &self.points[k]
    }
    pub(crate) fn distance(&self, a: usize, b: usize) -> f64 {
        self.manifold.distance(self.point(a), self.point(b))
    }
    pub(crate) fn previous(&self, k: usize) -> Option<usize> {
        match k {
            0 => self.closed.then(|| self.len() - 1),
            _ => Some(k - 1),
        }
    }
    pub(crate) fn next(&self, k: usize) -> Option<usize> {
        match k + 1 {
            next if next == self.len() => self.closed.then_some(0),
            next => Some(next),
        }
    }
    pub(crate) fn are_neighbours(&self, i: usize, j: usize) -> bool {
        self.next(i) == Some(j) || self.next(j) == Some(i)
    }
    /// Gap k leads from position k to `next(k)`.
    pub(crate) fn gaps(&self) -> Vec<f64> {
        (0..self.len()).filter_map(|k| Some(self.distance(k, self.next(k)?))).collect()
    }
    /// The tangent vector at position `at` that leads to position `goal`; `None` on the cut locus.
    pub(crate) fn log(&self, at: usize, goal: usize) -> Option<M::Tangent> {
        self.manifold.log(self.point(at), self.point(goal)).ok()
    }
    /// Cosine of the angle at position `at` between the geodesics to `a` and `b`; `None` on the cut locus.
    pub(crate) fn cosine(&self, at: usize, a: usize, b: usize) -> Option<f64> {
        let (u, v) = (self.log(at, a)?, self.log(at, b)?);
        let p = self.point(at);
        Some(self.manifold.inner(p, u, v) / (self.manifold.norm(p, u) * self.manifold.norm(p, v)))
    }
    /// Cosine of the angle between the neighbours of position k, if it is at most a right angle: the order turns back there.
    pub(crate) fn turn_back(&self, k: usize) -> Option<f64> {
        self.cosine(k, self.previous(k)?, self.next(k)?).filter(|&cosine| cosine >= 0.0)
    }
    pub(crate) fn turns_back(&self) -> bool {
        (0..self.len()).any(|k| self.turn_back(k).is_some())
    }
    pub(crate) fn rows_at(&self, a: usize, b: usize) -> [usize; 2] {
        [self.rows[a], self.rows[b]]
    }
}
