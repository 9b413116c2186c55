//! Random pose sets all over the workspace, arcs and loops of 20 to 500 poses: everything is planned legally and exactly, or
//! refused for a reason that holds. `cargo xtask soak plans` runs a thousand an arm, the tests a seeded sample.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};
use std::time::Instant;

use planner::manipulator::{Audit, ManipulatorError, Robot, audit};
use planner::reorder::{Options, Topology, order_poses};
use planner::se3_geom::{Ends, Manifold, Pose, PoseSpline, Se3, So3, centripetal_knots};
use planner::{Plan, Refusal, plan};
use support::closing::{between_poses_fault, loop_fault};
use support::follower::{End, follow_from_many, reaches};
use support::pose_sets::PoseSet;
use support::random::Random;

const SAMPLE: u64 = 6;
/// Places between two poses that are tried for being out of reach.
const PLACES: usize = 8;
/// Both searches sample the postures of an arm; by this part of the curve one may come farther than the other.
const CUT_OFF_WITHIN: f64 = 0.02;

#[test]
fn random_poses_are_planned_for_the_ur5e_or_refused_for_a_reason_that_holds() {
    assert_planned_or_truly_refused("ur5e");
}

#[test]
fn random_poses_are_planned_for_the_viperx_or_refused_for_a_reason_that_holds() {
    assert_planned_or_truly_refused("vx300s");
}

#[test]
fn random_poses_are_planned_for_the_panda_or_refused_for_a_reason_that_holds() {
    assert_planned_or_truly_refused("panda");
}

/// Set 863 of a thousand: every pose can be taken, and a nearest miss of some posture's own would be no reason.
#[test]
fn poses_that_postures_reach_which_are_cut_off_are_not_called_out_of_reach() {
    let robot = Robot::shipped("panda").unwrap();
    let set = PoseSet::draw(&robot, 863);
    let refusal = plan(&robot, &set.config(), &set.request).unwrap_err();
    assert_eq!(kind(&refusal), "cut off", "{refusal}");
    assert_eq!(doubt_about(&robot, &set, &refusal), None);
}

fn assert_planned_or_truly_refused(name: &str) {
    let cases = std::env::var("REORDER_SOAK_CASES").ok().map_or(SAMPLE, |n| n.parse().unwrap());
    let first = std::env::var("REORDER_SOAK_FIRST").ok().map_or(0, |n| n.parse().unwrap());
    let robot = Robot::shipped(name).unwrap();
    let (mut planned, mut worst, mut times_s) = (0, Worst::default(), Vec::new());
    let mut refused = BTreeMap::<String, usize>::new();
    let mut complaints = Vec::new();
    for seed in first..first + cases {
        let set = PoseSet::draw(&robot, seed);
        let clock = Instant::now();
        let outcome = plan(&robot, &set.config(), &set.request);
        times_s.push(clock.elapsed().as_secs_f64());
        match outcome {
            Ok(plan) => {
                planned += 1;
                worst.take(&audit(&robot, &plan.trajectory));
                complaints.extend(fault_of(&robot, &set, &plan).map(|fault| format!("{name} {seed}: {fault}")));
            }
            Err(refusal) => {
                *refused.entry(kind(&refusal).to_owned()).or_default() += 1;
                if let Some(doubt) = doubt_about(&robot, &set, &refusal) {
                    let (poses, topology) = (set.request.poses.len(), if set.closed { "loop" } else { "arc" });
                    complaints.push(format!("{name} {seed} ({topology} of {poses}): {refusal}; but {doubt}"));
                }
            }
        }
    }
    times_s.sort_by(f64::total_cmp);
    let quantile = |part: f64| 1e3 * times_s[(part * (times_s.len() - 1) as f64).round() as usize];
    println!(
        "| arm | planned | refused | worst ratio of velocity, acceleration, jerk, torque | least margin | median | p95 |"
    );
    println!("|---|---|---|---|---|---|---|");
    println!(
        "| {name} | {planned} of {cases} | {refused:?} | {worst} | {:.0} ms | {:.0} ms |",
        quantile(0.5),
        quantile(0.95)
    );
    assert!(complaints.is_empty(), "{} faults:\n{}", complaints.len(), complaints.join("\n"));
    assert!(4 * planned > cases, "too few were planned to say anything");
}

/// The worst of many audits: greatest ratios of peak to limit, and the least distance to a position limit in rad.
struct Worst {
    ratios: [Option<f64>; 4],
    margin_rad: f64,
}

impl Default for Worst {
    fn default() -> Self {
        Self { ratios: [None; 4], margin_rad: f64::INFINITY }
    }
}

impl Worst {
    fn take(&mut self, audit: &Audit) {
        let found = audit.max_ratio;
        let ratios = [Some(found.velocity), Some(found.acceleration), Some(found.jerk), found.torque];
        for (worst, ratio) in self.ratios.iter_mut().zip(ratios) {
            // None, an unknown torque, is less than any ratio.
            *worst = if ratio > *worst { ratio } else { *worst };
        }
        self.margin_rad = self.margin_rad.min(audit.position_margin);
    }
}

impl Display for Worst {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let [velocity, acceleration, jerk, torque] =
            self.ratios.map(|ratio| ratio.map_or_else(|| "unknown".to_owned(), |ratio| format!("{ratio:.6}")));
        write!(f, "{velocity}, {acceleration}, {jerk}, {torque} | {:.1e} rad", self.margin_rad)
    }
}

fn kind(refusal: &Refusal) -> &'static str {
    match refusal {
        Refusal::Manipulator { source, .. } => match &**source {
            ManipulatorError::Unreachable { .. } => "unreachable",
            ManipulatorError::CutOff { .. } => "cut off",
            ManipulatorError::JointLimit { .. } => "joint limit",
            ManipulatorError::Singular { .. } => "singular",
            ManipulatorError::Jump { .. } => "jump",
            ManipulatorError::PathTolerance { .. } => "path tolerance",
            ManipulatorError::LimitsNotMet { .. } => "limits not met",
            ManipulatorError::Timing { .. } => "timing",
            _ => "another of the arm",
        },
        Refusal::Spline { .. } => "interpolation",
        _ => "another",
    }
}

/// What is wrong with a plan, if anything is.
fn fault_of(robot: &Robot, set: &PoseSet, plan: &Plan) -> Option<String> {
    let audit = audit(robot, &plan.trajectory);
    if !(audit.limits_ok && audit.starts_and_ends_at_rest && audit.times_increase) {
        return Some(format!("the audit fails: {audit:?}"));
    }
    if let Some(start) = set.request.start.as_ref().filter(|start| plan.trajectory.points[0].positions != **start) {
        return Some(format!("it starts elsewhere than at {start:?}"));
    }
    // Twice the path tolerance of 0.1 mm and 1 mrad, as the pipeline promises.
    let off = |pose: &Pose, time_s: f64| {
        let tool = robot.chain.forward(&plan.trajectory.at(time_s)[0]);
        let (m, rad) =
            ((tool.translation.vector - pose.translation.vector).norm(), So3.distance(&tool.rotation, &pose.rotation));
        (m >= 2e-4 || rad >= 2e-3).then(|| format!("{m:.1e} m and {rad:.1e} rad off at {time_s:.3} s"))
    };
    let poses = &set.request.poses;
    if let Some(fault) = poses.iter().zip(&plan.pose_times_s).find_map(|(pose, &time_s)| off(pose, time_s)) {
        return Some(fault);
    }
    if let Some(fault) = between_poses_fault(robot, plan) {
        return Some(fault);
    }
    if !set.closed {
        return None;
    }
    loop_fault(robot, set, plan).or_else(|| off(&poses[plan.ordering.order[0]], plan.trajectory.duration_s()))
}

/// What speaks against a refusal, if anything does.
fn doubt_about(robot: &Robot, set: &PoseSet, refusal: &Refusal) -> Option<String> {
    if set.from_joints {
        return Some("the poses come from joint positions off every limit and singularity".into());
    }
    let Refusal::Manipulator { source, .. } = refusal else { return Some("the arm was not asked".into()) };
    let curve = curve_of(robot, set);
    let bound = set.config().path.least_singular_value;
    let attempts = if robot.chain.dof() > 6 { 1000 } else { 300 };
    let ends = follow_from_many(robot, &curve, bound, attempts, &mut Random::new(set.seed));
    if ends.contains(&End::Through) {
        return Some("one of many attempts gets through".into());
    }
    let stopped = |pose: usize, like: &dyn Fn(&End) -> Option<f64>| {
        let knots = curve.knots();
        // Steps of the two followers differ, so that one may notice a segment later.
        let segment = knots[pose.saturating_sub(2)]..=knots[(pose + 1).min(knots.len() - 1)];
        ends.iter().filter_map(like).any(|s| segment.contains(&s))
    };
    // Where the limits are what keeps the arm from it, attempts end at them, mostly elsewhere.
    let is_out_of_reach = |pose: usize| {
        let knots = curve.knots();
        let (from, to) = (knots[pose.saturating_sub(1)], knots[(pose + 1).min(knots.len() - 1)]);
        let mut random = Random::new(set.seed);
        let at = |part: usize| curve.pose(from + (to - from) * part as f64 / PLACES as f64);
        (0..=PLACES).map(at).any(|place| {
            (0..attempts).all(|_| {
                let near = random.configuration(&robot.limits.lower, &robot.limits.upper);
                reaches(robot, &place, &near, &mut random).is_none()
            })
        })
    };
    let named = |joint: &str| robot.chain.joint_names().iter().position(|name| name == joint);
    let holds = match &**source {
        ManipulatorError::JointLimit { pose, joint, value, lower, upper } => {
            !(lower..=upper).contains(&value)
                && stopped(*pose, &|end| match end {
                    End::Limit(s, other) if named(joint) == Some(*other) => Some(*s),
                    _ => None,
                })
        }
        ManipulatorError::Singular { pose, singular_value, bound } => {
            singular_value < bound
                && stopped(*pose, &|end| match end {
                    End::Singular(s, _) | End::Lost(s) => Some(*s),
                    _ => None,
                })
        }
        ManipulatorError::Unreachable(_)
        | ManipulatorError::UnreachableBetween { .. }
        | ManipulatorError::Jump { .. } => source.poses().first().is_some_and(|&pose| {
            stopped(pose, &|end| match end {
                End::Lost(s) | End::Singular(s, _) => Some(*s),
                _ => None,
            }) || is_out_of_reach(pose)
        }),
        // Nobody gets much farther, and it is not the pose itself that is the matter.
        ManipulatorError::CutOff { pose } => {
            let (from, to) = curve.domain();
            let farthest = curve.knots()[*pose] + CUT_OFF_WITHIN * (to - from);
            let goes_farther = |end: &End| match end {
                End::Limit(s, _) | End::Singular(s, _) | End::Lost(s) => *s > farthest,
                End::Through => true,
            };
            !ends.iter().any(goes_farther) && !is_out_of_reach(*pose)
        }
        _ => false,
    };
    (!holds).then(|| format!("attempts ended otherwise: {:?}", &ends[..ends.len().min(6)]))
}

/// The curve that the planner draws through the set.
fn curve_of(robot: &Robot, set: &PoseSet) -> PoseSpline {
    let (config, poses) = (set.config(), &set.request.poses);
    let metric = Se3::with_metres_per_radian(config.metres_per_radian).unwrap();
    let ordering =
        order_poses(poses, config.metres_per_radian, &Options { topology: config.topology, ..Options::default() });
    let mut ordering = ordering.unwrap();
    if let Some(start) = &set.request.start {
        let tool = robot.chain.forward(&planner::manipulator::nalgebra::DVector::from_column_slice(start));
        ordering = ordering.starting_near(&metric, poses, &tool);
    }
    let mut in_order: Vec<Pose> = ordering.order.iter().map(|&i| poses[i]).collect();
    let ends = if ordering.topology == Topology::Closed { Ends::Periodic } else { Ends::Natural };
    let mut knotted = in_order.clone();
    if set.closed {
        knotted.push(in_order[0]);
    }
    let knots = centripetal_knots(&metric, &knotted);
    let through = std::mem::take(&mut in_order);
    PoseSpline::through(&through, &knots, ends).unwrap()
}
