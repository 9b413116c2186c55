//! Transcripts of a session whose robot is under way when something new is asked for.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use planner::manipulator::Robot;
use planner::manipulator::nalgebra::DVector;
use planner::manipulator::{TimingOptions, audit_from};
use planner::se3_geom::xyzw_from_rotation;
use planner::{Config, Input, Motion, OnRefusal, RawPose, Refusal, Report, Session};
use support::outputs::{only_job, only_outcome};

const HOME: [f64; 6] = [-1.57, -1.57, 1.57, -1.57, -1.57, 0.0];
/// When the robot set out.
const BEGAN_S: f64 = 10.0;

/// Ten poses in a row, `height_m` above the home pose, in no order.
fn line(height_m: f64) -> Input {
    let tool = Robot::shipped("ur5e").unwrap().chain.forward(&DVector::from_column_slice(&HOME));
    let place = |i: usize| RawPose {
        position: [
            tool.translation.x + 0.02 * ((i * 7) % 10) as f64,
            tool.translation.y,
            tool.translation.z + height_m,
        ],
        quaternion_xyzw: xyzw_from_rotation(&tool.rotation),
    };
    Input::Poses { frame_id: String::new(), stamp_ns: 0, poses: (0..10).map(place).collect() }
}

fn no_pose() -> Input {
    let pose = RawPose { position: [0.0; 3], quaternion_xyzw: [0.0; 4] };
    Input::Poses { frame_id: String::new(), stamp_ns: 0, poses: vec![pose] }
}

fn measured(session: &Session, positions: &DVector<f64>, velocities: &DVector<f64>) -> Input {
    let names = session.robot().chain.joint_names().to_vec();
    Input::JointState { names, positions: positions.as_slice().to_vec(), velocities: velocities.as_slice().to_vec() }
}

/// Tells the session at `now_s` that the robot is where `motion` has it.
fn on_track(session: &mut Session, motion: &Motion, now_s: f64) {
    let [q, v, ..] = motion.trajectory.at(now_s - motion.starts_at_s);
    let input = measured(session, &q, &v);
    assert!(session.handle(now_s, input).is_empty());
}

/// A session whose robot set out at [`BEGAN_S`].
fn under_way(config: Config) -> (Session, Motion) {
    // Slow enough for everything that is to happen on the way.
    let timing = TimingOptions { acceleration_scale: 0.3, ..config.timing };
    let mut session = Session::new(Robot::shipped("ur5e").unwrap(), Config { timing, ..config });
    let home = DVector::from_column_slice(&HOME);
    let standing = measured(&session, &home, &DVector::zeros(6));
    session.handle(BEGAN_S, standing);
    let job = only_job(session.handle(BEGAN_S, line(0.1)));
    let motion = only_outcome(session.handle(BEGAN_S, Input::Finished(job.run()))).motion.unwrap();
    assert_eq!(motion.starts_at_s, BEGAN_S);
    assert!(motion.trajectory.duration_s() > 2.0, "the other transcripts need time");
    (session, motion)
}

fn quick() -> Config {
    Config { handover: true, handover_lead_s: 0.4, ..Config::default() }
}

#[test]
fn new_poses_take_over_a_lead_ahead_in_exactly_the_state_of_that_time() {
    let (mut session, running) = under_way(quick());
    let asked_s = BEGAN_S + 0.203;
    on_track(&mut session, &running, asked_s);
    let job = only_job(session.handle(asked_s, line(0.15)));
    let now_s = asked_s + 0.2;
    let outcome = only_outcome(session.handle(now_s, Input::Finished(job.run())));
    let handover = outcome.request.handover.as_ref().unwrap();
    assert!((0.4..0.41).contains(&(handover.at_s - 0.203)), "the first point a lead ahead: {}", handover.at_s);
    assert!(!handover.is_at_rest());
    let (plan, motion) = (outcome.result.as_ref().unwrap(), outcome.motion.as_ref().unwrap());
    assert_eq!(plan.trajectory.points[0], running.trajectory.state_at(handover.at_s));
    assert!(plan.trajectory.points[0].velocities.iter().any(|v| v.abs() > 0.05), "it moves there");
    // What is published begins with the rest of what runs, at the last point before now.
    assert!((0.0..0.011).contains(&(now_s - motion.starts_at_s)));
    let ahead_s = motion.trajectory.duration_s() - plan.trajectory.duration_s();
    assert!((motion.starts_at_s + ahead_s - BEGAN_S - handover.at_s).abs() < 1e-9);
    let began = running.trajectory.state_at(((motion.starts_at_s - BEGAN_S) * 1e9).round() * 1e-9);
    assert!(audit_from(session.robot(), &motion.trajectory, &began).limits_ok);
    assert_eq!((session.counters().planned, session.counters().late), (2, 0));
}

/// Report and message go out together: a reader looks poses up in the trajectory of the message.
#[test]
fn the_report_counts_from_the_start_of_the_published_trajectory() {
    let (mut session, running) = under_way(quick());
    let asked_s = BEGAN_S + 0.203;
    on_track(&mut session, &running, asked_s);
    let job = only_job(session.handle(asked_s, line(0.15)));
    let outcome = only_outcome(session.handle(asked_s + 0.1, Input::Finished(job.run())));
    let motion = outcome.motion.as_ref().unwrap();
    let report = Report::of("ur5e", &outcome.result, Some(motion)).plan.unwrap();
    assert_eq!((report.duration_s, report.points), (motion.trajectory.duration_s(), motion.trajectory.points.len()));
    // Planning took 0.1 s of the lead of 0.4 s; points are 10 ms apart.
    assert!((0.28..0.33).contains(&report.takes_over_s), "{}", report.takes_over_s);
    let handed_over = motion.trajectory.state_at(report.takes_over_s);
    assert_eq!(handed_over, outcome.result.as_ref().unwrap().trajectory.points[0]);
    for (pose, &time_s) in outcome.request.poses.iter().zip(&report.pose_times_s) {
        let tool = session.robot().chain.forward(&motion.trajectory.at(time_s)[0]);
        let error_m = (tool.translation.vector - pose.translation.vector).norm();
        // The tolerance of the path, and as much again between published points; poses lie 0.02 m apart.
        assert!(error_m < 2e-4, "{error_m} m from a pose at {time_s} s");
    }
}

/// Planning that outlasts the lead is repeated with a longer one; at the end of the trajectory nothing can be late any more.
#[test]
fn a_late_plan_is_made_again_with_a_longer_lead() {
    let (mut session, running) = under_way(quick());
    let asked_s = BEGAN_S + 0.3;
    on_track(&mut session, &running, asked_s);
    let job = only_job(session.handle(asked_s, line(0.15)));
    let late_s = asked_s + 0.38;
    let again = only_job(session.handle(late_s, Input::Finished(job.run())));
    assert_eq!(session.counters().late, 1);
    let outcome = again.run();
    let lead_s = BEGAN_S + outcome.request.handover.as_ref().unwrap().at_s - late_s;
    assert!(lead_s > 1.5 * 0.38, "{lead_s}");
    let ended_s = BEGAN_S + running.trajectory.duration_s() + 0.1;
    on_track(&mut session, &running, late_s + 0.85);
    let at_the_end = only_job(session.handle(late_s + 0.9, Input::Finished(outcome)));
    on_track(&mut session, &running, ended_s);
    let outcome = only_outcome(session.handle(ended_s, Input::Finished(at_the_end.run())));
    assert!(outcome.request.handover.as_ref().unwrap().is_at_rest());
    let motion = outcome.motion.unwrap();
    assert!((motion.starts_at_s - ended_s).abs() < 1e-9);
    assert_eq!(motion.trajectory.points[0].positions, running.trajectory.points.last().unwrap().positions);
}

#[test]
fn a_refusal_stops_the_robot_on_its_path_or_lets_it_go_on() {
    let (mut session, running) = under_way(quick());
    let now_s = BEGAN_S + 0.8;
    on_track(&mut session, &running, now_s);
    let outcome = only_outcome(session.handle(now_s, no_pose()));
    assert!(matches!(outcome.result, Err(Refusal::InvalidPose { .. })));
    let stop = outcome.motion.unwrap();
    let ends_s = stop.starts_at_s + stop.trajectory.duration_s();
    assert!(ends_s < BEGAN_S + running.trajectory.duration_s() - 0.2, "no earlier than without a stop");
    let last = stop.trajectory.points.last().unwrap();
    assert!(last.velocities.iter().chain(&last.accelerations).all(|&x| x == 0.0));
    // What is heard next takes over from the stop, not from what was running before.
    on_track(&mut session, &stop, now_s + 0.01);
    let job = only_job(session.handle(now_s + 0.01, line(0.12)));
    let outcome = only_outcome(session.handle(now_s + 0.02, Input::Finished(job.run())));
    assert_eq!(outcome.request.handover.as_ref().unwrap().trajectory, stop.trajectory);
    outcome.motion.unwrap();

    let (mut session, running) = under_way(Config { on_refusal: OnRefusal::Continue, ..quick() });
    on_track(&mut session, &running, now_s);
    assert_eq!(only_outcome(session.handle(now_s, no_pose())).motion, None);
    // It still executes the first trajectory, and goes over from that.
    let job = only_job(session.handle(now_s + 0.01, line(0.12)));
    let outcome = only_outcome(session.handle(now_s + 0.02, Input::Finished(job.run())));
    assert_eq!(outcome.request.handover.unwrap().trajectory, running.trajectory);
}

/// A robot that moves, but not as it was told, is nobody's to take over from; nor is it ours to stop.
#[test]
fn motions_that_are_not_ours_are_refused() {
    let (mut session, running) = under_way(quick());
    let now_s = BEGAN_S + 0.8;
    let [mut q, v, ..] = running.trajectory.at(0.8);
    q[2] += 0.06;
    let elsewhere = measured(&session, &q, &v.add_scalar(0.3));
    session.handle(now_s, elsewhere);
    let outcome = only_outcome(session.handle(now_s, line(0.15)));
    assert!(matches!(outcome.result, Err(Refusal::Moving { .. })) && outcome.motion.is_none());

    // It leaves its trajectory while the next is planned.
    let (mut session, running) = under_way(quick());
    on_track(&mut session, &running, now_s);
    let job = only_job(session.handle(now_s, line(0.15)));
    let stuck = measured(&session, &q, &DVector::zeros(6));
    session.handle(now_s + 0.1, stuck);
    let outcome = only_outcome(session.handle(now_s + 0.1, Input::Finished(job.run())));
    assert!(matches!(outcome.result, Err(Refusal::OffTrajectory { .. })), "{:?}", outcome.result);
    assert!(outcome.motion.is_none());

    // Where it stands after all, a plan begins there, at rest.
    let job = only_job(session.handle(now_s + 0.11, line(0.15)));
    let outcome = only_outcome(session.handle(now_s + 0.2, Input::Finished(job.run())));
    assert_eq!(outcome.request.handover, None);
    assert_eq!(outcome.motion.unwrap().trajectory.points[0].positions, q.as_slice());
}

#[test]
fn a_silent_robot_and_one_without_an_approach_are_not_taken_over() {
    let (mut session, _) = under_way(quick());
    let outcome = only_outcome(session.handle(BEGAN_S + 1.2, line(0.15)));
    assert!(matches!(outcome.result, Err(Refusal::StaleJointState { .. })));

    let (mut session, running) = under_way(quick());
    on_track(&mut session, &running, BEGAN_S + 0.8);
    let forgotten = session.handle(BEGAN_S + 0.8, Input::Clear);
    assert_eq!(forgotten.len(), 2);
    let job = only_job(session.handle(BEGAN_S + 0.8, line(0.15)));
    let outcome = only_outcome(session.handle(BEGAN_S + 0.9, Input::Finished(job.run())));
    assert!(outcome.request.handover.is_some(), "what was cleared is still being executed");

    let off = Config { handover: false, ..quick() };
    let (mut session, running) = under_way(off);
    on_track(&mut session, &running, BEGAN_S + 0.4);
    for input in [line(0.15), no_pose()] {
        let outcome = only_outcome(session.handle(BEGAN_S + 0.4, input));
        assert!(outcome.result.is_err() && outcome.motion.is_none(), "{outcome:?}");
    }

    let without = Config { approach: false, require_joint_state: false, ..quick() };
    let mut session = Session::new(Robot::shipped("ur5e").unwrap(), without);
    let job = only_job(session.handle(BEGAN_S, line(0.1)));
    let motion = only_outcome(session.handle(BEGAN_S, Input::Finished(job.run()))).motion.unwrap();
    on_track(&mut session, &motion, BEGAN_S + 0.5);
    let outcome = only_outcome(session.handle(BEGAN_S + 0.5, line(0.15)));
    assert!(matches!(outcome.result, Err(Refusal::Moving { .. })), "{:?}", outcome.result);
}
