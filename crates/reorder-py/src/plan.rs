//! Trajectories through poses.

use std::path::PathBuf;

use bag_replay::load_robot;
use bag_replay::planner::manipulator::JointTrajectory;
use bag_replay::planner::reorder::{TopologyChoice, Verdict};
use bag_replay::planner::se3_geom::Se3;
use bag_replay::planner::{self, Config, Report, Request};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{Rows, array};
use crate::choice::choice;
use crate::error::{Refusal, ReorderError, raised};
use crate::order::{Parts, parts};
use crate::space::{Space, points};
use crate::spline::PoseSpline;

type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Joint motion in time: points, and between them the quintics that a ros2_control joint_trajectory_controller executes.
#[pyclass(frozen, module = "reorder")]
pub(crate) struct Trajectory {
    motion: JointTrajectory,
}

#[pymethods]
impl Trajectory {
    /// From base to tool.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.motion.joint_names.clone()
    }

    /// Time of the last point.
    #[getter]
    fn duration_s(&self) -> f64 {
        self.motion.duration_s()
    }

    /// Times of the points in s, shape (n,).
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let times = self.motion.points.iter().map(|point| point.time_s).collect();
        array(py, times, &[self.motion.points.len()], None)
    }

    /// In rad (m for prismatic joints), shape (n, joints).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let numbers = self.motion.points.iter().flat_map(|point| point.positions.iter().copied()).collect();
        self.joints(py, numbers)
    }

    /// Per s.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let numbers = self.motion.points.iter().flat_map(|point| point.velocities.iter().copied()).collect();
        self.joints(py, numbers)
    }

    /// Per s².
    #[getter]
    fn accelerations<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let numbers = self.motion.points.iter().flat_map(|point| point.accelerations.iter().copied()).collect();
        self.joints(py, numbers)
    }

    /// Positions, velocities, accelerations and jerks, shape (…, joints), at times t in s, shape (…).
    fn at<'py>(
        &self,
        py: Python<'py>,
        t: Bound<'py, PyAny>,
    ) -> PyResult<(Array<'py>, Array<'py>, Array<'py>, Array<'py>)> {
        let times = Rows::of_numbers("t", &t)?;
        let numbers = times.numbers()?;
        let joints = self.motion.joint_names.len();
        let [p, v, a, j] = py.detach(|| {
            let mut sampled = [(); 4].map(|()| Vec::with_capacity(numbers.len() * joints));
            for &t in numbers {
                let state = self.motion.at(t);
                sampled.iter_mut().zip(&state).for_each(|(sampled, of_joints)| sampled.extend(of_joints.iter()));
            }
            sampled
        });
        let made = |numbers| array(py, numbers, &times.lead, Some(joints));
        Ok((made(p)?, made(v)?, made(a)?, made(j)?))
    }

    fn __len__(&self) -> usize {
        self.motion.points.len()
    }

    fn __repr__(&self) -> String {
        let (points, joints) = (self.motion.points.len(), self.motion.joint_names.len());
        format!("<Trajectory: {points} points of {joints} joints in {:.3} s>", self.motion.duration_s())
    }
}

impl Trajectory {
    fn joints<'py>(&self, py: Python<'py>, numbers: Vec<f64>) -> PyResult<Array<'py>> {
        array(py, numbers, &[self.motion.points.len()], Some(self.motion.joint_names.len()))
    }
}

/// Order, spline, trajectory, times of the poses, and the report as JSON.
type Planned<'py> = (Parts<'py>, PoseSpline, Trajectory, Array<'py>, String);

#[pyfunction]
#[pyo3(signature = (poses, robot, *, limits, config, start, frame_id, metres_per_radian, topology, start_pose, minimum_verdict, rate_hz))]
#[allow(clippy::too_many_arguments, reason = "keywords in Python")]
pub(crate) fn plan<'py>(
    py: Python<'py>,
    poses: Bound<'py, PyAny>,
    robot: &str,
    limits: Option<PathBuf>,
    config: &str,
    start: Option<Bound<'py, PyAny>>,
    frame_id: String,
    metres_per_radian: Option<f64>,
    topology: Option<&str>,
    start_pose: Option<usize>,
    minimum_verdict: Option<&str>,
    rate_hz: Option<f64>,
) -> PyResult<Planned<'py>> {
    let robot = load_robot(robot, limits.as_deref()).map_err(raised::<ReorderError>)?;
    let mut config = Config::from_yaml(config).map_err(raised::<ReorderError>)?;
    config.topology = topology.map_or(Ok(config.topology), |word| choice::<TopologyChoice>("topology", word))?;
    config.minimum_verdict =
        minimum_verdict.map_or(Ok(config.minimum_verdict), |word| choice::<Verdict>("minimum_verdict", word))?;
    config.start = start_pose.or(config.start);
    config.metres_per_radian = metres_per_radian.unwrap_or(config.metres_per_radian);
    config.timing.rate_hz = rate_hz.unwrap_or(config.timing.rate_hz);
    let rows = Rows::of("poses", &poses, Se3::POINT, Se3::LAYOUT)?.listed("poses")?;
    let poses = points(Se3::default(), rows.numbers()?, "pose").map_err(raised::<ReorderError>)?;
    let start = start.map(|start| Rows::of_numbers("start", &start)?.numbers().map(<[f64]>::to_vec)).transpose()?;
    let request = Request { frame_id, poses, start, ..Request::default() };
    let (plan, report) = py.detach(|| {
        let plan = planner::plan(&robot, &config, &request).map_err(|refusal| {
            let sentence = refusal.to_string();
            if refusal.is_bad_input() { raised::<ReorderError>(sentence) } else { raised::<Refusal>(sentence) }
        })?;
        let report = Report::of(&robot.name, &Ok(plan.clone()), None).to_json();
        Ok::<_, PyErr>((plan, report))
    })?;
    let (times, count) = (plan.pose_times_s, request.poses.len());
    let spline = PoseSpline { curve: plan.spline };
    let trajectory = Trajectory { motion: plan.trajectory };
    Ok((parts(py, &plan.ordering, None)?, spline, trajectory, array(py, times, &[count], None)?, report))
}
