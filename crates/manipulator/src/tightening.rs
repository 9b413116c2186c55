//! Lower limits where a trajectory broke them, so that the next solution keeps them.

use crate::bounds::Bounds;
use crate::optimise::Grid;
use crate::speed_profile::Smoothed;
use crate::trajectory::JointTrajectory;

/// Lowers the limits at the gridpoints around every place where the trajectory breaks them.
pub(crate) fn tighten(
    grid: &mut Grid,
    bounds: &Bounds<'_>,
    trajectory: &JointTrajectory,
    profile: &Smoothed,
    too_strong: bool,
) {
    let sampled_counts = too_strong || grid.tool.is_some();
    let dof = bounds.limits.lower.len();
    let n = grid.parameters.len();
    // Of each gridpoint and joint: velocity, acceleration, jerk, torque; of each gridpoint: the tool's speed and acceleration.
    let mut worst = vec![[1.0_f64; 4]; dof * n];
    let mut of_tool = vec![[1.0_f64; 2]; n];
    for interval in 0..trajectory.points.len() - 1 {
        let [from, to] = [interval, interval + 1].map(|k| profile.at(trajectory.points[k].time_s)[0]);
        let low = grid.parameters.partition_point(|&s| s <= from).clamp(1, n - 1) - 1;
        let high = grid.parameters.partition_point(|&s| s < to).clamp(1, n - 1);
        let sampled = sampled_counts.then(|| bounds.sampled_between(trajectory, interval));
        for (joint, quintic) in trajectory.quintics(interval).enumerate() {
            let mut ratios = [1.0; 3];
            let mut ignored_margin = f64::NEG_INFINITY;
            bounds.raise(joint, &quintic, &mut ratios, &mut ignored_margin);
            let peaks = [ratios[0], ratios[1], ratios[2], sampled.as_ref().map_or(1.0, |(torques, _)| torques[joint])];
            for station in low..=high {
                let entry = &mut worst[station * dof + joint];
                entry.iter_mut().zip(peaks).for_each(|(w, ratio)| *w = w.max(ratio));
            }
        }
        let Some((_, sampled)) = sampled else { continue };
        for entry in &mut of_tool[low..=high] {
            let peaks = [sampled.tool_speed, sampled.tool_acceleration];
            entry.iter_mut().zip(peaks).for_each(|(w, ratio)| *w = w.max(ratio.unwrap_or(1.0)));
        }
    }
    let lowered = |ratio: f64| if ratio > 1.0 { 0.99 / ratio } else { 1.0 };
    for station in 0..n {
        for joint in 0..dof {
            let [velocity, acceleration, jerk, torque] = worst[station * dof + joint];
            for (limits, ratio) in grid.limits.iter_mut().zip([velocity, acceleration, jerk]) {
                limits[(joint, station)] *= lowered(ratio);
            }
            if let Some(rows) = grid.torque.as_mut().filter(|_| torque > 1.0) {
                rows.tighten(joint, station, torque);
            }
        }
        if let Some(tool) = &mut grid.tool {
            tool.speed[station] *= lowered(of_tool[station][0]);
            tool.acceleration[station] *= lowered(of_tool[station][1]);
        }
    }
}
