//! What goes in besides the points, and what comes out.

use serde::{Deserialize, Serialize};

use crate::certificate::Certificate;

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
}

/// How far the order may be trusted; a later variant is a stronger claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Something speaks against the order: see [`Ordering::doubts`].
    Ambiguous,
    /// Every test that was made agrees with the order, yet nothing is proven.
    Plausible,
    /// Every condition of [`Certificate::conditions`] holds: see [what it asserts](crate#certified).
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
}

/// A reason not to trust the order, and where.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Doubt {
    /// The two input rows whose neighbourhood (or lack of it) is in question.
    pub at: [usize; 2],
    /// One sentence.
    pub why: String,
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
