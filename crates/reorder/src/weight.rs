//! How much a radian counts against a metre.

use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use se3_geom::{Manifold, PlanarTwist, Se2, Se3, Sim2, SimilarityTwist, Twist};

use crate::error::{OrderError, check_points};
use crate::order::MOST_REPAIRED_UNASKED;
use crate::repair::TURNING;
use crate::spanning_tree::{Tree, minimum_spanning_tree};
use crate::tour::{Effort, Problem, open_path, starts};

/// A space of rotations and translations whose metric weighs one against the other.
pub trait Weighted: Manifold + Sized {
    /// The metric in metres where one radian counts as much as `length_m` metres; `None` where that is no metric.
    fn with_metres_per_radian(length_m: f64) -> Option<Self>;
    /// Length of the part that is counted in radians, and of the part that is counted in metres.
    fn parts(tangent: &Self::Tangent) -> [f64; 2];
}

impl Weighted for Se3 {
    fn with_metres_per_radian(length_m: f64) -> Option<Self> {
        Se3::with_metres_per_radian(length_m)
    }
    fn parts(tangent: &Twist) -> [f64; 2] {
        [tangent.angular.norm(), tangent.linear.norm()]
    }
}

impl Weighted for Se2 {
    fn with_metres_per_radian(length_m: f64) -> Option<Self> {
        Se2::with_weights(length_m * length_m, 1.0).filter(|_| length_m > 0.0)
    }
    fn parts(tangent: &PlanarTwist) -> [f64; 2] {
        [tangent.angular.abs(), tangent.linear.norm()]
    }
}

/// A scale counts as its logarithm, in radians.
impl Weighted for Sim2 {
    fn with_metres_per_radian(length_m: f64) -> Option<Self> {
        Sim2::with_weights(length_m * length_m, 1.0).filter(|_| length_m > 0.0)
    }
    fn parts(tangent: &SimilarityTwist) -> [f64; 2] {
        [tangent.angular.hypot(tangent.scaling), tangent.linear.norm()]
    }
}

/// How the weight is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    /// From the points: see [`automatic_weight`].
    Auto,
    /// One radian counts as much as this many metres.
    MetresPerRadian(f64),
}

/// Rounds of ordering and weighing; the weight hardly changes after the second.
const ROUNDS: usize = 3;
/// The share of the weight that makes both parts equally rough which is taken. Rotations are the rougher part of most
/// recordings: with half the weight more of them came out right than with the whole, or a quarter.
const SHARE: f64 = 0.5;
/// Sums of angles that are less than this per point are rounding.
const ROUNDING_RAD: f64 = 1e-9;
/// Points that the first guess is made from, at most.
const SPREAD_POINTS: usize = 500;
/// Of more points than this only so many are looked at, evenly taken: they are a sample of the curve too.
const MOST_WEIGHED: usize = 20_000;

/// How many metres a radian should count for, from the points alone.
///
/// An order along the curve bends as little in rotation as in translation: with w = log_p(previous) + log_p(next) at every
/// point of a quick order, L = ½·Σ‖w_translation‖/Σ‖w_rotation‖, three times over, from the ratio of the spreads. Scaling all
/// translations scales L. Where there are no rotations, or nothing else, every L gives one order, and 1 is returned.
///
/// # Errors
/// As [`minimum_spanning_tree`], and [`OrderError::NotAPoint`].
///
/// ```
/// use reorder::automatic_weight;
/// use se3_geom::{Pose, Se3, nalgebra::{UnitQuaternion, Vector3}};
/// let pose = |t: f64| {
///     let place = Vector3::new(t.cos(), t.sin(), 0.2 * (3.0 * t).sin());
///     Pose::from_parts(place.into(), UnitQuaternion::from_euler_angles(0.5 * t.sin(), 0.0, 0.8 * (2.0 * t).cos()))
/// };
/// let poses: Vec<Pose> = (0..60).map(|k| pose(0.1 * f64::from(k * 7 % 60))).collect();
/// let length = automatic_weight::<Se3>(&poses)?;
/// // In millimetres in place of metres, a radian counts for a thousand times as many.
/// let millimetres: Vec<Pose> = poses.iter().map(|p| Pose::from_parts((p.translation.vector * 1e3).into(), p.rotation)).collect();
/// assert!((automatic_weight::<Se3>(&millimetres)? / (1e3 * length) - 1.0).abs() < 1e-6);
/// # Ok::<(), reorder::OrderError>(())
/// ```
pub fn automatic_weight<M: Weighted>(points: &[M::Point]) -> Result<f64, OrderError> {
    let Some(unit) = M::with_metres_per_radian(1.0) else { return Ok(1.0) };
    check_points(&unit, points)?;
    let stride = points.len().div_ceil(MOST_WEIGHED).max(1);
    let points: Vec<M::Point> = points.iter().step_by(stride).cloned().collect();
    let points = points.as_slice();
    let some: Vec<&M::Point> = points.iter().step_by(points.len().div_ceil(SPREAD_POINTS).max(1)).collect();
    let pairs = some.iter().enumerate().flat_map(|(k, &p)| some[k + 1..].iter().map(move |&q| (p, q)));
    let Some(mut length) = ratio(pairs.filter_map(|(p, q)| Some(M::parts(&unit.log(p, q).ok()?)))) else {
        return Ok(1.0);
    };
    for _ in 0..ROUNDS {
        let Some(metric) = M::with_metres_per_radian(length) else { return Ok(1.0) };
        let tree = minimum_spanning_tree(&metric, points).map_err(|error| match error {
            OrderError::DistanceOverflow { at } => OrderError::DistanceOverflow { at: at.map(|row| row * stride) },
            other => other,
        })?;
        let turns = turns_of(&metric, points, &tree).into_iter().filter_map(|rows| {
            let [a, p, b] = rows.map(|row| &points[row]);
            Some(M::parts(&(metric.log(p, a).ok()? + metric.log(p, b).ok()?)))
        });
        let Some(rougher) = ratio(turns) else { break };
        length = SHARE * rougher;
    }
    Ok(length)
}

/// Triples that follow each other along a quick order: a tour started from the tree, or, of many points, the tree itself where it
/// does not branch.
fn turns_of<M: Manifold>(metric: &M, points: &[M::Point], tree: &Tree) -> Vec<[usize; 3]> {
    if points.len() <= MOST_REPAIRED_UNASKED {
        let edges: Vec<_> = tree.edge_references().map(|e| (e.source().index(), e.target().index())).collect();
        let problem = Problem::new(metric, points);
        let rows = open_path(&problem, TURNING, starts(&problem, TURNING, &edges), Effort::Descent);
        return rows.windows(3).map(|w| [w[0], w[1], w[2]]).collect();
    }
    let turn = |node: NodeIndex| match tree.neighbors(node).collect::<Vec<_>>()[..] {
        [a, b] => Some([a, node, b].map(NodeIndex::index)),
        _ => None,
    };
    tree.node_indices().filter_map(turn).collect()
}

/// Metres per radian; `None` where there is nothing of the one or the other.
fn ratio(parts: impl Iterator<Item = [f64; 2]>) -> Option<f64> {
    let (sum, count) = parts.fold(([0.0, 0.0], 0.0), |(s, n), p| ([s[0] + p[0], s[1] + p[1]], n + 1.0));
    let ratio = sum[1] / sum[0];
    (sum[0] > ROUNDING_RAD * count && ratio > 0.0 && ratio.is_finite()).then_some(ratio)
}
