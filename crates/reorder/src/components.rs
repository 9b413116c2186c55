//! Several curves in one set of points.

use petgraph::unionfind::UnionFind;
use petgraph::visit::EdgeRef;
use se3_geom::Manifold;

use crate::duplicates::ROUNDING_SHARE;
use crate::error::{OrderError, check_points};
use crate::order::order;
use crate::ordering::{Options, Ordering};
use crate::spanning_tree::{Tree, minimum_spanning_tree};

/// Curves are apart if the tree's edge between them is at least this many times the longest edge within either. The longest of
/// n gaps between independent points of one curve is three times the next about once in n² sets.
pub const APART: f64 = 3.0;
/// A curve has at least this many points; fewer, far from all curves, are outliers.
pub const FEWEST_OF_A_CURVE: usize = 3;
/// More pieces than one in this many points are no curves but clumps of points on one curve.
const POINTS_PER_PIECE: usize = 8;

/// Rows that belong together, and how clearly.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// The rows of each curve, ascending; the curves by their first row.
    pub curves: Vec<Vec<usize>>,
    /// Rows of pieces of one or two points, ascending.
    pub outliers: Vec<usize>,
    /// Least ratio of an edge that was cut to the longest edge of the pieces at its ends that are curves; `None` where nothing was cut.
    pub separation: Option<f64>,
}

/// One of several curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Its input rows, ascending.
    pub rows: Vec<usize>,
    /// Its order by itself; there, row k stands for input row `rows[k]`.
    pub ordering: Ordering,
}

impl Component {
    /// The input rows in order.
    pub fn order(&self) -> Vec<usize> {
        self.ordering.order.iter().map(|&k| self.rows[k]).collect()
    }
}

/// Several curves, each in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Components {
    /// The curves, by their first row.
    pub curves: Vec<Component>,
    /// Rows that belong to none, ascending.
    pub outliers: Vec<usize>,
    /// As in [`Split`].
    pub separation: Option<f64>,
}

/// Cuts a minimum spanning tree at its longest edges where the next shorter one is shorter by [`APART`] or more, and then each
/// piece in the same way.
///
/// By the theorem in the [crate documentation](crate#certified), carried to several curves of joint reach ρ: gaps are below 2ρ,
/// and different curves are 2ρ apart or more. So there is a length that divides both, and a wide jump in the tree's lengths shows
/// it; curves of different density are told apart by doing so again within each piece. Nothing is cut where that would leave more
/// than one piece in eight points, or no curve.
pub fn split(tree: &Tree) -> Split {
    let mut pieces = vec![tree.node_indices().map(|node| tree[node]).collect::<Vec<usize>>()];
    let mut edges: Vec<(f64, [usize; 2])> =
        tree.edge_references().map(|e| (*e.weight(), [e.source().index(), e.target().index()])).collect();
    edges.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let (mut done, mut separation) = (Vec::new(), None);
    let node_of: std::collections::HashMap<usize, usize> =
        tree.node_indices().map(|node| (tree[node], node.index())).collect();
    while let Some(rows) = pieces.pop() {
        let mut inside = vec![false; tree.node_count()];
        rows.iter().for_each(|row| inside[node_of[row]] = true);
        let within: Vec<_> = edges.iter().copied().filter(|(_, [a, b])| inside[*a] && inside[*b]).collect();
        match jump(&within, rows.len()).map(|cut| (cut, parts(tree, &rows, &node_of, &within[cut..]))) {
            Some((cut, parts)) if parts.iter().any(|part| part.len() >= FEWEST_OF_A_CURVE) => {
                let ratio = within[cut - 1].0 / within[cut].0;
                separation = Some(separation.map_or(ratio, |least: f64| least.min(ratio)));
                pieces.extend(parts);
            }
            _ => done.push(rows),
        }
    }
    done.sort();
    let (curves, few): (Vec<_>, Vec<_>) = done.into_iter().partition(|rows| rows.len() >= FEWEST_OF_A_CURVE);
    let mut outliers: Vec<usize> = few.into_iter().flatten().collect();
    outliers.sort_unstable();
    Split { curves, outliers, separation }
}

/// How many of the edges, longest first, stand before the first jump. Edges between equal points are none.
fn jump(edges: &[(f64, [usize; 2])], points: usize) -> Option<usize> {
    let rounding = ROUNDING_SHARE * edges.first()?.0;
    let most = points / POINTS_PER_PIECE;
    let jumps = |k: &usize| edges[*k].0 > rounding && edges[k - 1].0 >= APART * edges[*k].0;
    (1..edges.len()).take(most).find(jumps)
}

/// The rows that the edges hold together, each ascending.
fn parts(
    tree: &Tree,
    rows: &[usize],
    node_of: &std::collections::HashMap<usize, usize>,
    edges: &[(f64, [usize; 2])],
) -> Vec<Vec<usize>> {
    let mut joined = UnionFind::<usize>::new(tree.node_count());
    for &(_, [a, b]) in edges {
        joined.union(a, b);
    }
    let mut parts = std::collections::BTreeMap::<usize, Vec<usize>>::new();
    for row in rows {
        parts.entry(joined.find(node_of[row])).or_default().push(*row);
    }
    let mut parts: Vec<_> = parts.into_values().collect();
    parts.iter_mut().for_each(|part| part.sort_unstable());
    parts
}

/// Orders each of several curves by itself, with its own topology. `options.start` applies to the curve that holds that row.
///
/// # Errors
/// As [`order`](crate::order()).
pub fn order_components<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    options: &Options,
) -> Result<Components, OrderError> {
    check_points(manifold, points)?;
    let Split { curves, outliers, separation } = split(&minimum_spanning_tree(manifold, points)?);
    let mut found = Components { curves: Vec::new(), outliers, separation };
    for rows in curves {
        let own: Vec<M::Point> = rows.iter().map(|&row| points[row].clone()).collect();
        let start = options.start.and_then(|start| rows.binary_search(&start).ok());
        match order(manifold, &own, &Options { start, ..*options }) {
            Ok(ordering) => found.curves.push(Component { rows, ordering }),
            // One point that came several times, beside curves.
            Err(OrderError::AllEqual { .. } | OrderError::TooFewDistinct { .. }) if rows.len() < points.len() => {
                found.outliers.extend(rows);
            }
            Err(error) => return Err(error),
        }
    }
    found.outliers.sort_unstable();
    Ok(found)
}
