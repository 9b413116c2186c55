//! A question about points of whatever manifold, and its answer.

use planner::reorder::{
    EdgeFigures, MethodChoice, Options, OrderError, Ordering, Weight, Weighted, automatic_weight, order, order_weighted,
};
use planner::se3_geom::{Euclidean, Manifold, Se2, Se3, Sim2, So3, Sphere};

use crate::source::{Points, Rows, coordinates, direction, planar_pose, pose, rotation, similarity};

/// How points shall be ordered.
pub(crate) struct Ask<'a> {
    pub(crate) options: Options,
    pub(crate) weight: Weight,
    /// Values of the manifold's columns near which the order shall start.
    pub(crate) from: Option<&'a [f64]>,
    pub(crate) with_edges: bool,
}

type Answer = Result<(Ordering, Vec<EdgeFigures>), String>;

impl Ask<'_> {
    pub(crate) fn order(&self, rows: &Rows) -> Answer {
        let columns = rows.columns.len();
        if let Some(from) = self.from.filter(|from| from.len() != columns || from.iter().any(|x| !x.is_finite())) {
            let names = rows.columns.join(",");
            let given = from.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
            return Err(format!("--start-at needs {columns} finite numbers, for the columns {names}, not {given}"));
        }
        match &rows.points {
            Points::Plane(points) => self.unweighted(&Euclidean::<2>, points, coordinates),
            Points::Space(points) => self.unweighted(&Euclidean::<3>, points, coordinates),
            Points::Flat(points) => self.unweighted(&Euclidean::<8>, points, coordinates),
            Points::Sphere(points) => self.unweighted(&Sphere, points, direction),
            Points::Rotations(points) => self.unweighted(&So3, points, rotation),
            Points::PlanarPoses(points) => self.weighted::<Se2>(points, planar_pose),
            Points::Poses(points) => self.weighted::<Se3>(points, pose),
            Points::Similarities(points) => self.weighted::<Sim2>(points, similarity),
        }
    }

    fn unweighted<M: Manifold>(
        &self,
        metric: &M,
        points: &[M::Point],
        read: fn(&[f64]) -> Result<M::Point, String>,
    ) -> Answer {
        if matches!(self.weight, Weight::MetresPerRadian(_)) {
            return Err("--metres-per-radian weighs rotations against translations, and these points do not have both"
                .to_owned());
        }
        self.answer(metric, points, read, |options| order(metric, points, options))
    }

    fn weighted<M: Weighted>(&self, points: &[M::Point], read: fn(&[f64]) -> Result<M::Point, String>) -> Answer {
        let length = match self.weight {
            Weight::Auto => automatic_weight::<M>(points).map_err(|error| error.to_string())?,
            Weight::MetresPerRadian(length) => length,
        };
        let metric = M::with_metres_per_radian(length);
        let metric = metric.ok_or_else(|| OrderError::InvalidLengthScale { value: length }.to_string())?;
        let weight = Weight::MetresPerRadian(length);
        self.answer(&metric, points, read, |options| order_weighted::<M>(points, weight, options))
    }

    fn answer<M: Manifold>(
        &self,
        metric: &M,
        points: &[M::Point],
        read: fn(&[f64]) -> Result<M::Point, String>,
        order: impl Fn(&Options) -> Result<Ordering, OrderError>,
    ) -> Answer {
        let from = self.from.map(read).transpose().map_err(|reason| format!("--start-at: {reason}"))?;
        let is_chain = self.options.method == MethodChoice::Nearest;
        let mut options = self.options;
        if let Some(from) = from.as_ref().filter(|_| is_chain) {
            // A chain goes from there, and cannot be turned afterwards.
            let away: Vec<f64> = points.iter().map(|point| metric.distance(from, point)).collect();
            options.start = (0..away.len()).min_by(|&a, &b| away[a].total_cmp(&away[b]));
        }
        let mut ordering = order(&options).map_err(|error| error.to_string())?;
        if let Some(from) = from.filter(|_| !is_chain) {
            ordering = ordering.starting_near(metric, points, &from);
        }
        let edges = if self.with_edges { ordering.edges(metric, points) } else { Vec::new() };
        Ok((ordering, edges))
    }
}
