//! Where on a path its gridpoints lie.

use crate::bounds::Bounds;
use crate::error::Result;
use crate::joint_path::JointPath;
use crate::optimise::Grid;
use crate::options::{JointLimits, TimingOptions};

/// Gridpoints for the first, second-order pass; a bend that is shorter than two of them would be missed.
const COARSE_POINTS: usize = 1000;
/// A jerk of ten accelerations a second has a tenth of a second to build up an acceleration: three intervals resolve it.
const GRIDPOINTS_PER_SECOND: f64 = 30.0;

/// A first solution without jerk limits, by which the gridpoints of the others are placed.
pub(crate) struct Coarse<'a> {
    path: &'a JointPath,
    bounds: &'a Bounds<'a>,
    options: &'a TimingOptions,
    /// Evenly spaced.
    parameters: Vec<f64>,
    /// When the solution is there.
    times: Vec<f64>,
}

impl<'a> Coarse<'a> {
    pub(crate) fn new(path: &'a JointPath, bounds: &'a Bounds<'a>, options: &'a TimingOptions) -> Result<Self> {
        let even = even_grid(path, bounds, options, COARSE_POINTS.max(4 * path.knots().len()))?;
        let (_, times) = even.second_order(None)?;
        Ok(Self { path, bounds, options, parameters: even.parameters, times })
    }

    pub(crate) fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Gridpoints that share the path and its second-order time evenly, half and half.
    pub(crate) fn grid(&self, density: usize) -> Result<Grid> {
        let (first, last) = self.path.domain();
        let Self { parameters: even, times, .. } = self;
        let (coarse, duration) = (even.len() - 1, self.duration());
        let share = |k: usize| 0.5 * (k as f64 / coarse as f64 + times[k] / duration);
        let knots = self.path.knots().len();
        let points = match self.options.limits {
            JointLimits::Jerk => ((duration * GRIDPOINTS_PER_SECOND) as usize).max(knots).clamp(100, 400),
            JointLimits::Acceleration => coarse,
        } * density;
        let mut parameters = Vec::with_capacity(points + 1);
        let mut k = 0;
        for i in 0..=points {
            let wanted = i as f64 / points as f64;
            while k + 1 < coarse && share(k + 1) < wanted {
                k += 1;
            }
            let fraction = ((wanted - share(k)) / (share(k + 1) - share(k))).clamp(0.0, 1.0);
            parameters.push(even[k] + fraction * (even[k + 1] - even[k]));
        }
        parameters[points] = last;
        Grid::new(self.path, parameters, duration / (last - first), self.bounds, greatest_tool_speed(self.options))
    }
}

pub(crate) fn even_grid(
    path: &JointPath,
    bounds: &Bounds<'_>,
    options: &TimingOptions,
    intervals: usize,
) -> Result<Grid> {
    let (first, last) = path.domain();
    let even = (0..=intervals).map(|k| first + (last - first) * k as f64 / intervals as f64).collect();
    Grid::new(path, even, 1.0 / (last - first), bounds, greatest_tool_speed(options))
}

fn greatest_tool_speed(options: &TimingOptions) -> Option<f64> {
    options.constant_tool_speed_m_s.or(options.tool_speed_m_s)
}
