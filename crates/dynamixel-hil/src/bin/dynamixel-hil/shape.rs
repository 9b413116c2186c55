//! Recorded poses, and the plans that take the ViperX through them.

use std::error::Error;
use std::path::{Path, PathBuf};

use dynamixel_hil::planner::manipulator::nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use dynamixel_hil::planner::manipulator::{JointTrajectory, Robot};
use dynamixel_hil::planner::pose_bag::read_poses;
use dynamixel_hil::planner::se3_geom::Pose;
use dynamixel_hil::planner::{Config, Request, plan};
use serde_json::{Value, json};

/// The middle of the board in the recordings, which are in a UR5e's base frame, and where it stands before the ViperX, which is smaller.
const BOARD_M: [f64; 3] = [-0.10, 0.55, 0.42];
const BOARD_BEFORE_VIPERX_M: [f64; 3] = [0.33, 0.0, 0.20];

/// A recording and the plan for it.
pub(crate) struct Shape {
    pub(crate) name: String,
    /// `base_from_tool`, in the order of the recording.
    pub(crate) poses: Vec<Pose>,
    pub(crate) pose_times_s: Vec<f64>,
    pub(crate) trajectory: JointTrajectory,
    pub(crate) verdict: Value,
}

/// Plans each shape from where the one before ends, the first from `start`.
pub(crate) fn plan_all(robot: &Robot, start: &[f64], bags: &[PathBuf]) -> Result<Vec<Shape>, Box<dyn Error>> {
    let mut start = start.to_vec();
    let mut shapes = Vec::with_capacity(bags.len());
    for bag in bags {
        let shape = plan_one(robot, &start, bag)?;
        if let Some(last) = shape.trajectory.points.last() {
            start.clone_from(&last.positions);
        }
        shapes.push(shape);
    }
    Ok(shapes)
}

fn plan_one(robot: &Robot, start: &[f64], bag: &Path) -> Result<Shape, Box<dyn Error>> {
    let set = read_poses(bag, None)?.into_iter().next().ok_or_else(|| format!("{} is empty", bag.display()))?;
    let poses: Vec<Pose> = set.poses.iter().map(before_viperx).collect();
    let request = Request { poses: poses.clone(), start: Some(start.to_vec()), ..Request::default() };
    let planned = plan(robot, &Config::default(), &request)?;
    let name = bag.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let verdict = json!(format!("{:?}", planned.ordering.verdict).to_lowercase());
    Ok(Shape { name, poses, pose_times_s: planned.pose_times_s, trajectory: planned.trajectory, verdict })
}

/// The board turned from the UR5e's side to the ViperX's front, and the pen from the z axis of the one tool to the x axis of the other.
fn before_viperx(pose: &Pose) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -std::f64::consts::FRAC_PI_2);
    // Columns: the ViperX tool's x (out of the gripper), y and z in the UR5e's.
    let axes = Matrix3::new(0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0);
    let tool = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    let offset = turn * (pose.translation.vector - Vector3::from(BOARD_M));
    let mut placed = *pose;
    placed.translation.vector = Vector3::from(BOARD_BEFORE_VIPERX_M) + offset;
    placed.rotation = turn * pose.rotation * tool;
    placed
}
