//! Orders of points on any manifold.

use bag_replay::planner::reorder::{
    self, ComponentsChoice, EdgeFigures, Method, MethodChoice, Options, OrderError as Error, Ordering, Part, Repair,
    Repaired, TopologyChoice, Weight, Weighted, automatic_weight, order_weighted,
};
use bag_replay::planner::se3_geom::Euclidean;
use numpy::PyArray1;
use pyo3::prelude::*;
use serde::Serialize;

use crate::arrays::{Rows, indices};
use crate::choice::{WeightChoice, choice};
use crate::error::{OrderError, ReorderError, raised};
use crate::manifold::Manifold;
use crate::space::{Chosen, Space, on_space, points};

type Indices<'py> = Bound<'py, PyArray1<i64>>;

/// An order as Python makes its `Ordering` of it: what can be long as arrays, the rest as JSON.
pub(crate) type Parts<'py> =
    (Indices<'py>, Vec<Indices<'py>>, Vec<Indices<'py>>, Indices<'py>, Bound<'py, PyArray1<f64>>, Indices<'py>, String);

/// The short fields of [`Ordering`], and the figures of its edges.
#[derive(Serialize)]
struct Rest<'a> {
    topology: reorder::Topology,
    method: Method,
    verdict: reorder::Verdict,
    weight_stable: Option<bool>,
    metres_per_radian: Option<f64>,
    parts: &'a [Part],
    certificate: &'a reorder::Certificate,
    repaired: &'a Option<Repaired>,
    doubts: &'a [reorder::Doubt],
    edges: Option<&'a [EdgeFigures]>,
}

pub(crate) fn parts<'py>(py: Python<'py>, ordering: &Ordering, edges: Option<&[EdgeFigures]>) -> PyResult<Parts<'py>> {
    let rest = Rest {
        topology: ordering.topology,
        method: ordering.method,
        verdict: ordering.verdict,
        weight_stable: ordering.weight_stable,
        metres_per_radian: ordering.metres_per_radian,
        parts: &ordering.parts,
        certificate: &ordering.certificate,
        repaired: &ordering.repaired,
        doubts: &ordering.doubts,
        edges,
    };
    let each = |groups: &[Vec<usize>]| groups.iter().map(|rows| indices(py, rows)).collect();
    Ok((
        indices(py, &ordering.order),
        each(&ordering.components),
        each(&ordering.duplicates),
        indices(py, &ordering.outliers),
        PyArray1::from_slice(py, &ordering.moved),
        indices(py, &ordering.distinct()),
        serde_json::to_string(&rest).map_err(raised::<ReorderError>)?,
    ))
}

/// What is asked, apart from the points.
struct Ask {
    options: Options,
    weight: Weight,
    start_at: Option<Vec<f64>>,
    with_edges: bool,
}

type Answer = (Ordering, Vec<EdgeFigures>);

#[pyfunction]
#[pyo3(signature = (points, manifold, *, metres_per_radian, method, topology, start, start_at, components, repair, denoise, edges))]
#[allow(clippy::too_many_arguments, reason = "keywords in Python")]
pub(crate) fn order<'py>(
    py: Python<'py>,
    points: Bound<'py, PyAny>,
    manifold: Manifold,
    metres_per_radian: WeightChoice,
    method: &str,
    topology: &str,
    start: Option<usize>,
    start_at: Option<Bound<'py, PyAny>>,
    components: &str,
    repair: &str,
    denoise: bool,
    edges: bool,
) -> PyResult<Parts<'py>> {
    let options = Options {
        topology: choice::<TopologyChoice>("topology", topology)?,
        start,
        method: choice::<MethodChoice>("method", method)?,
        repair: choice::<Repair>("repair", repair)?,
        denoise,
        components: choice::<ComponentsChoice>("components", components)?,
    };
    let weight = metres_per_radian.weight()?;
    let size = on_space!(manifold.space, space => layout(space));
    let rows = Rows::of("points", &points, size.0, size.1)?.listed("points")?;
    let one_row = |given: Bound<'py, PyAny>| {
        Rows::of("start_at", &given, size.0, size.1)?.single("start_at")?.numbers().map(<[f64]>::to_vec)
    };
    let start_at = start_at.map(one_row).transpose()?;
    let ask = Ask { options, weight, start_at, with_edges: edges };
    let numbers = rows.numbers()?;
    let (ordering, figures) = py.detach(|| ask.on(manifold.space, numbers))?;
    parts(py, &ordering, edges.then_some(&figures))
}

fn layout<S: Space>(_: S) -> (usize, &'static str) {
    (S::POINT, S::LAYOUT)
}

impl Ask {
    fn on(&self, space: Chosen, numbers: &[f64]) -> PyResult<Answer> {
        match space {
            Chosen::R1(_) => self.flat::<2>(1, numbers),
            Chosen::R2(_) => self.flat::<2>(2, numbers),
            Chosen::R3(_) => self.flat::<3>(3, numbers),
            Chosen::R4(_) => self.flat::<8>(4, numbers),
            Chosen::R5(_) => self.flat::<8>(5, numbers),
            Chosen::R6(_) => self.flat::<8>(6, numbers),
            Chosen::R7(_) => self.flat::<8>(7, numbers),
            Chosen::R8(_) => self.flat::<8>(8, numbers),
            Chosen::S2(space) => self.unweighted(space, numbers),
            Chosen::So3(space) => self.unweighted(space, numbers),
            Chosen::Se2(space) => self.weighted(space, numbers),
            Chosen::Se3(space) => self.weighted(space, numbers),
            Chosen::Sim2(space) => self.weighted(space, numbers),
        }
    }

    /// Points of fewer coordinates, the rest zeros, which change no distance: a space of its own each would be compiled for minutes.
    fn flat<const N: usize>(&self, width: usize, numbers: &[f64]) -> PyResult<Answer> {
        let padded = |row: &[f64]| -> Vec<f64> { row.iter().copied().chain(std::iter::repeat(0.0)).take(N).collect() };
        if width == N {
            return self.unweighted(Euclidean::<N>, numbers);
        }
        let numbers: Vec<f64> = numbers.chunks_exact(width).flat_map(padded).collect();
        let start_at = self.start_at.as_deref().map(padded);
        Self { start_at, ..*self }.unweighted(Euclidean::<N>, &numbers)
    }

    fn unweighted<S: Space>(&self, space: S, numbers: &[f64]) -> PyResult<Answer> {
        if matches!(self.weight, Weight::MetresPerRadian(_)) {
            return Err(raised::<ReorderError>(
                "metres_per_radian weighs rotations against translations, and these points do not have both",
            ));
        }
        let points = points(space, numbers, "point").map_err(raised::<OrderError>)?;
        self.answer(&space, &points, |options| reorder::order(&space, &points, options))
    }

    fn weighted<S: Space + Weighted>(&self, space: S, numbers: &[f64]) -> PyResult<Answer> {
        let points = points(space, numbers, "point").map_err(raised::<OrderError>)?;
        let length = match self.weight {
            Weight::Auto => automatic_weight::<S>(&points).map_err(raised::<OrderError>)?,
            Weight::MetresPerRadian(length) => length,
        };
        let metric = S::with_metres_per_radian(length);
        let metric = metric.ok_or_else(|| raised::<OrderError>(Error::InvalidLengthScale { value: length }))?;
        let weight = Weight::MetresPerRadian(length);
        self.answer(&metric, &points, |options| order_weighted::<S>(&points, weight, options))
    }

    fn answer<S: Space>(
        &self,
        metric: &S,
        points: &[S::Point],
        order: impl Fn(&Options) -> Result<Ordering, Error>,
    ) -> PyResult<Answer> {
        let from = self.start_at.as_deref().map(S::point).transpose();
        let from = from.map_err(|reason| raised::<OrderError>(format!("start_at: {reason}")))?;
        let is_chain = self.options.method == MethodChoice::Nearest;
        let mut options = self.options;
        if let Some(from) = from.as_ref().filter(|_| is_chain) {
            // A chain goes from there, and cannot be turned afterwards.
            let away: Vec<f64> = points.iter().map(|point| metric.distance(from, point)).collect();
            options.start = (0..away.len()).min_by(|&a, &b| away[a].total_cmp(&away[b]));
        }
        let mut ordering = order(&options).map_err(raised::<OrderError>)?;
        if let Some(from) = from.filter(|_| !is_chain) {
            ordering = ordering.starting_near(metric, points, &from);
        }
        let edges = if self.with_edges { ordering.edges(metric, points) } else { Vec::new() };
        Ok((ordering, edges))
    }
}
