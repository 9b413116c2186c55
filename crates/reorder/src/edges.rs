//! The sampling figures of every single gap.

use se3_geom::Manifold;
use serde::Serialize;

use crate::certificate::edge_epsilons;
use crate::curve::Curve;
use crate::ordering::{Ordering, Topology};
use crate::sweep::sweep;
use crate::topology::beyond_ends;

/// How densely the curve is sampled around one gap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EdgeFigures {
    /// Input rows of its ends.
    pub at: [usize; 2],
    /// The distance between them, in the unit of the metric.
    pub gap: f64,
    /// The smaller of the balls that touch the order at either end: the least of those through neighbours, and of those through
    /// any other point that would make ε exceed 0.72. `None` where the points lie on a geodesic.
    pub reach: Option<f64>,
    /// ε = gap/(2·reach), 0 on a geodesic.
    pub epsilon: f64,
}

impl Ordering {
    /// For every gap, in order, what its own ε is: gap k leads from the k-th of the [distinct](Ordering::distinct) points to the next,
    /// the last one of a closed curve back to the first. Between curves that were ordered apart there is no gap.
    ///
    /// `manifold` must be the metric that the points were ordered by. About O(n log n) time.
    pub fn edges<M: Manifold>(&self, manifold: &M, points: &[M::Point]) -> Vec<EdgeFigures> {
        if self.parts.is_empty() {
            return figures(manifold, points, &self.distinct(), self.topology);
        }
        let name = self.names();
        let of_part = |rows: &Vec<usize>, topology| {
            let mut rows = rows.clone();
            rows.dedup_by_key(|row| name[*row]);
            if topology == Topology::Closed && name[rows[0]] == name[rows[rows.len() - 1]] {
                rows.pop();
            }
            figures(manifold, points, &rows, topology)
        };
        self.components.iter().zip(&self.parts).flat_map(|(rows, part)| of_part(rows, part.topology)).collect()
    }
}

fn figures<M: Manifold>(manifold: &M, points: &[M::Point], rows: &[usize], topology: Topology) -> Vec<EdgeFigures> {
    let curve = Curve::new(manifold, points, rows, topology == Topology::Closed);
    let gaps = curve.gaps();
    let found = sweep(&curve, beyond_ends(&gaps));
    let epsilons = edge_epsilons(&gaps, &found);
    let at = |k: usize| curve.rows_at(k, (k + 1) % curve.len());
    let reach = |k: usize| found.balls[k].min(found.balls[(k + 1) % curve.len()]);
    let of_gap = |k: usize| EdgeFigures {
        at: at(k),
        gap: gaps[k],
        reach: Some(reach(k)).filter(|reach| reach.is_finite()),
        epsilon: epsilons[k],
    };
    (0..gaps.len()).map(of_gap).collect()
}
