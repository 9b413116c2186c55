//! Joint trajectories in CSV files.

use std::path::Path;

use planner::manipulator::{JointPoint, JointTrajectory};
use planner::pose_bag::{BagError, read_table};

use crate::error::{Result, SimError};

/// Reads a joint trajectory from CSV, or from standard input where the path is `-`.
///
/// The header names the columns: `t` in s, and for every joint `NAME.position`, `NAME.velocity`, `NAME.acceleration` in rad (m), per s
/// and per s²; in any order.
///
/// # Errors
/// One sentence that names the file and the line or column.
pub fn read_trajectory(path: impl AsRef<Path>) -> Result<JointTrajectory> {
    let not_a_trajectory =
        |file: &str, reason: &str| SimError::TrajectoryFile { file: file.into(), reason: reason.into() };
    let table = read_table(path).map_err(|error| match error {
        BagError::Empty { file } | BagError::NoRows { file } => not_a_trajectory(&file, "it has no rows"),
        BagError::NoHeader { file, .. } => {
            not_a_trajectory(&file, "the first line has to name the columns: t,JOINT.position,…")
        }
        other => other.into(),
    })?;
    let joint_names: Vec<String> =
        table.columns().iter().filter_map(|column| column.strip_suffix(".position")).map(str::to_owned).collect();
    if joint_names.is_empty() {
        return Err(not_a_trajectory(table.file(), "it has no column JOINT.position"));
    }
    let columns = |kind: &str| -> Result<Vec<Vec<f64>>> {
        let names: Vec<String> = joint_names.iter().map(|joint| format!("{joint}.{kind}")).collect();
        Ok(table.select(&names.iter().map(String::as_str).collect::<Vec<_>>())?)
    };
    let times = table.select(&["t"])?;
    let states = columns("position")?.into_iter().zip(columns("velocity")?).zip(columns("acceleration")?);
    let mut points: Vec<JointPoint> = Vec::with_capacity(times.len());
    for ((time, line), ((positions, velocities), accelerations)) in times.iter().zip(table.line_numbers()).zip(states) {
        let time_s = time[0];
        let follows = points.last().map_or(time_s >= 0.0, |before| time_s > before.time_s);
        if !follows {
            return Err(SimError::TrajectoryLine { file: table.file().into(), line, time_s });
        }
        points.push(JointPoint { time_s, positions, velocities, accelerations });
    }
    Ok(JointTrajectory { joint_names, points })
}
