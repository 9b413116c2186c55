//! What goes in besides the points, and what comes out.

use serde::{Deserialize, Serialize};

/// Whether a curve has ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Topology {
    /// An arc with two ends.
    Open,
    /// A loop: the last point is followed by the first.
    Closed,
}

/// Which topology the order shall have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TopologyChoice {
    /// Told from the points.
    #[default]
    Auto,
    /// An arc, whatever the points look like.
    Open,
    /// A loop, whatever the points look like.
    Closed,
}

/// How the order was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// The minimum spanning tree, read as a path.
    Mst,
    /// A path that is short and turns little: Σ d + λ Σ ‖log_p(previous) + log_p(next)‖ with λ = 3, made small by local search.
    Repaired,
}

/// Which method shall find the order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MethodChoice {
    /// The minimum spanning tree, repaired where needed.
    #[default]
    Auto,
    /// The minimum spanning tree and nothing else.
    Mst,
}

/// Whether an order that something speaks against is sought again as a path that is short and turns little.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Repair {
    /// Up to [`MOST_REPAIRED_UNASKED`](crate::MOST_REPAIRED_UNASKED) points.
    #[default]
    Auto,
    /// However many points there are, and however long it takes.
    Always,
    /// Never.
    Off,
}

/// How a repaired order differs from the minimum spanning tree. Equal points go by their first row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Repaired {
    /// Edges of the tree that the order does not follow.
    pub dropped: Vec<[usize; 2]>,
    /// Neighbours in the order that are none in the tree.
    pub added: Vec<[usize; 2]>,
}

/// How far the order may be trusted; a later variant is a stronger claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Something speaks against the order: see [`Ordering::doubts`].
    Ambiguous,
    /// Every test that was made agrees with the order, yet nothing is proven.
    Plausible,
    /// The hypotheses of a reconstruction theorem hold with margin. Not claimed by any method yet.
    Certified,
}

/// How to order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Options {
    /// Open arc, closed curve, or told from the points.
    pub topology: TopologyChoice,
    /// Input row that shall come first. On an open curve it must be one of the two ends.
    ///
    /// Without it an open curve starts at its end with the smaller row; a closed one at row 0, toward the neighbour with the
    /// smaller row.
    pub start: Option<usize>,
    /// How the order is found.
    pub method: MethodChoice,
    /// Whether [`MethodChoice::Auto`] may repair.
    pub repair: Repair,
}

/// A reason not to trust the order, and where.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Doubt {
    /// The two input rows whose neighbourhood (or lack of it) is in question.
    pub at: [usize; 2],
    /// One sentence.
    pub why: String,
}

/// Figures on how densely the points sample the curve that the order draws. Lengths are in the unit of the manifold's metric.
///
/// These are **estimates from the points**: the true curve may bend between them. They prove nothing by themselves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Certificate {
    /// The greatest distance between neighbours in the order (the closing gap of a closed curve included).
    pub max_gap: f64,
    /// Federer's reach, min over ordered pairs of ‖v‖²/(2‖v⊥‖) with v = log_p(q) and v⊥ its part normal to the tangent at p,
    /// the tangent being that of the parabola through p and its two neighbours (H. Federer, *Curvature measures*, 1959,
    /// Theorem 4.18, carried to the tangent space by log). Exact in flat space, for exact tangents and dense points.
    /// `None` where nothing is normal (a geodesic), where there are fewer than three points, or where the order is no curve.
    pub reach: Option<f64>,
    /// ε = max_gap / (2·reach): half the greatest gap in units of the reach. Below 1 is what the reconstruction theorems ask for.
    pub epsilon: Option<f64>,
    /// Radius within which geodesics are unique; `None` where it is infinite.
    pub injectivity_radius: Option<f64>,
    /// injectivity_radius − max_gap; `None` where that is infinite. Positive is what the theorems ask for. On SE(3) a gap that is
    /// long in position alone makes it negative without making any geodesic ambiguous, so that this alone is no doubt.
    pub margin: Option<f64>,
}

/// Points in order, and how far that order may be trusted. Serialises to the JSON object of `reorder order`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ordering {
    /// How many points were given.
    pub n: usize,
    /// Every input row once, in recovered order. Equal points stand together, by row.
    pub order: Vec<usize>,
    /// Whether the last point is followed by the first.
    pub topology: Topology,
    /// How the order was found.
    pub method: Method,
    /// How far it may be trusted.
    pub verdict: Verdict,
    /// Whether the order is the same when a radian counts for half and for twice as many metres; `None` where no such weight
    /// exists or was tried.
    pub weight_stable: Option<bool>,
    /// Metres that one radian counted for; `None` on manifolds without that weight.
    pub metres_per_radian: Option<f64>,
    /// The rows of each connected curve, in order. Always one curve for now.
    pub components: Vec<Vec<usize>>,
    /// Groups of two or more rows with equal points (a dwell), each ascending.
    pub duplicates: Vec<Vec<usize>>,
    /// Sampling figures.
    pub certificate: Certificate,
    /// What was repaired; `None` where nothing was.
    pub repaired: Option<Repaired>,
    /// Everything that speaks against the order.
    pub doubts: Vec<Doubt>,
}

impl Ordering {
    /// The order with equal points merged into their first row: what a curve can be drawn through.
    pub fn distinct(&self) -> Vec<usize> {
        let mut repeated = vec![false; self.n];
        for &row in self.duplicates.iter().flat_map(|group| &group[1..]) {
            repeated[row] = true;
        }
        self.order.iter().copied().filter(|&row| !repeated[row]).collect()
    }
}
