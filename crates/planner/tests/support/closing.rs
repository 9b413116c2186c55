//! Whether a plan's tool stays on the curve between the poses, and comes back on a closed one as it set out.

use planner::Plan;
use planner::manipulator::nalgebra::DVector;
use planner::manipulator::{Robot, follow};
use planner::se3_geom::{Manifold, Se3, So3};

use super::follower::least_singular_value;
use super::pose_sets::PoseSet;

/// What inverse kinematics leaves of the tool's error at a sample, in m and rad.
const AT_SAMPLE: f64 = 1e-9;

/// What does not close, if anything: the curve, the joint path along it, the executed trajectory.
pub(crate) fn loop_fault(robot: &Robot, set: &PoseSet, plan: &Plan) -> Option<String> {
    curve_fault(plan).or_else(|| path_fault(robot, set, plan)).or_else(|| execution_fault(robot, plan))
}

/// Where between the poses the executed tool is farther from the curve than 0.2 mm and 2 mrad, twice the path tolerance.
pub(crate) fn between_poses_fault(robot: &Robot, plan: &Plan) -> Option<String> {
    const PLACES: usize = 5;
    let (curve, executed) = (&plan.spline, &plan.trajectory);
    let mut times_s: Vec<f64> = plan.ordering.distinct().iter().map(|&i| plan.pose_times_s[i]).collect();
    if times_s.len() < curve.knots().len() {
        times_s.push(executed.duration_s());
    }
    let segments = times_s.windows(2).zip(curve.knots().windows(2));
    let places = segments.flat_map(|(times, knots)| {
        (1..=PLACES).map(move |k| {
            let time_s = times[0] + (times[1] - times[0]) * k as f64 / (PLACES + 1) as f64;
            (time_s, knots[0], knots[1])
        })
    });
    places.into_iter().find_map(|(time_s, from, to)| {
        let tool = robot.chain.forward(&executed.at(time_s)[0]);
        let off = |s: f64| {
            let pose = curve.pose(s);
            ((tool.translation.vector - pose.translation.vector).norm(), So3.distance(&tool.rotation, &pose.rotation))
        };
        // The nearest place between the two poses, a rad counting as the tolerances do: a tenth of a metre.
        let away = |s: f64| off(s).0 + 0.1 * off(s).1;
        let (mut low, mut high) = (from, to);
        for _ in 0..50 {
            let [a, b] = [1.0 / 3.0, 2.0 / 3.0].map(|part| low + part * (high - low));
            if away(a) < away(b) { high = b } else { low = a }
        }
        let (m, rad) = off(0.5 * (low + high));
        (m > 2e-4 || rad > 2e-3).then(|| format!("{m:.1e} m and {rad:.1e} rad off the curve at {time_s:.3} s"))
    })
}

fn curve_fault(plan: &Plan) -> Option<String> {
    let (from, to) = plan.spline.domain();
    let (out, back) = (plan.spline.at(from), plan.spline.at(to));
    let rates = (out.twist.to_vector() - back.twist.to_vector()).norm() / out.twist.to_vector().norm();
    let bends = (out.acceleration.to_vector() - back.acceleration.to_vector()).norm();
    // Both are rounding: of sums of some hundred terms at 1e-16, amplified by at most 1/gap² ≤ 1e6 in the second derivative.
    let smooth = rates < 1e-9 && bends < 1e-6 * out.acceleration.to_vector().norm().max(1.0);
    (!smooth).then(|| format!("the curve does not close smoothly: {rates:.1e}, {bends:.1e}"))
}

/// The joints come back to where they began, with the same first and second derivatives by the path's parameter: a second lap would
/// go on without a jump in position, velocity or acceleration. Joints that turn freely may have gained whole turns.
fn path_fault(robot: &Robot, set: &PoseSet, plan: &Plan) -> Option<String> {
    let config = set.config();
    let start = set.request.start.as_ref().map(|start| DVector::from_column_slice(start));
    let path = match follow(robot, &plan.spline, start.as_ref(), &config.path) {
        Ok(path) => path,
        Err(refused) => return Some(format!("the path that was planned is refused: {refused}")),
    };
    let (from, to) = path.domain();
    let ([q, rate, bend, _], [q_back, rate_back, bend_back, _]) = (path.at(from), path.at(to));
    let turn = std::f64::consts::TAU;
    let apart = (&q_back - &q).map(|way| way - turn * (way / turn).round()).amax();
    let (rates, bends) = ((rate_back - &rate).norm() / rate.norm(), (bend_back - &bend).norm());
    // A tool error ε moves q by ε/σ with σ the least singular value, that the rates J⁻¹V by ε/σ² of themselves, and the bends
    // J⁻¹(V′ − J′q′) by as much of theirs and by that of J′q′ ~ ‖q′‖², once more over σ. Both ends have such an error.
    let sigma = least_singular_value(robot, &q);
    let (allowed, allowed_rate) = (2.0 * AT_SAMPLE / sigma, 2.0 * AT_SAMPLE / (sigma * sigma));
    let allowed_bend = allowed_rate * (bend.norm() + rate.norm_squared() / sigma) + 1e-9;
    let closes = apart <= allowed && rates <= allowed_rate && bends <= allowed_bend;
    println!(
        "CLOSE {} {apart:.1e}/{allowed:.1e} {rates:.1e}/{allowed_rate:.1e} {bends:.1e}/{allowed_bend:.1e}",
        set.seed
    );
    (!closes)
        .then(|| format!("the joints do not close: {apart:.1e} rad, {rates:.1e} of their rates, bends {bends:.1e}"))
}

/// The tool leaves its first pose and comes back to it along the tangent of the curve.
fn execution_fault(robot: &Robot, plan: &Plan) -> Option<String> {
    let (from, to) = plan.spline.domain();
    let executed = &plan.trajectory;
    let (begin, end) = (plan.approach_s, executed.duration_s());
    let points = &executed.points;
    let after = points.iter().find(|point| point.time_s > begin + 1e-9)?.time_s;
    let before = points.iter().rev().find(|point| point.time_s < end - 1e-9)?.time_s;
    [(begin, after, from), (end, before, to)].into_iter().find_map(|(rest, moving, s)| {
        let curve = plan.spline.at(s);
        let (tangent, bend) = (curve.twist.to_vector(), curve.acceleration.to_vector());
        let [q, rates, ..] = executed.at(moving);
        let moved = robot.chain.body_jacobian(&q) * rates;
        let turned = (moved.normalize() - tangent.normalize()).norm();
        // The curve itself turns over the way that the tool made: by ‖V′‖/‖V‖² of it, a little more away from the end.
        let way = Se3::default().distance(&robot.chain.forward(&executed.at(rest)[0]), &robot.chain.forward(&q));
        let allowed = 1e-4 + 2.0 * way * bend.norm() / tangent.norm_squared();
        (turned > allowed).then(|| format!("at {rest:.3} s the tool goes {turned:.1e} rad off the curve's tangent"))
    })
}
