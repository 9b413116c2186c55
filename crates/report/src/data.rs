//! All that the page shows, as one JSON object.

use planner::reorder::{EdgeFigures, Ordering, Topology};
use planner::se3_geom::PoseSpline;
use planner::se3_geom::nalgebra::Vector3;
use planner::{Plan, Refusal};
use serde::Serialize;

use crate::error::ReportError;
use crate::motion::{Arm, Motion};
use crate::packed::Packed;
use crate::report::Report;
use crate::simulation::Followed;
use crate::words::{Statement, certificate, shape, statement};

/// Points on the drawn spline, together and between two poses at most; of more poses than that there is one at each.
const SPLINE_POINTS: usize = 10_000;
const SPLINE_POINTS_PER_SEGMENT: usize = 12;

#[derive(Debug, Serialize)]
pub(crate) struct Data<'a> {
    name: &'a str,
    shape: String,
    verdict: String,
    closed: bool,
    axes: [&'static str; 3],
    seen_from: [f64; 3],
    /// What places are relative to, where they are far from zero: seven digits would not tell them from each other.
    around: Option<[f64; 3]>,
    places: Packed,
    directions: Packed,
    order: Packed,
    edges: Edges,
    doubts: Vec<Doubt<'a>>,
    certificate: Vec<Statement>,
    spline: Option<Spline>,
    arm: Option<Arm>,
    plan: Option<Planned>,
    refusal: Option<String>,
    simulation: Option<Followed>,
}

/// Gaps along the curve.
#[derive(Debug, Serialize)]
struct Edges {
    from: Packed,
    to: Packed,
    epsilons: Packed,
}

#[derive(Debug, Serialize)]
struct Doubt<'a> {
    at: [usize; 2],
    why: &'a str,
}

#[derive(Debug, Serialize)]
struct Spline {
    places: Packed,
    /// How far along the curve each place is, from 0 to 1 by the number of poses passed.
    shares: Packed,
}

#[derive(Debug, Serialize)]
struct Planned {
    motion: Motion,
    /// By input row.
    pose_times_s: Packed,
    statements: Vec<Statement>,
    /// Exact peaks over limits, in the order velocity, acceleration, jerk.
    peaks: [f64; 3],
}

impl<'a> Data<'a> {
    pub(crate) fn of(report: &Report<'a>) -> Result<Self, ReportError> {
        let Report { name, points, ordering, edges, spline, robot, outcome, simulation } = *report;
        let plan = outcome.and_then(Result::ok);
        let flat = |vectors: &[Vector3<f64>]| Packed::single(vectors.iter().flat_map(|v| [v.x, v.y, v.z]));
        // An arm stands at zero.
        let around = if robot.is_none() { points.far_middle() } else { None };
        let relative = |place: Vector3<f64>| place - around.unwrap_or_default();
        let run = simulation.zip(plan).map(|(simulation, plan)| simulation.of(&plan.trajectory)).transpose()?;
        Ok(Self {
            name,
            shape: shape(ordering),
            verdict: format!("{:?}", ordering.verdict).to_lowercase(),
            closed: ordering.topology == Topology::Closed,
            axes: points.axes,
            seen_from: points.seen_from().into(),
            around: around.map(Into::into),
            places: flat(&points.places.iter().copied().map(relative).collect::<Vec<_>>()),
            directions: flat(&points.directions),
            order: Packed::index(ordering.order.iter().copied()),
            edges: Edges::of(edges),
            doubts: ordering.doubts.iter().map(|doubt| Doubt { at: doubt.at, why: &doubt.why }).collect(),
            certificate: certificate(ordering, edges),
            spline: spline.map(|spline| Spline::of(spline, relative)),
            arm: robot.map(Arm::of),
            plan: plan.map(|plan| Planned::of(plan, ordering)),
            refusal: outcome.and_then(Result::err).map(Refusal::to_string),
            simulation: run,
        })
    }
}

impl Edges {
    fn of(edges: &[EdgeFigures]) -> Self {
        Self {
            from: Packed::index(edges.iter().map(|edge| edge.at[0])),
            to: Packed::index(edges.iter().map(|edge| edge.at[1])),
            epsilons: Packed::single(edges.iter().map(|edge| edge.epsilon)),
        }
    }
}

impl Spline {
    fn of(spline: &PoseSpline, relative: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Self {
        let knots = spline.knots();
        let segments = knots.len().saturating_sub(1).max(1);
        let parts = (SPLINE_POINTS / segments).clamp(1, SPLINE_POINTS_PER_SEGMENT);
        let part = |k: usize| k as f64 / parts as f64;
        let inner = knots.windows(2).enumerate().flat_map(|(segment, pair)| {
            let (from, to) = (pair[0], pair[1]);
            (0..parts).map(move |k| (segment as f64 + part(k), from + (to - from) * part(k)))
        });
        let last = (segments as f64, spline.domain().1);
        let samples: Vec<(f64, f64)> = inner.chain([last]).collect();
        let place = |&(_, t): &(f64, f64)| <[f64; 3]>::from(relative(spline.pose(t).translation.vector));
        Self {
            places: Packed::single(samples.iter().flat_map(place)),
            shares: Packed::single(samples.iter().map(|(passed, _)| passed / segments as f64)),
        }
    }
}

impl Planned {
    fn of(plan: &Plan, ordering: &Ordering) -> Self {
        let ratio = &plan.audit.max_ratio;
        Self {
            motion: Motion::of(&plan.trajectory),
            pose_times_s: Packed::double(plan.pose_times_s.iter().copied()),
            statements: plan_statements(plan, ordering),
            peaks: [ratio.velocity, ratio.acceleration, ratio.jerk],
        }
    }
}

fn plan_statements(plan: &Plan, ordering: &Ordering) -> Vec<Statement> {
    let ratio = &plan.audit.max_ratio;
    let percent = |ratio: f64| format!("{:.1} %", 100.0 * ratio);
    let points = plan.trajectory.points.len();
    let mut said = vec![statement("duration", format!("{:.3} s in {points} points", plan.trajectory.duration_s()))];
    if plan.approach_s > 0.0 {
        said.push(statement("approach", format!("{:.3} s to the first pose", plan.approach_s)));
    }
    let [velocity, acceleration, jerk] = [ratio.velocity, ratio.acceleration, ratio.jerk].map(percent);
    let peaks = format!("{velocity} of the velocity, {acceleration} of the acceleration, {jerk} of the jerk limits");
    said.push(statement("peaks", peaks));
    if let Some(torque) = ratio.torque {
        said.push(statement("torque", format!("{} of the effort limits at most", percent(torque))));
    }
    let (metres, radians) = (plan.pose_error_max_m, plan.pose_error_max_rad);
    said.push(statement("accuracy", format!("every pose is passed within {metres:.1e} m and {radians:.1e} rad")));
    let distinct = ordering.distinct();
    let row = |knot: usize| distinct[knot % distinct.len().max(1)];
    let path = &plan.path_report;
    let singular = &path.singular_value;
    said.push(statement(
        "posture",
        format!("least singular value {:.3} near pose {}", singular.value, row(singular.pose)),
    ));
    let margin = &path.limit_margin;
    if margin.value.is_finite() {
        let (joint, pose) = (&path.limit_joint, row(margin.pose));
        said.push(statement("margin", format!("{joint} comes to {:.3} of its limit near pose {pose}", margin.value)));
    }
    said
}
