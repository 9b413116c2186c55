//! Orders where the minimum spanning tree is no path, or a path that something speaks against.

use se3_geom::Manifold;
use tracing::debug_span;

use crate::curve::Curve;
use crate::ordering::TopologyChoice;
use crate::topology::{Closing, closing, may_be_open};
use crate::tour::{Effort, Problem, closed_tour, open_path, starts};

/// What a unit of turning costs in units of length where the order is taken from.
pub(crate) const TURNING: f64 = 3.0;
/// A closed tour may be longer than the open path by this many times the path's longest edge.
const CLOSING_COST: f64 = 2.0;
/// How many times that is worth a longer search for a shorter tour.
const WORTH_A_SEARCH: f64 = 4.0;

/// A sequence of all rows, equal points apart.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sequence {
    pub(crate) rows: Vec<usize>,
    pub(crate) closed: bool,
    pub(crate) unsure_of_ends: bool,
}

/// The path through the points that is short and turns little; closed where its ends meet.
pub(crate) fn sequence<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    problem: &Problem<M>,
    turning: f64,
    preferred: &[(usize, usize)],
    topology: TopologyChoice,
) -> Sequence {
    let _phase = debug_span!("search").entered();
    let open = open_path(problem, turning, starts(problem, turning, preferred), Effort::Kicks);
    if topology == TopologyChoice::Open {
        return Sequence { rows: open, closed: false, unsure_of_ends: false };
    }
    let gaps = |rows: &[usize]| rows.windows(2).map(|w| problem.distance(w[0], w[1])).collect::<Vec<_>>();
    let longest = gaps(&open).into_iter().fold(0.0, f64::max);
    let open_length = gaps(&open).iter().sum::<f64>();
    let closes = |tour: &[usize], allowed: f64| {
        let closing_gap = problem.distance(tour[0], tour[tour.len() - 1]);
        gaps(tour).iter().sum::<f64>() + closing_gap <= open_length + allowed * longest
    };
    // A loop that is far from worth it needs no long search.
    let mut tour = closed_tour(problem, turning, open.clone(), Effort::Descent);
    if topology == TopologyChoice::Closed || closes(&tour, WORTH_A_SEARCH * CLOSING_COST) {
        tour = closed_tour(problem, turning, tour, Effort::Kicks);
    }
    cut_at_longest(problem, &mut tour);
    if topology == TopologyChoice::Closed {
        return Sequence { rows: tour, closed: true, unsure_of_ends: false };
    }
    let ends = |rows: &[usize]| closing(&Curve::new(manifold, points, rows, false));
    match ends(&tour) {
        Closing::Meets if closes(&tour, CLOSING_COST) => {
            let unsure_of_ends = may_be_open(&Curve::new(manifold, points, &tour, true).gaps());
            Sequence { rows: tour, closed: true, unsure_of_ends }
        }
        _ => {
            let unsure_of_ends = ends(&open) != Closing::Apart;
            Sequence { rows: open, closed: false, unsure_of_ends }
        }
    }
}

fn cut_at_longest<M: Manifold>(problem: &Problem<M>, tour: &mut [usize]) {
    let n = tour.len();
    let gap = |k: usize| problem.distance(tour[k], tour[(k + 1) % n]);
    let longest = (0..n).reduce(|a, b| if gap(b) > gap(a) { b } else { a }).unwrap_or(0);
    tour.rotate_left((longest + 1) % n);
}

impl Sequence {
    /// The rows, of equal points that stand together the first alone.
    pub(crate) fn distinct_rows(&self, name: &[usize]) -> Vec<usize> {
        let mut rows = self.rows.clone();
        rows.dedup_by_key(|row| name[*row]);
        if self.closed && rows.len() > 1 && name[rows[0]] == name[rows[rows.len() - 1]] {
            rows.pop();
        }
        rows
    }
    /// Neighbours as (smaller, greater), ascending, each once, where `name` gives equal points one name; a point is not its
    /// own neighbour.
    pub(crate) fn edges(&self, name: &[usize]) -> Vec<(usize, usize)> {
        let closing = self.rows.last().zip(self.rows.first()).filter(|_| self.closed);
        let consecutive = self.rows.iter().zip(&self.rows[1..]);
        let named = consecutive.chain(closing).map(|(&a, &b)| (name[a].min(name[b]), name[a].max(name[b])));
        let mut edges: Vec<_> = named.filter(|(a, b)| a != b).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}
