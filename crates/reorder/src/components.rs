//! Several curves in one set of points.

use petgraph::graph::NodeIndex;
use petgraph::unionfind::UnionFind;
use petgraph::visit::EdgeRef;
use se3_geom::Manifold;

use crate::duplicates::{Distinct, merge};
use crate::error::{OrderError, check_points};
use crate::order::order;
use crate::ordering::{ComponentsChoice, Options, Ordering};
use crate::spanning_tree::{Tree, minimum_spanning_tree};

/// Curves are apart if the tree's edge between them is at least this many times the longest edge within either. The longest of
/// n gaps between independent points of one curve is three times the next about once in n² sets.
pub const APART: f64 = 3.0;
/// A curve has at least this many points; fewer, far from all curves, are outliers.
pub const FEWEST_OF_A_CURVE: usize = 3;
/// More pieces than one in this many points are no curves but clumps of points on one curve.
const POINTS_PER_PIECE: usize = 8;

/// Rows that belong together, and how clearly.
#[derive(Debug, Clone, Default, PartialEq)]
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
    let mut edges: Vec<Edge> =
        tree.edge_references().map(|e| (*e.weight(), [e.source().index(), e.target().index()])).collect();
    edges.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut pieces = vec![Piece { nodes: (0..tree.node_count()).collect(), edges }];
    let mut place = vec![0; tree.node_count()];
    let (mut done, mut separation) = (Vec::new(), None);
    while let Some(piece) = pieces.pop() {
        match piece.jump().map(|cut| (cut, piece.parts(cut, &mut place))) {
            Some((cut, parts)) if parts.iter().any(|part| part.nodes.len() >= FEWEST_OF_A_CURVE) => {
                let ratio = piece.edges[cut - 1].0 / piece.edges[cut].0;
                separation = Some(separation.map_or(ratio, |least: f64| least.min(ratio)));
                pieces.extend(parts);
            }
            _ => {
                let mut rows: Vec<usize> = piece.nodes.iter().map(|&node| tree[NodeIndex::new(node)]).collect();
                rows.sort_unstable();
                done.push(rows);
            }
        }
    }
    done.sort();
    let (curves, few): (Vec<_>, Vec<_>) = done.into_iter().partition(|rows| rows.len() >= FEWEST_OF_A_CURVE);
    let mut outliers: Vec<usize> = few.into_iter().flatten().collect();
    outliers.sort_unstable();
    Split { curves, outliers, separation }
}

/// Length and nodes.
type Edge = (f64, [usize; 2]);

/// A part of the tree.
struct Piece {
    nodes: Vec<usize>,
    /// Longest first.
    edges: Vec<Edge>,
}

impl Piece {
    /// How many of the edges stand before the first jump. Edges between equal points are none.
    fn jump(&self) -> Option<usize> {
        let edges = &self.edges;
        let most = self.nodes.len() / POINTS_PER_PIECE;
        let jumps = |k: &usize| edges[*k].0 > 0.0 && edges[k - 1].0 >= APART * edges[*k].0;
        (1..edges.len()).take(most).find(jumps)
    }

    /// What is left when so many of the longest edges are cut. `place` has room for every node of the tree.
    fn parts(&self, cut: usize, place: &mut [usize]) -> Vec<Piece> {
        self.nodes.iter().enumerate().for_each(|(k, &node)| place[node] = k);
        let mut joined = UnionFind::<usize>::new(self.nodes.len());
        for &(_, [a, b]) in &self.edges[cut..] {
            joined.union(place[a], place[b]);
        }
        let mut part_of_root = vec![usize::MAX; self.nodes.len()];
        let mut parts: Vec<Piece> = Vec::new();
        for (k, &node) in self.nodes.iter().enumerate() {
            let part = &mut part_of_root[joined.find_mut(k)];
            if *part == usize::MAX {
                *part = parts.len();
                parts.push(Piece { nodes: Vec::new(), edges: Vec::new() });
            }
            parts[*part].nodes.push(node);
        }
        for &edge in &self.edges[cut..] {
            parts[part_of_root[joined.find_mut(place[edge.1[0]])]].edges.push(edge);
        }
        parts
    }
}

impl Split {
    /// The same where each row stands for the group that it is the first of; groups ascend.
    pub(crate) fn with_equal_points(self, groups: &[Vec<usize>]) -> Self {
        let all = |rows: Vec<usize>| {
            let group_of =
                |row: usize| groups.binary_search_by_key(&row, |group| group[0]).map_or(&[][..], |k| &groups[k]);
            let mut all: Vec<usize> = rows.into_iter().flat_map(group_of).copied().collect();
            all.sort_unstable();
            all
        };
        Self { curves: self.curves.into_iter().map(all).collect(), outliers: all(self.outliers), ..self }
    }
}

/// Orders each of several curves by itself, with its own topology. `options.start` applies to the curve that holds that row.
///
/// # Errors
/// As [`order`](crate::order()), and [`OrderError::StartApart`].
pub fn order_components<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    options: &Options,
) -> Result<Components, OrderError> {
    check_points(manifold, points)?;
    let distinct = merge(manifold, points, minimum_spanning_tree(manifold, points)?);
    if points.len() > 1 && distinct.tree.node_count() < 2 {
        return Err(OrderError::AllEqual { count: points.len() });
    }
    components_by(points, &distinct, options.start, |own, start| {
        order(manifold, own, &Options { start, components: ComponentsChoice::One, ..*options })
    })
}

/// Each curve as `order_one` orders its points.
pub(crate) fn components_by<P: Clone>(
    points: &[P],
    distinct: &Distinct,
    start: Option<usize>,
    order_one: impl Fn(&[P], Option<usize>) -> Result<Ordering, OrderError>,
) -> Result<Components, OrderError> {
    if let Some(start) = start.filter(|&start| start >= points.len()) {
        return Err(OrderError::StartOutOfRange { start, count: points.len() });
    }
    let Split { curves, outliers, separation } = split(&distinct.tree).with_equal_points(&distinct.groups);
    let mut found = Components { curves: Vec::new(), outliers, separation };
    for rows in curves {
        let own: Vec<P> = rows.iter().map(|&row| points[row].clone()).collect();
        match order_one(&own, start.and_then(|start| rows.binary_search(&start).ok())) {
            Ok(ordering) => found.curves.push(Component { rows, ordering }),
            Err(OrderError::StartNotAnEnd { start, ends }) => {
                return Err(OrderError::start_not_an_end(rows[start], ends.map(|k| rows[k])));
            }
            Err(error) => return Err(error),
        }
    }
    found.outliers.sort_unstable();
    match start.filter(|start| found.outliers.binary_search(start).is_ok()) {
        Some(start) => Err(OrderError::StartApart { start }),
        None => Ok(found),
    }
}
