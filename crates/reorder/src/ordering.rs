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
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The minimum spanning tree, read as a path.
    Mst,
    /// A path that is short and turns little: Σ d + λ Σ ‖log_p(previous) + log_p(next)‖ with λ = 3, made small by local search.
    Repaired,
    /// The edges of [`nn_crust`](crate::nn_crust()), pieced together where they are no single curve.
    NnCrust,
    /// The edges of [`crust`](crate::crust()), pieced together where they are no single curve.
    Crust,
    /// [`nearest_chain`](crate::nearest_chain).
    Nearest,
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
    /// NN-CRUST, in O(n²) time.
    NnCrust,
    /// CRUST, in the plane.
    Crust,
    /// The nearest-neighbour chain from [`Options::start`] (row 0 without it), in O(n²) time. For comparison: it is mostly wrong
    /// from within an arc.
    Nearest,
}

/// How many curves the points shall be ordered along.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ComponentsChoice {
    /// One curve through all points. Where they look like several, that is a doubt, and [`Ordering::components`] names them.
    #[default]
    One,
    /// As many as [`split`](crate::split) tells apart, each with its own topology and verdict, and outliers in none. A curve with
    /// one gap three times as long as all others comes apart there.
    Auto,
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
    /// Every condition of [`Certificate::conditions`] holds: see [what it asserts](crate#certified).
    Certified,
}

/// How to order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Options {
    /// Open arc, closed curve, or told from the points.
    pub topology: TopologyChoice,
    /// Input row that shall come first. On an open curve it must be one of the two ends, except for [`MethodChoice::Nearest`].
    /// To start near a given point, see [`Ordering::starting_near`].
    ///
    /// Without it an open curve starts at its end with the smaller row; a closed one at row 0, toward the neighbour with the
    /// smaller row.
    pub start: Option<usize>,
    /// How the order is found.
    pub method: MethodChoice,
    /// Whether [`MethodChoice::Auto`] may repair.
    pub repair: Repair,
    /// Whether the points are noisy, and each is to be moved toward the parabola through its neighbours before they are ordered.
    /// Takes O(n²) time, up to [`MOST_DENOISED`](crate::MOST_DENOISED) points.
    /// Never changes a point that is handed on: only the order comes from the moved ones, and a clean curve is better left alone.
    pub denoise: bool,
    /// Whether the points may be samples of several curves.
    pub components: ComponentsChoice,
}

/// A reason not to trust the order, and where.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Doubt {
    /// The two input rows whose neighbourhood (or lack of it) is in question.
    pub at: [usize; 2],
    /// One sentence.
    pub why: String,
}

/// One of several curves that were ordered apart. All rows are input rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Whether its last point is followed by its first.
    pub topology: Topology,
    /// How its order was found.
    pub method: Method,
    /// How far that may be trusted.
    pub verdict: Verdict,
    /// Its sampling figures.
    pub certificate: Certificate,
}

/// Points in order, and how far that order may be trusted. Serialises to the JSON object of `reorder order`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ordering {
    /// How many points were given.
    pub n: usize,
    /// Every input row once, in recovered order. Equal points stand together, by row.
    pub order: Vec<usize>,
    /// Whether the last point is followed by the first. Several curves in a row are open; of one curve with outliers, which come after
    /// it and are no part of it, this is its own.
    pub topology: Topology,
    /// How the order was found.
    pub method: Method,
    /// How far it may be trusted: of several curves the least.
    pub verdict: Verdict,
    /// Whether the order is the same when a radian counts for half and for twice as many metres; `None` where no such weight
    /// exists or was tried: not where so much else speaks against the order.
    pub weight_stable: Option<bool>,
    /// Metres that one radian counted for; `None` on manifolds without that weight.
    pub metres_per_radian: Option<f64>,
    /// The rows of each curve that the points look like, in order. [`ComponentsChoice`] says whether each was ordered by itself, or all
    /// as one.
    pub components: Vec<Vec<usize>>,
    /// What is known about each of `components`, where they were ordered apart; otherwise empty.
    pub parts: Vec<Part>,
    /// Rows that stand apart from every curve, ascending. They come last in the order where curves were ordered apart.
    pub outliers: Vec<usize>,
    /// Groups of two or more rows with equal points (a dwell), each ascending.
    pub duplicates: Vec<Vec<usize>>,
    /// Sampling figures: of several curves those of the one that is trusted least.
    pub certificate: Certificate,
    /// What was repaired; `None` where nothing was.
    pub repaired: Option<Repaired>,
    /// How far each point was moved to find the order, by row; empty where [`Options::denoise`] was not asked for.
    pub moved: Vec<f64>,
    /// Everything that speaks against the order.
    pub doubts: Vec<Doubt>,
}

impl Ordering {
    /// The order with equal points that stand together merged into the first of them: what a curve can be drawn through. A point
    /// that a repaired order passes twice is there twice.
    pub fn distinct(&self) -> Vec<usize> {
        let name = self.names();
        let mut rows = self.order.clone();
        rows.dedup_by_key(|row| name[*row]);
        while self.topology == Topology::Closed && rows.len() > 1 && name[rows[0]] == name[rows[rows.len() - 1]] {
            rows.pop();
        }
        rows
    }

    /// Puts the rows of each component in the order of all.
    pub(crate) fn sort_components(&mut self) {
        let mut place = vec![0; self.n];
        self.order.iter().enumerate().for_each(|(k, &row)| place[row] = k);
        self.components.iter_mut().for_each(|rows| rows.sort_by_key(|&row| place[row]));
    }

    /// For every row the first row of those that hold the same point.
    pub(crate) fn names(&self) -> Vec<usize> {
        let mut name: Vec<usize> = (0..self.n).collect();
        for group in &self.duplicates {
            group.iter().for_each(|&row| name[row] = group[0]);
        }
        name
    }
}
