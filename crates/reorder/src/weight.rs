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

/// Rounds of ordering and weighing at most; the product mostly ceases to fall after the second or third.
const ROUNDS: usize = 12;
/// Of R in the product T·√R that is made small. Rotations are the rougher part of most recordings: with half, more of them came out
/// right than with the whole, or a quarter.
const ROTATION_EXPONENT: f64 = 0.5;
/// Weights from which the search begins anew, as shares of the one that it ended with.
const ELSEWHERE: [f64; 2] = [0.25, 4.0];
/// Sums of angles that are less than this per point are rounding.
const ROUNDING_RAD: f64 = 1e-9;
/// Points that the first guess is made from, at most.
const SPREAD_POINTS: usize = 500;
/// Of more points than this only so many are looked at, evenly taken: they are a sample of the curve too.
const MOST_WEIGHED: usize = 20_000;

/// How many metres a radian should count for, from the points alone.
///
/// An order along the curve bends as little in rotation as in translation: with w = log_p(previous) + log_p(next) at every point,
/// T = Σ‖w_translation‖ and R = Σ‖w_rotation‖, it is the product T·√R that is made small, which no unit of length changes. Where it is
/// least, so is T + L·R of L = ½·T/R, and that L is the answer (not the one that the order was found at, which of the recordings put fewer
/// right): a quick order is searched for a weight, the weight is taken from it, and so on, from the ratio
/// of the spreads. This may end beside the least product, so that it is begun anew from weights beside the one that it ended with, for
/// sets of up to 3,000 points. Scaling all translations scales L. Where there are no rotations, or nothing else, every L gives one
/// order, and 1 is returned.
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
    let Some(spread) = sums(pairs.filter_map(|(p, q)| Some(M::parts(&unit.log(p, q).ok()?)))) else {
        return Ok(1.0);
    };
    let far = |error| match error {
        OrderError::DistanceOverflow { at } => OrderError::DistanceOverflow { at: at.map(|row| row * stride) },
        other => other,
    };
    let found = least_turning::<M>(points, spread.ratio()).map_err(far)?;
    let length_m = found.map_or(spread.ratio(), |least| least.weight());
    Ok(if M::with_metres_per_radian(length_m).is_some() { length_m } else { 1.0 })
}

/// The least product found, from the weight `length_m` and from others beside the one that this leads to.
fn least_turning<M: Weighted>(points: &[M::Point], length_m: f64) -> Result<Option<Sums>, OrderError> {
    let Some(mut least) = settled::<M>(points, length_m)? else { return Ok(None) };
    // Of the trees of larger sets different parts do not branch, so that their sums do not compare.
    if points.len() <= MOST_REPAIRED_UNASKED {
        for share in ELSEWHERE {
            let other = settled::<M>(points, share * least.weight())?;
            least = other.filter(|other| other.product() < least.product()).unwrap_or(least);
        }
    }
    Ok(Some(least))
}

/// Lengths of translations and of rotations.
#[derive(Debug, Clone, Copy)]
struct Sums {
    rotations_rad: f64,
    translations_m: f64,
}

impl Sums {
    fn ratio(&self) -> f64 {
        self.translations_m / self.rotations_rad
    }
    fn weight(&self) -> f64 {
        ROTATION_EXPONENT * self.ratio()
    }
    fn product(&self) -> f64 {
        self.translations_m * self.rotations_rad.powf(ROTATION_EXPONENT)
    }
}

/// How much a quick order turns, from the weight `length_m` on, until weighing anew makes the product no smaller.
fn settled<M: Weighted>(points: &[M::Point], length_m: f64) -> Result<Option<Sums>, OrderError> {
    let mut length_m = length_m;
    let mut settled = None;
    for _ in 0..ROUNDS {
        let Some(metric) = M::with_metres_per_radian(length_m) else { break };
        let tree = minimum_spanning_tree(&metric, points)?;
        let turns = turns_of(&metric, points, &tree).into_iter().filter_map(|rows| {
            let [a, p, b] = rows.map(|row| &points[row]);
            Some(M::parts(&(metric.log(p, a).ok()? + metric.log(p, b).ok()?)))
        });
        let Some(turned) = sums(turns) else { break };
        if settled.is_some_and(|before: Sums| turned.product() >= before.product()) {
            break;
        }
        length_m = turned.weight();
        settled = Some(turned);
    }
    Ok(settled)
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

/// `None` where there is nothing of the one or the other.
fn sums(parts: impl Iterator<Item = [f64; 2]>) -> Option<Sums> {
    let (sum, count) = parts.fold(([0.0, 0.0], 0.0), |(s, n), p| ([s[0] + p[0], s[1] + p[1]], n + 1.0));
    let [rotations_rad, translations_m] = sum;
    let sums = Sums { rotations_rad, translations_m };
    let ratio = sums.ratio();
    (rotations_rad > ROUNDING_RAD * count && ratio > 0.0 && ratio.is_finite()).then_some(sums)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use se3_geom::nalgebra::{Isometry2, Vector2};

    use super::*;

    /// Lanes to and fro, 1.1 from pose to pose and one apart, as a lawn is mown, with headings that are far rougher than the places.
    fn mown() -> Vec<Isometry2<f64>> {
        let pose = |k: usize| {
            let (lane, along) = ((k / 20) as f64, (k % 20) as f64);
            let forth = (k / 20).is_multiple_of(2);
            let y = if forth { along } else { 19.0 - along };
            let noise = (PI + 12.9898 * k as f64).sin() * 43_758.545;
            let heading = if forth { FRAC_PI_2 } else { -FRAC_PI_2 } + 1.5 * (noise - noise.floor() - 0.5);
            Isometry2::new(Vector2::new(lane, 1.1 * y), heading)
        };
        (0..200).map(pose).collect()
    }

    /// From the ratio of the spreads, the weight settles where the order turns more than the true one.
    #[test]
    fn the_weight_is_searched_for_beside_the_first_that_settles() {
        let poses = mown();
        let unit = Se2::with_metres_per_radian(1.0).unwrap();
        let parts = |p: &Isometry2<f64>, q: &Isometry2<f64>| Se2::parts(&unit.log(p, q).unwrap());
        let pairs = poses.iter().enumerate().flat_map(|(k, p)| poses[k + 1..].iter().map(move |q| (p, q)));
        let spread = sums(pairs.map(|(p, q)| parts(p, q))).unwrap();
        let first = settled::<Se2>(&poses, spread.ratio()).unwrap().unwrap();
        let turns = poses.windows(3).map(|w| unit.log(&w[1], &w[0]).unwrap() + unit.log(&w[1], &w[2]).unwrap());
        let truth = sums(turns.map(|turn| Se2::parts(&turn))).unwrap();
        assert!(first.product() > truth.product());
        let found = least_turning::<Se2>(&poses, spread.ratio()).unwrap().unwrap();
        assert!(found.product() <= truth.product(), "{} above {}", found.product(), truth.product());
        assert_eq!(automatic_weight::<Se2>(&poses).unwrap(), 0.5 * found.translations_m / found.rotations_rad);
    }
}
