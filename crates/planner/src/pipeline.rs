//! Poses to trajectory, as one pure function.

use manipulator::nalgebra::DVector;
use manipulator::{
    Audit, JointTrajectory, ManipulatorError, PathReport, Robot, TimedPath, audit_under, connect, follow, rest_to_rest,
    time_path,
};
use reorder::{Ordering, Topology, order_poses};
use se3_geom::{Ends, Manifold, Pose, PoseSpline, Se3, So3, SplineError, centripetal_knots};

use crate::config::Config;
use crate::joints::STANDSTILL;
use crate::motion::Handover;
use crate::refusal::Refusal;

/// How much farther than the path tolerance the final trajectory may pass from an input pose: the tolerance bounds the joint
/// path, to which the interpolation between published points adds at most as much again ([`stays_on_path`]).
const ACCURACY_FACTOR: f64 = 2.0;

/// What is to be planned.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Request {
    /// Frame of the poses; empty means the robot's base frame.
    pub frame_id: String,
    /// When the poses were taken, in ns since the epoch; passed through.
    pub stamp_ns: i64,
    /// `base_from_tool`, in any order.
    pub poses: Vec<Pose>,
    /// The joint positions the robot stands at, in the robot's joint order. The trajectory then starts there; without it, at
    /// the first pose.
    pub start: Option<Vec<f64>>,
    /// The trajectory that the robot executes, and when the new one takes over from it; in place of `start`. The new one then begins
    /// in exactly the state of that time.
    pub handover: Option<Handover>,
}

/// An ordered, interpolated, timed and audited motion.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The recovered order with its verdict.
    pub ordering: Ordering,
    /// The C² curve through the distinct poses in order.
    pub spline: PoseSpline,
    /// What the robot executes: quintic between points, at rest at the end, and at the start but for a hand-over.
    pub trajectory: JointTrajectory,
    /// When the tool is at each input pose, by input index, in s from the trajectory's start.
    pub pose_times_s: Vec<f64>,
    /// The limits, checked over the whole trajectory including the approach.
    pub audit: Audit,
    /// Greatest distance of the planned tool from an input pose at its time, in m.
    pub pose_error_max_m: f64,
    /// The same as an angle, in rad.
    pub pose_error_max_rad: f64,
    /// How long the move from the start state to the first pose takes, in s; zero without one.
    pub approach_s: f64,
    /// How near the joint path comes to singularities and position limits.
    pub path_report: PathReport,
}

/// Poses on each segment of [`path_along`].
const PATH_POSES_PER_SEGMENT: usize = 4;

impl Plan {
    /// The distinct poses of the request in recovered order, as `base_from_tool`.
    pub fn ordered_poses(&self, request: &Request) -> Vec<Pose> {
        self.ordering.distinct().iter().map(|&i| request.poses[i]).collect()
    }

    /// [`path_along`] the spline.
    pub fn path(&self) -> Vec<Pose> {
        path_along(&self.spline)
    }
}

/// A curve between its poses too, for people to look at: four poses a segment, and its end.
pub fn path_along(spline: &PoseSpline) -> Vec<Pose> {
    let (_, last) = spline.domain();
    let part = |k: usize| k as f64 / PATH_POSES_PER_SEGMENT as f64;
    let segment = |knots: &[f64]| {
        let (from, to) = (knots[0], knots[1]);
        (0..PATH_POSES_PER_SEGMENT).map(move |k| from + (to - from) * part(k))
    };
    let parameters = spline.knots().windows(2).flat_map(segment).chain([last]);
    parameters.map(|t| spline.pose(t)).collect()
}

/// Orders, interpolates, follows, times and audits.
///
/// # Errors
/// A [`Refusal`] where any of these cannot be done; nothing that breaks a limit is ever returned.
pub fn plan(robot: &Robot, config: &Config, request: &Request) -> Result<Plan, Refusal> {
    config.check()?;
    let base = &robot.base_frame;
    if !request.frame_id.is_empty() && request.frame_id != *base {
        return Err(Refusal::Frame { given: request.frame_id.clone(), base: base.clone() });
    }
    if request.handover.is_some() && !config.approach {
        return Err(Refusal::Config("approach is off, so that no trajectory can take over from a running one".into()));
    }
    let start = start_state(robot, request)?;
    let poses = &request.poses;
    let ordering = order_from(robot, config, poses, start.as_ref())?;
    if ordering.verdict < config.minimum_verdict {
        return Err(not_certain_enough(ordering, config));
    }
    let distinct = ordering.distinct();
    let spline = interpolate(poses, &ordering, config.metres_per_radian)?;

    let at_fault = |source: ManipulatorError| Refusal::Manipulator {
        robot: robot.name.clone(),
        input_poses: source.poses().into_iter().map(|knot| distinct[knot % distinct.len()]).collect(),
        source: Box::new(source),
    };
    let path = follow(robot, &spline, start.as_ref(), &config.path).map_err(at_fault)?;
    let path_report = PathReport::of(robot, &path).map_err(at_fault)?;
    let timed = time_path(robot, &path, &config.timing).map_err(at_fault)?;
    stays_on_path(config, &timed)?;
    let (trajectory, approach_s) = match &start {
        Some(start) if config.approach => {
            with_approach(robot, config, start, request.handover.as_ref(), &timed).map_err(at_fault)?
        }
        Some(start) => (at_first_pose(robot, start, timed.trajectory.clone())?, 0.0),
        None => (timed.trajectory.clone(), 0.0),
    };

    let pose_times_s = times_by_input(&ordering, &distinct, &timed.knot_times_s, approach_s);
    let (pose_error_max_m, pose_error_max_rad) = accuracy(robot, config, poses, &trajectory, &pose_times_s)?;
    let audit = passed_audit(robot, config, &trajectory, request.handover.as_ref())?;
    Ok(Plan {
        ordering,
        spline,
        trajectory,
        pose_times_s,
        audit,
        pose_error_max_m,
        pose_error_max_rad,
        approach_s,
        path_report,
    })
}

fn start_state(robot: &Robot, request: &Request) -> Result<Option<DVector<f64>>, Refusal> {
    let start = match (&request.handover, &request.start) {
        (Some(handover), _) => DVector::from_vec(handover.state().positions),
        (None, Some(start)) => DVector::from_column_slice(start),
        (None, None) => return Ok(None),
    };
    robot.check_within_limits("the start state", &start).map_err(Refusal::StartState)?;
    Ok(Some(start))
}

/// The order; an open one begins at the end nearer to the robot's tool, where the robot's state is known.
fn order_from(
    robot: &Robot,
    config: &Config,
    poses: &[Pose],
    start: Option<&DVector<f64>>,
) -> Result<Ordering, Refusal> {
    let ordering = order_poses(poses, config.metres_per_radian, &config.ordering())?;
    let metric = Se3::with_metres_per_radian(config.metres_per_radian);
    Ok(match (config.start, start, metric) {
        (None, Some(start), Some(metric)) => ordering.starting_near(&metric, poses, &robot.chain.forward(start)),
        _ => ordering,
    })
}

fn not_certain_enough(ordering: Ordering, config: &Config) -> Refusal {
    const SHOWN: usize = 3;
    let mut doubts: Vec<_> =
        ordering.doubts.iter().take(SHOWN).map(|d| format!("poses {} and {}: {}", d.at[0], d.at[1], d.why)).collect();
    if ordering.doubts.len() > SHOWN {
        doubts.push(format!("and {} more", ordering.doubts.len() - SHOWN));
    }
    Refusal::Verdict {
        verdict: ordering.verdict,
        minimum: config.minimum_verdict,
        doubts: doubts.join("; "),
        ordering: Box::new(ordering),
    }
}

/// The C² curve through the distinct poses in order, its knots spaced by the metric in which one radian counts as so many metres.
///
/// # Errors
/// [`Refusal::Spline`] where no such curve is unique.
pub fn interpolate(poses: &[Pose], ordering: &Ordering, metres_per_radian: f64) -> Result<PoseSpline, Refusal> {
    let distinct = ordering.distinct();
    let ordered: Vec<Pose> = distinct.iter().map(|&i| poses[i]).collect();
    let metric = Se3::with_metres_per_radian(metres_per_radian).unwrap_or_default();
    let (ends, knots) = match ordering.topology {
        Topology::Open => (Ends::Natural, centripetal_knots(&metric, &ordered)),
        Topology::Closed => {
            let mut round = ordered.clone();
            round.extend(ordered.first());
            (Ends::Periodic, centripetal_knots(&metric, &round))
        }
    };
    PoseSpline::through(&ordered, &knots, ends).map_err(|source| {
        let near = match source {
            SplineError::HalfTurn { from, to }
            | SplineError::Winding { from, to, .. }
            | SplineError::Overshoot { from, to, .. } => vec![from, to],
            SplineError::KnotsNotIncreasing { index, .. } => vec![index - 1, index],
            SplineError::NonFinitePose { index } => vec![index],
            _ => Vec::new(),
        };
        Refusal::Spline { source, near: near.into_iter().map(|k| distinct[k % distinct.len()]).collect() }
    })
}

/// The trajectory itself, where the robot stands at its first point already: it would begin with a jump otherwise.
fn at_first_pose(robot: &Robot, start: &DVector<f64>, trajectory: JointTrajectory) -> Result<JointTrajectory, Refusal> {
    let away = |joint: usize| trajectory.points[0].positions[joint] - start[joint];
    match (0..start.len()).find(|&joint| away(joint).abs() > STANDSTILL) {
        None => Ok(trajectory),
        Some(joint) => {
            let name = robot.chain.joint_names()[joint].clone();
            Err(Refusal::NotAtFirstPose { joint: name, away: away(joint) })
        }
    }
}

/// The path's trajectory, led up to by a straight joint move from the start state, or from the moving state of a hand-over.
fn with_approach(
    robot: &Robot,
    config: &Config,
    start: &DVector<f64>,
    handover: Option<&Handover>,
    timed: &TimedPath,
) -> Result<(JointTrajectory, f64), ManipulatorError> {
    let first = DVector::from_column_slice(&timed.trajectory.points[0].positions);
    let approach = match handover {
        Some(running) => connect(robot, &running.trajectory, running.at_s, &first, &config.timing)?,
        None => rest_to_rest(robot, start, &first, &config.timing)?,
    };
    let approach_s = approach.duration_s();
    Ok((approach.switched(approach_s, &timed.trajectory), approach_s))
}

/// Duplicates share the time of the pose they were merged into; on a closed curve the first pose's time is its first passing.
fn times_by_input(ordering: &Ordering, distinct: &[usize], knot_times_s: &[f64], approach_s: f64) -> Vec<f64> {
    let mut times = vec![f64::NAN; ordering.n];
    for (&input, &time) in distinct.iter().zip(knot_times_s) {
        times[input] = approach_s + time;
    }
    for group in &ordering.duplicates {
        let known = group.iter().map(|&i| times[i]).find(|t| t.is_finite()).unwrap_or(f64::NAN);
        // A repaired order may pass equal poses at different times: those have one already.
        for &i in group {
            times[i] = if times[i].is_nan() { known } else { times[i] };
        }
    }
    times
}

/// The last gate before a robot.
fn passed_audit(
    robot: &Robot,
    config: &Config,
    trajectory: &JointTrajectory,
    handover: Option<&Handover>,
) -> Result<Audit, Refusal> {
    let from = handover.map(Handover::state);
    let rules = config.timing.audit_rules();
    let audit = audit_under(robot, trajectory, rules, from.as_ref());
    if audit.limits_ok { Ok(audit) } else { Err(Refusal::Limits { audit: Box::new(audit), rules }) }
}

/// Between the poses too: what is executed strays no farther from the joint path than the joint path may from the curve.
fn stays_on_path(config: &Config, timed: &TimedPath) -> Result<(), Refusal> {
    let (error_m, error_rad) = (timed.strays_m, timed.strays_rad);
    if error_m <= config.path.tolerance_m && error_rad <= config.path.tolerance_rad {
        return Ok(());
    }
    Err(Refusal::Strays { error_m, error_rad, rate_hz: config.timing.rate_hz })
}

fn accuracy(
    robot: &Robot,
    config: &Config,
    poses: &[Pose],
    trajectory: &JointTrajectory,
    pose_times_s: &[f64],
) -> Result<(f64, f64), Refusal> {
    let (mut worst_m, mut worst_rad) = (0.0, 0.0);
    for (input_pose, (pose, &time)) in poses.iter().zip(pose_times_s).enumerate() {
        let tool = robot.chain.forward(&trajectory.at(time)[0]);
        let error_m = (tool.translation.vector - pose.translation.vector).norm();
        let error_rad = So3.distance(&tool.rotation, &pose.rotation);
        let within = error_m <= ACCURACY_FACTOR * config.path.tolerance_m
            && error_rad <= ACCURACY_FACTOR * config.path.tolerance_rad;
        if !within {
            return Err(Refusal::Accuracy { input_pose, error_m, error_rad });
        }
        worst_m = f64::max(worst_m, error_m);
        worst_rad = f64::max(worst_rad, error_rad);
    }
    Ok((worst_m, worst_rad))
}

#[cfg(test)]
#[path = "pipeline_tests.rs"]
mod tests;
