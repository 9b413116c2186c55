//! Whether an order hangs on how it was found.

use se3_geom::Manifold;

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
const MOST_DOUBTS: usize = 20;
/// After so many doubts no other search is made: each costs as much as the order itself.
pub(crate) const ENOUGH_DOUBTS: usize = 8;

/// What other searches say to an order.
pub(crate) struct Agreement {
    /// Whether every other weight gives the same order; `None` where none was tried.
    pub(crate) weight_stable: Option<bool>,
    pub(crate) doubts: Vec<Doubt>,
}

type Edges = Vec<(usize, usize)>;

/// One doubt for every variant under which the minimum spanning tree gives other neighbours.
pub(crate) fn of_trees<M: Manifold>(
    recovery: &Recovery,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Vec<Doubt>, OrderError> {
    let edges = recovery.bonds();
    let mut found = Vec::new();
    for Variant { manifold, change } in variants {
        let kept = recover(manifold, points, options, None)?.bonds();
        if kept == edges {
            continue;
        }
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
/// metric gives other neighbours, until there are doubts enough.
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
) -> Agreement {
    let edges = found.edges(name);
    let solve = |manifold: &M, problem: &Problem<M>, turning: f64, preferred: &[_]| {
        sequence(manifold, points, problem, turning, preferred, options.topology).edges(name)
    };
    let mut doubts: Vec<Doubt> = Vec::new();
    let mut collect = |other: Edges, how: &str| {
        let more = disagreements(&edges, &other, how);
        let agrees = more.is_empty();
        doubts.extend(
            more.into_iter().filter(|doubt| doubts.iter().all(|known| known.at != doubt.at)).collect::<Vec<_>>(),
        );
        (agrees, doubts.len() < ENOUGH_DOUBTS)
    };
    let (mut weight_stable, mut go_on) = (None, true);
    for turning in OTHER_TURNINGS {
        if go_on {
            let how = match turning {
                0.0 => "by length alone, whatever the path turns".to_owned(),
                _ => format!("with turns at {turning} times their price in length in place of {TURNING}"),
            };
            (_, go_on) = collect(solve(manifold, problem, turning, &[]), &how);
        }
    }
    if go_on {
        (_, go_on) = collect(
            solve(manifold, problem, TURNING, tree_edges),
            "if the search starts from the minimum spanning tree",
        );
    }
    for Variant { manifold, change } in variants {
        if go_on {
            let (agrees, more) = collect(solve(manifold, &Problem::new(manifold, points), TURNING, &[]), change);
            weight_stable = Some(agrees && weight_stable != Some(false));
            go_on = more;
        }
    }
    if problem.was_cut_short() {
        let why = "a search ended at its limit of moves before no move made the order shorter".to_owned();
        doubts.push(Doubt { at: [found.rows[0], found.rows[found.rows.len() - 1]], why });
    }
    Agreement { weight_stable, doubts }
}

fn disagreements(edges: &Edges, other: &Edges, how: &str) -> Vec<Doubt> {
    let lost = edges.iter().filter(|edge| other.binary_search(edge).is_err());
    let gained = other.iter().filter(|edge| edges.binary_search(edge).is_err());
    let lost: Vec<_> = lost
        .map(|&(i, j)| Doubt {
            at: [i, j],
            why: format!("{how}, these two are no neighbours: a point of the curve between them would settle it"),
        })
        .collect();
    let doubts = if lost.is_empty() {
        gained.map(|&(i, j)| Doubt { at: [i, j], why: format!("{how}, the curve is closed here") }).collect()
    } else {
        lost
    };
    doubts.into_iter().take(MOST_DOUBTS).collect()
}
