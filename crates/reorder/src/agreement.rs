//! Whether an order hangs on how it was found.

use se3_geom::Manifold;

use crate::doubts;
use crate::error::OrderError;
use crate::ordering::{Doubt, Options};
use crate::recovery::{Recovery, recover};
use crate::repair::{Sequence, TURNING, sequence};
use crate::tour::Problem;

/// Another metric under which the order should be the same.
pub(crate) struct Variant<M> {
    pub(crate) manifold: M,
    /// "with half as many metres per radian".
    pub(crate) change: &'static str,
}

/// Prices of turning under which a repaired order must be the same, besides its own.
const OTHER_TURNINGS: [f64; 3] = [0.0, 8.0, 1.0];
/// Doubts that one other search may give.
const MOST_DOUBTS: usize = 30;

type Edges = Vec<(usize, usize)>;

/// One doubt for every variant under which the minimum spanning tree gives other neighbours.
pub(crate) fn of_trees<M: Manifold>(
    recovery: &Recovery,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Vec<Doubt>, OrderError> {
    let edges = recovery.edges();
    let mut found = Vec::new();
    for Variant { manifold, change } in variants {
        let kept = recover(manifold, points, &Options { start: None, ..*options })?.edges();
        let lost: Vec<_> = edges.iter().filter(|edge| kept.binary_search(edge).is_err()).collect();
        // A closing edge is the only one that a curve can gain without losing another.
        let gained = kept.iter().find(|edge| edges.binary_search(edge).is_err());
        if let Some(&(i, j)) = lost.first().copied().or(gained) {
            let why = if lost.is_empty() {
                format!("{change} the curve is closed here")
            } else {
                format!("{change} {} of {} neighbourhoods are lost, this one first", lost.len(), edges.len())
            };
            found.push(Doubt { at: [i, j], why });
        }
    }
    Ok(found)
}

/// Everything that speaks against a repaired order: wherever another price of turning, another start of the search or another
/// metric gives other neighbours. Also whether all metrics agree.
#[expect(clippy::too_many_arguments, reason = "one call")]
pub(crate) fn examine_sequence<M: Manifold>(
    manifold: &M,
    variants: &[Variant<M>],
    points: &[M::Point],
    problem: &Problem<M>,
    found: &Sequence,
    tree_edges: &[(usize, usize)],
    name: &[usize],
    options: &Options,
) -> Result<(bool, Vec<Doubt>), OrderError> {
    let edges = found.edges(name);
    let mut doubts = Vec::new();
    if found.unsure_of_ends {
        doubts.push(doubts::of_ends([found.rows[0], found.rows[found.rows.len() - 1]]));
    }
    let solve = |turning, preferred: &[_]| {
        sequence(manifold, points, problem, turning, preferred, options.topology).edges(name)
    };
    doubts.extend(disagreements(&edges, &solve(TURNING, tree_edges), "searched from the tree"));
    for turning in OTHER_TURNINGS {
        let other = solve(turning, &[]);
        doubts.extend(disagreements(&edges, &other, &format!("with turning at {turning} times its price")));
    }
    let mut stable = true;
    for Variant { manifold, change } in variants {
        let other = sequence(manifold, points, &Problem::new(manifold, points), TURNING, &[], options.topology);
        let more = disagreements(&edges, &other.edges(name), change);
        stable &= more.is_empty();
        doubts.extend(more);
    }
    let mut seen = Vec::new();
    doubts.retain(|doubt| {
        let new = !seen.contains(&doubt.at);
        seen.push(doubt.at);
        new
    });
    Ok((stable, doubts))
}

fn disagreements(edges: &Edges, other: &Edges, how: &str) -> Vec<Doubt> {
    let lost = edges.iter().filter(|edge| other.binary_search(edge).is_err());
    let gained = other.iter().filter(|edge| edges.binary_search(edge).is_err());
    let lost: Vec<_> = lost
        .map(|&(i, j)| Doubt {
            at: [i, j],
            why: format!("{how}, these two are no neighbours; a point between them would settle it"),
        })
        .collect();
    let doubts = if lost.is_empty() {
        gained.map(|&(i, j)| Doubt { at: [i, j], why: format!("{how}, the curve is closed here") }).collect()
    } else {
        lost
    };
    doubts.into_iter().take(MOST_DOUBTS).collect()
}
