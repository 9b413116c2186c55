//! Transcripts of the session: what goes in, what comes out, in which order. No clock, no thread.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use planner::manipulator::Robot;
use planner::manipulator::nalgebra::DVector;
use planner::se3_geom::xyzw_from_rotation;
use planner::{Config, Counters, Input, Output, RawPose, Refusal, Report, Session};
use support::outputs::{only_job, only_outcome};

const NOW_S: f64 = 10.0;
const HOME: [f64; 6] = [-1.57, -1.57, 1.57, -1.57, -1.57, 0.0];

/// A session that nothing has told where the robot stands, and that plans all the same.
fn session() -> Session {
    let config = Config { require_joint_state: false, ..Config::default() };
    Session::new(Robot::shipped("ur5e").unwrap(), config)
}

/// Ten poses on a short line in front of the home pose, in no order.
fn line() -> Vec<RawPose> {
    let robot = Robot::shipped("ur5e").unwrap();
    let tool = robot.chain.forward(&DVector::from_column_slice(&HOME));
    let place = |i: usize| RawPose {
        position: [tool.translation.x + 0.01 * ((i * 7) % 10) as f64, tool.translation.y, tool.translation.z],
        quaternion_xyzw: xyzw_from_rotation(&tool.rotation),
    };
    (0..10).map(place).collect()
}

fn poses(raw: Vec<RawPose>, stamp_ns: i64) -> Input {
    Input::Poses { frame_id: "base_link".into(), stamp_ns, poses: raw }
}

fn joint_state(names: &[&str], positions: &[f64]) -> Input {
    let names = names.iter().map(|&n| n.into()).collect();
    Input::JointState { names, positions: positions.to_vec(), velocities: Vec::new() }
}

/// The robot's own joints at `positions`, moving at `velocities` where they are given.
fn measured(session: &Session, positions: [f64; 6], velocities: &[f64]) -> Input {
    let names = session.robot().chain.joint_names().to_vec();
    Input::JointState { names, positions: positions.to_vec(), velocities: velocities.to_vec() }
}

fn only_refusal(outputs: Vec<Output>) -> String {
    only_outcome(outputs).result.unwrap_err().to_string()
}

/// The outputs by kind, with what tells them apart.
fn kinds(outputs: &[Output]) -> Vec<String> {
    let kind = |output: &Output| match output {
        Output::Run(_) => "run".to_owned(),
        Output::Publish(outcome) => {
            let what = if outcome.result.is_ok() { "plan" } else { "refusal" };
            format!("publish {} {what}", outcome.request.stamp_ns)
        }
        Output::Reply { success, .. } => format!("reply {success}"),
        Output::Withdraw => "withdraw".to_owned(),
        Output::Warn(_) => "warn".to_owned(),
    };
    outputs.iter().map(kind).collect()
}

#[test]
fn poses_are_planned_and_published() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 7)));
    let outcome = only_outcome(session.handle(NOW_S, Input::Finished(job.run())));
    assert_eq!(outcome.request.stamp_ns, 7);
    let plan = outcome.result.as_ref().unwrap();
    // 7i mod 10 = k has the solution i = 3k mod 10.
    assert_eq!(plan.ordering.order, [0, 3, 6, 9, 2, 5, 8, 1, 4, 7]);
    let report: serde_json::Value =
        serde_json::from_str(&Report::of("ur5e", &outcome.result, outcome.motion.as_ref()).to_json()).unwrap();
    for key in ["n", "order", "topology", "method", "verdict", "certificate", "doubts", "plan"] {
        assert!(!report[key].is_null(), "{key}");
    }
    assert!(report.get("refusal").is_none());
    assert_eq!(session.counters().planned, 1);
}

/// `line()` shifted, so that it is another request.
fn shifted(by_m: f64) -> Vec<RawPose> {
    let mut raw = line();
    raw.iter_mut().for_each(|pose| pose.position[2] += by_m);
    raw
}

/// A robot must not set out along older poses when newer ones are known.
#[test]
fn newer_poses_discard_the_running_plan_and_replace_waiting_ones() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    assert!(session.handle(NOW_S, poses(shifted(0.01), 2)).is_empty());
    assert!(session.handle(NOW_S, poses(shifted(0.02), 3)).is_empty());
    let next = only_job(session.handle(NOW_S, Input::Finished(job.run())));
    assert_eq!(only_outcome(session.handle(NOW_S, Input::Finished(next.run()))).request.stamp_ns, 3);
    let counters = session.counters();
    assert_eq!((counters.received, counters.superseded, counters.discarded, counters.planned), (3, 2, 1, 1));
}

/// Whatever happens to a message, it is counted once: as answered, as superseded, or as what is being planned.
#[test]
fn every_message_is_accounted_for() {
    let mut session = session();
    let account = |session: &mut Session, input: Input, counts: (u64, u64, u64)| {
        let outputs = session.handle(NOW_S, input);
        let Counters { received, answered, superseded, .. } = session.counters();
        assert_eq!((received, answered, superseded), counts);
        outputs
    };
    let bad = vec![RawPose { position: [f64::NAN; 3], quaternion_xyzw: [0.0, 0.0, 0.0, 1.0] }];
    let job = only_job(account(&mut session, poses(line(), 1), (1, 0, 0)));
    account(&mut session, poses(line(), 2), (2, 0, 1));
    account(&mut session, poses(shifted(0.01), 3), (3, 0, 2));
    assert_eq!(session.counters().in_vain, 2);
    account(&mut session, poses(bad, 4), (4, 1, 3));
    assert_eq!(session.counters().in_vain, 0);
    account(&mut session, poses(shifted(0.02), 5), (5, 1, 3));
    let next = only_job(account(&mut session, Input::Finished(job.run()), (5, 1, 3)));
    account(&mut session, Input::Replan, (5, 1, 3));
    let again = account(&mut session, Input::Finished(next.run()), (5, 2, 3));
    let [Output::Publish(_), Output::Run(again)] = &again[..] else { panic!("{again:?}") };
    account(&mut session, Input::Finished(again.clone().run()), (5, 2, 3));
    account(&mut session, poses(line(), 6), (6, 2, 3));
    account(&mut session, Input::Clear, (6, 2, 4));
}

/// They displace the ones before, as bad poses do.
#[test]
fn more_poses_than_are_planned_at_a_time_are_refused() {
    let mut session = Session::new(Robot::shipped("ur5e").unwrap(), Config { max_poses: 9, ..Config::default() });
    let refused = only_refusal(session.handle(NOW_S, poses(line(), 1)));
    assert_eq!(refused, "10 poses are more than the 9 that are planned at a time (max_poses)");
    assert_eq!(kinds(&session.handle(NOW_S, Input::Replan)), ["reply false"]);
}

#[test]
fn the_same_poses_again_do_not_keep_their_plan_from_ending() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    assert!(session.handle(NOW_S, poses(line(), 2)).is_empty());
    assert_eq!(kinds(&session.handle(NOW_S, Input::Finished(job.run()))), ["publish 1 plan"]);
}

/// Limits that were lowered while a plan was made hold for that plan too.
#[test]
fn another_configuration_makes_the_running_plan_anew() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    let mut slower = Config { require_joint_state: false, ..Config::default() };
    // Durations of short moves go with the inverse cube root of the jerk: 2.7 times as long.
    (slower.timing.acceleration_scale, slower.timing.jerk_scale) = (0.05, 0.05);
    assert!(session.handle(NOW_S, Input::Configure(Box::new(slower))).is_empty());
    let next = only_job(session.handle(NOW_S, Input::Finished(job.clone().run())));
    let slow = only_outcome(session.handle(NOW_S, Input::Finished(next.run())));
    let duration_s = |outcome: &planner::Outcome| outcome.result.as_ref().unwrap().trajectory.duration_s();
    assert!(duration_s(&slow) > 1.5 * duration_s(&job.run()));
    // With nothing under way a configuration waits for the next poses.
    assert!(session.handle(NOW_S, Input::Configure(Box::default())).is_empty());
    assert_eq!((session.counters().planned, session.counters().discarded), (1, 1));
}

/// As bad poses do, they displace the ones before.
#[test]
fn poses_in_an_unknown_place_are_refused() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    let unplaced = Input::Unplaced { frame_id: "moon".into(), stamp_ns: 2, why: "it is far".into() };
    let refused = only_refusal(session.handle(NOW_S, unplaced));
    assert!(refused.contains("'moon'") && refused.ends_with("is not known: it is far"), "{refused}");
    assert!(session.handle(NOW_S, Input::Finished(job.run())).is_empty());
    assert_eq!(kinds(&session.handle(NOW_S, Input::Replan)), ["reply false"]);
}

/// Nothing of one robot may be executed by another.
#[test]
fn another_robot_starts_afresh() {
    let mut session = session();
    let joints = measured(&session, HOME, &[]);
    session.handle(NOW_S, joints);
    assert_eq!(session.joint_state_age_s(NOW_S + 2.0), Some(2.0));
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    let panda = Robot::shipped("panda").unwrap();
    assert_eq!(kinds(&session.handle(NOW_S, Input::Robot(Box::new(panda)))), ["withdraw"]);
    assert!(session.handle(NOW_S, Input::Finished(job.run())).is_empty(), "a plan for the robot before");
    assert_eq!((session.robot().name.as_str(), session.joint_state_age_s(NOW_S)), ("panda", None));
    assert_eq!(kinds(&session.handle(NOW_S, Input::Replan)), ["reply false"]);
}

#[test]
fn a_lost_job_is_refused_and_does_not_block_the_next() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    let refused = only_refusal(session.handle(NOW_S, Input::Finished(job.lost("out of luck".into()))));
    assert_eq!(refused, "the planner failed: out of luck; please report this");
    only_job(session.handle(NOW_S, poses(line(), 2)));
}

/// Not knowing where the robot stands is a reason not to move it, at the start and at the end of planning.
#[test]
fn a_session_that_requires_a_joint_state_refuses_without_one() {
    let mut session = Session::new(Robot::shipped("ur5e").unwrap(), Config::default());
    let refused = only_refusal(session.handle(NOW_S, poses(line(), 1)));
    assert_eq!(refused, "no joint state with all joints of ur5e has arrived: where the robot stands is unknown");
    let still = measured(&session, HOME, &[]);
    session.handle(NOW_S, still);
    let job = only_job(session.handle(NOW_S, poses(line(), 2)));
    let refused = only_refusal(session.handle(NOW_S + 9.0, Input::Finished(job.run())));
    assert!(refused.starts_with("the last joint state is 9.0 s old"), "{refused}");
}

/// Planned from the first pose because nothing was known; then the robot turns out to stand elsewhere.
#[test]
fn a_state_that_arrives_while_planning_is_compared_with_the_first_point() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    let mut elsewhere = HOME;
    elsewhere[0] += 0.5;
    let there = measured(&session, elsewhere, &[]);
    session.handle(NOW_S, there);
    let refused = only_refusal(session.handle(NOW_S, Input::Finished(job.run())));
    assert!(refused.contains("while the trajectory was planned"), "{refused}");
}

#[test]
fn what_was_cleared_is_not_published() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    assert_eq!(kinds(&session.handle(NOW_S, Input::Clear)), ["withdraw", "reply true"]);
    assert!(session.handle(NOW_S, Input::Finished(job.run())).is_empty());
    assert_eq!(session.counters().discarded, 1);
    assert_eq!(kinds(&session.handle(NOW_S, Input::Replan)), ["reply false"]);
}

#[test]
fn replan_starts_from_the_present_joint_state() {
    let mut session = session();
    let names: Vec<String> = session.robot().chain.joint_names().to_vec();
    let first = only_job(session.handle(NOW_S, poses(line(), 1)));
    session.handle(NOW_S, Input::Finished(first.run()));
    // The driver names joints in its own order, and other joints of the machine beside them.
    let mut named: Vec<_> = names.iter().map(String::as_str).zip(HOME).chain([("gripper", 0.3)]).collect();
    named.reverse();
    let (names, positions): (Vec<_>, Vec<_>) = named.into_iter().unzip();
    let later_s = NOW_S + 60.0; // the first trajectory is over
    assert!(session.handle(later_s, joint_state(&names, &positions)).is_empty());
    let outputs = session.handle(later_s, Input::Replan);
    assert_eq!(kinds(&outputs), ["run", "reply true"]);
    let Some(Output::Run(job)) = outputs.into_iter().next() else { panic!() };
    let outcome = only_outcome(session.handle(later_s, Input::Finished(job.run())));
    assert_eq!(outcome.result.unwrap().trajectory.points[0].positions, HOME);
}

#[test]
fn joint_states_that_say_nothing_are_ignored_or_named() {
    let mut session = session();
    assert!(session.handle(NOW_S, joint_state(&["gripper"], &[0.1])).is_empty());
    assert_eq!(kinds(&session.handle(NOW_S, joint_state(&["elbow_joint"], &[]))), ["warn"]);
    let names: Vec<String> = session.robot().chain.joint_names().to_vec();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let outputs = session.handle(NOW_S, joint_state(&names, &[0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0]));
    let [Output::Warn(sentence)] = outputs.as_slice() else { panic!() };
    assert_eq!(sentence, "a joint state is ignored: shoulder_lift_joint is not a finite number");
}

/// A trajectory starts at rest where the robot stands. Where that is not known any more, or not true, it would begin with a jump.
#[test]
fn a_robot_that_moves_or_is_silent_gets_no_trajectory() {
    let mut session = session();
    let still = measured(&session, HOME, &[0.0; 6]);
    session.handle(NOW_S, still);
    let refused = only_refusal(session.handle(NOW_S + 1.5, poses(line(), 1)));
    assert_eq!(
        refused,
        "the last joint state is 1.5 s old, more than the 1 s allowed: where the robot stands is unknown"
    );

    let moving = measured(&session, HOME, &[0.0, 0.0, -0.3, 0.0, 0.0, 0.0]);
    session.handle(NOW_S + 2.0, moving);
    let refused = only_refusal(session.handle(NOW_S + 2.0, Input::Replan).drain(..1).collect());
    assert_eq!(refused, "elbow_joint is moving at -0.300 rad/s (or m/s): plan again when the robot stands");

    let still = measured(&session, HOME, &[0.0; 6]);
    session.handle(NOW_S + 3.0, still);
    let job = only_job(session.handle(NOW_S + 3.0, poses(line(), 2)));
    let mut elsewhere = HOME;
    elsewhere[5] += 0.01;
    let moved = measured(&session, elsewhere, &[0.0; 6]);
    session.handle(NOW_S + 3.5, moved);
    let refused = only_refusal(session.handle(NOW_S + 3.6, Input::Finished(job.run())));
    assert_eq!(
        refused,
        "wrist_3_joint moved by 0.0100 rad (or m) while the trajectory was planned: plan again when the robot stands"
    );
    assert_eq!(session.counters().refused, 3);
}

/// A quaternion in another order than x, y, z, w would be another rotation; the plan would miss the poses that were sent.
#[test]
fn raw_poses_are_read_in_ros_order() {
    let mut session = session();
    let mut raw = line();
    // A rotation whose four components differ, so that no two orders agree.
    let tilted = planner::se3_geom::rotation_from_xyzw(raw[0].quaternion_xyzw).unwrap()
        * planner::se3_geom::nalgebra::UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3);
    for pose in &mut raw {
        pose.quaternion_xyzw = [tilted.i, tilted.j, tilted.k, tilted.w];
    }
    let outcome = session.handle(NOW_S, poses(raw, 1));
    let outcome = only_outcome(session.handle(NOW_S, Input::Finished(only_job(outcome).run())));
    let plan = outcome.result.unwrap();
    let tool = session.robot().chain.forward(&plan.trajectory.at(plan.pose_times_s[4])[0]);
    assert!(tool.rotation.angle_to(&tilted) < 2e-3);
}

#[test]
fn bad_poses_are_refused_by_index_and_displace_the_ones_before() {
    let mut session = session();
    let job = only_job(session.handle(NOW_S, poses(line(), 1)));
    let mut bad = line();
    bad[4].quaternion_xyzw = [0.0; 4];
    let refused = only_outcome(session.handle(NOW_S, poses(bad, 2)));
    let refusal = refused.result.unwrap_err();
    assert!(matches!(refusal, Refusal::InvalidPose { input_pose: 4, .. }));
    assert_eq!(refusal.to_string(), "pose 4: the quaternion is zero, so there is no orientation");
    // The plan that was under way belongs to poses that are no longer wanted.
    assert!(session.handle(NOW_S, Input::Finished(job.run())).is_empty());
    let report = Report::of("ur5e", &Err(refusal), None).to_json();
    assert_eq!(report, r#"{"refusal":"pose 4: the quaternion is zero, so there is no orientation"}"#);
    assert_eq!(kinds(&session.handle(NOW_S, Input::Replan)), ["reply false"]);
}
