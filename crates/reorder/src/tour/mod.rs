//! Short tours that turn little: Σ distance + λ Σ ‖log_p(previous) + log_p(next)‖ made small by local search.
//!
//! Exchanges of two edges and moves of up to three nodes (Or, *Traveling salesman-type combinatorial problems*, 1976) over lists
//! of near points, with local double-bridge kicks (Martin, Otto, Felten 1991). Deterministic.

mod problem;
mod random;
mod ring;
mod search;
mod start;
#[cfg(test)]
mod tests;

use se3_geom::Manifold;

pub(crate) use problem::Problem;
use search::Search;
pub(crate) use start::starts;

/// How long to search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Effort {
    /// Until no single move gains.
    Descent,
    /// With kicks.
    Kicks,
}

impl Effort {
    fn kicks_per_node(self) -> usize {
        match self {
            Self::Descent => 0,
            Self::Kicks => 5,
        }
    }
}

/// An open path through all points: the cheaper of those found from two paths.
pub(crate) fn open_path<M: Manifold>(
    problem: &Problem<M>,
    turning: f64,
    starts: [Vec<usize>; 2],
    effort: Effort,
) -> Vec<usize> {
    let [short, smooth] = starts.map(|mut start| {
        start.push(problem.opening());
        let nodes = Search::new(problem, turning, start).run(effort.kicks_per_node());
        Search::new(problem, turning, nodes)
    });
    let mut nodes = if smooth.cost() < short.cost() { smooth } else { short }.into_nodes();
    let opening = nodes.iter().position(|&v| v == problem.opening()).unwrap_or(0);
    nodes.rotate_left(opening);
    nodes.remove(0);
    nodes
}

/// A closed tour through all points, from the tour `start`.
pub(crate) fn closed_tour<M: Manifold>(
    problem: &Problem<M>,
    turning: f64,
    start: Vec<usize>,
    effort: Effort,
) -> Vec<usize> {
    Search::new(problem, turning, start).run(effort.kicks_per_node())
}
