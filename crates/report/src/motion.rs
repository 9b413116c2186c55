//! A trajectory as the page plays it.

use planner::manipulator::nalgebra::DVector;
use planner::manipulator::{JointTrajectory, Robot};
use planner::se3_geom::xyzw_from_rotation;
use serde::Serialize;

use crate::packed::Packed;

/// Points that are handed over; of more every k-th is.
const MOST_POINTS: usize = 20_000;

/// Rows of joints in the order of time; between rows the page draws the quintic through them.
#[derive(Debug, Serialize)]
pub(crate) struct Motion {
    joints: Vec<String>,
    /// Every how many of the trajectory's points stand here.
    stride: usize,
    times_s: Packed,
    positions: Packed,
    velocities: Packed,
    accelerations: Packed,
    /// For each interval between rows and each joint the jerk at its beginning, its greatest in size, and the one at its end.
    jerks: Packed,
}

impl Motion {
    pub(crate) fn of(trajectory: &JointTrajectory) -> Self {
        let points = &trajectory.points;
        let stride = points.len().div_ceil(MOST_POINTS).max(1);
        let mut rows: Vec<usize> = (0..points.len()).step_by(stride).collect();
        if rows.last().is_some_and(|&row| row + 1 < points.len()) {
            rows.push(points.len() - 1);
        }
        let kept = || rows.iter().map(|&row| &points[row]);
        Self {
            joints: trajectory.joint_names.clone(),
            stride,
            times_s: Packed::double(kept().map(|point| point.time_s)),
            positions: Packed::single(kept().flat_map(|point| point.positions.iter().copied())),
            velocities: Packed::single(kept().flat_map(|point| point.velocities.iter().copied())),
            accelerations: Packed::single(kept().flat_map(|point| point.accelerations.iter().copied())),
            jerks: Packed::single(rows.windows(2).flat_map(|pair| jerks(trajectory, pair[0], pair[1]))),
        }
    }
}

/// Joint by joint: first, greatest and last jerk between two points.
fn jerks(trajectory: &JointTrajectory, from: usize, to: usize) -> Vec<f64> {
    let points = &trajectory.points;
    let mut samples: Vec<DVector<f64>> = Vec::with_capacity(3 * (to - from));
    for interval in from..to {
        let (start, end) = (points[interval].time_s, points[interval + 1].time_s);
        // The jerk jumps at points: its limits from within.
        let inset = 1e-6 * (end - start);
        samples.extend([start + inset, 0.5 * (start + end), end - inset].map(|t| {
            let [.., jerk] = trajectory.at(t);
            jerk
        }));
    }
    let dof = points[from].positions.len();
    let of_joint = |joint: usize| {
        let value = |sample: Option<&DVector<f64>>| sample.map_or(0.0, |sample| sample[joint]);
        let greatest = samples.iter().max_by(|a, b| a[joint].abs().total_cmp(&b[joint].abs()));
        [samples.first(), greatest, samples.last()].map(value)
    };
    (0..dof).flat_map(of_joint).collect()
}

/// What the page needs to know of a robot.
#[derive(Debug, Serialize)]
pub(crate) struct Arm {
    name: String,
    links: Vec<DrawnLink>,
    limits: DrawnLimits,
}

/// A link and the joint that carries it.
#[derive(Debug, Serialize)]
struct DrawnLink {
    name: String,
    /// Of the joint in the frame of the link before, in m.
    origin: [f64; 3],
    quaternion_xyzw: [f64; 4],
    /// None, where the joint is fixed.
    axis: Option<[f64; 3]>,
    slides: bool,
}

/// Joint by joint; null where there is no limit.
#[derive(Debug, Serialize)]
struct DrawnLimits {
    lower: Vec<Option<f64>>,
    upper: Vec<Option<f64>>,
    velocity: Vec<Option<f64>>,
    acceleration: Vec<Option<f64>>,
    jerk: Vec<Option<f64>>,
}

impl Arm {
    pub(crate) fn of(robot: &Robot) -> Self {
        let finite = |values: &DVector<f64>| values.iter().map(|&x| x.is_finite().then_some(x)).collect();
        let links = robot.links.iter().map(|link| DrawnLink {
            name: link.name.clone(),
            origin: link.parent_from_joint.translation.vector.into(),
            quaternion_xyzw: xyzw_from_rotation(&link.parent_from_joint.rotation),
            axis: link.screw.map(|screw| (screw.linear + screw.angular).into()),
            slides: link.screw.is_some_and(|screw| screw.angular.norm() == 0.0),
        });
        Self {
            name: robot.name.clone(),
            links: links.collect(),
            limits: DrawnLimits {
                lower: finite(&robot.limits.lower),
                upper: finite(&robot.limits.upper),
                velocity: finite(&robot.limits.velocity),
                acceleration: finite(&robot.limits.acceleration),
                jerk: finite(&robot.limits.jerk),
            },
        }
    }
}
