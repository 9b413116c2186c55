//! Short tours that turn little: Σ distance + λ Σ ‖log_p(previous) + log_p(next)‖ made small by local search.
//!
//! Exchanges of two edges and moves of up to three nodes (Or, *Traveling salesman-type combinatorial problems*, 1976) over lists
//! of near points, double bridges between pairs of them, and local double-bridge kicks (Martin, Otto, Felten 1991). Deterministic.

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

/// Tours whose costs differ by less than this share are one: their sums are rounded in another sequence.
const SAME: f64 = 1e-12;
/// How many rounds of kicks are worth their time.
const ROUNDS: usize = 5;
/// How many of the tours that were descended to are kicked.
const KICKED: usize = 2;

/// An open path through all points: the cheapest of those found from `starts`.
pub(crate) fn open_path<M: Manifold>(
    problem: &Problem<M>,
    turning: f64,
    starts: impl IntoIterator<Item = Vec<usize>>,
    effort: Effort,
) -> Vec<usize> {
    let through = |mut start: Vec<usize>| {
        start.push(problem.opening());
        start
    };
    let mut nodes = cheapest(problem, turning, starts.into_iter().map(through), effort);
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
    cheapest(problem, turning, [start], effort)
}

/// The cheapest tour found from `starts`.
fn cheapest<M: Manifold>(
    problem: &Problem<M>,
    turning: f64,
    starts: impl IntoIterator<Item = Vec<usize>>,
    effort: Effort,
) -> Vec<usize> {
    let by_cost = |a: &(f64, Search<M>), b: &(f64, Search<M>)| a.0.total_cmp(&b.0);
    let descended = starts.into_iter().map(|start| {
        let mut search = Search::new(problem, turning, start);
        search.descend();
        (search.cost(), search)
    });
    let mut found: Vec<_> = descended.collect();
    found.sort_by(by_cost);
    if effort == Effort::Kicks {
        // From one tour, the kicks lead to one and the same.
        found.dedup_by(|a, b| a.0 <= b.0 * (1.0 + SAME));
        found.truncate(KICKED);
        for (cost, search) in &mut found {
            search.shake(ROUNDS);
            *cost = search.cost();
        }
        found.sort_by(by_cost);
    }
    found.into_iter().next().map(|(_, search)| search.into_nodes()).unwrap_or_default()
}
