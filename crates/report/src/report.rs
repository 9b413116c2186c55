//! What goes into a page.

use planner::manipulator::Robot;
use planner::reorder::{EdgeFigures, Ordering};
use planner::se3_geom::PoseSpline;
use planner::{Plan, Refusal};

use crate::points::Points;
use crate::simulation::Simulation;

/// Everything that is known of an input; what is `None` is not on the page.
#[derive(Debug, Clone, Copy)]
pub struct Report<'a> {
    /// What the input is called.
    pub name: &'a str,
    /// The points, by input row.
    pub points: &'a Points,
    /// Their order.
    pub ordering: &'a Ordering,
    /// The gaps of that order, by [`Ordering::edges`].
    pub edges: &'a [EdgeFigures],
    /// The curve through them.
    pub spline: Option<&'a PoseSpline>,
    /// The arm, in whose base frame the points are.
    pub robot: Option<&'a Robot>,
    /// The plan for that arm, or why there is none.
    pub outcome: Option<Result<&'a Plan, &'a Refusal>>,
    /// A run of the plan.
    pub simulation: Option<&'a Simulation>,
}
