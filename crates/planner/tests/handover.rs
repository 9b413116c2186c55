//! New poses at random times of an execution: the arm goes over to them without a jump, or stops on its path. Whatever a controller
//! executes in the end is one legal trajectory. `cargo xtask soak handovers 200` runs two hundred on each arm, the tests a few.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use std::collections::BTreeMap;

use planner::manipulator::nalgebra::Vector3;
use planner::manipulator::{JointTrajectory, ManipulatorError, Robot, audit};
use planner::se3_geom::{LieGroup, Pose, So3Group, xyzw_from_rotation};
use planner::{Config, Input, Job, Motion, Outcome, Output, RawPose, Refusal, Session};
use support::random::Random;

const SAMPLE: usize = 8;
/// The hand-overs are judged in runs, each from rest, so that no single trajectory grows without end.
const HANDOVERS_A_RUN: usize = 8;
const LEAD_S: f64 = 0.5;

/// A shuffled curve of three harmonics in front of the arm; one in eight is out of its reach, one in sixteen holds no pose.
fn poses(home: &Pose, random: &mut Random) -> Vec<RawPose> {
    let count = random.between(40.0, 90.0) as usize;
    let closed = random.between(0.0, 1.0) < 0.5;
    let harmonics: Vec<[f64; 6]> = (0..3).map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))).collect();
    let kind = random.between(0.0, 1.0);
    let away = if kind < 0.125 { 3.0 } else { 0.0 };
    let turn = if closed { std::f64::consts::TAU } else { 4.0 };
    let mut raw: Vec<RawPose> = (0..count)
        .map(|i| {
            let phase = turn * i as f64 / count as f64;
            let mut value = [0.0; 6];
            for (k, amplitudes) in harmonics.iter().enumerate() {
                let order = (k + 1) as f64;
                value
                    .iter_mut()
                    .zip(amplitudes)
                    .for_each(|(v, a)| *v += a * (order * phase + a).sin() / (order * order));
            }
            let [x, y, z, a, b, c] = value;
            let rotation = home.rotation * So3Group::exp(Vector3::new(a, b, c) * 0.15);
            let p = home.translation.vector + Vector3::new(0.08 * x + away, 0.08 * y, 0.04 * z);
            RawPose { position: [p.x, p.y, p.z], quaternion_xyzw: xyzw_from_rotation(&rotation) }
        })
        .collect();
    if kind > 0.9375 {
        raw[count / 2].quaternion_xyzw = [0.0; 4];
    }
    for i in (1..count).rev() {
        raw.swap(i, (random.between(0.0, 1.0) * (i + 1) as f64) as usize);
    }
    raw
}

/// A robot with a controller that executes whatever it was sent last, and what it executed since it last set out from rest.
struct Arm {
    session: Session,
    began_s: f64,
    executed: Option<JointTrajectory>,
    standing: Vec<f64>,
}

impl Arm {
    fn new(name: &str) -> Self {
        let robot = Robot::shipped(name).unwrap();
        let standing = robot.preferred.as_slice().to_vec();
        // Shorter than by default, because the random trajectories last a few seconds only.
        let config = Config { handover: true, handover_lead_s: LEAD_S, ..Config::default() };
        Self { session: Session::new(robot, config), began_s: 0.0, executed: None, standing }
    }

    fn ends_s(&self) -> f64 {
        self.executed.as_ref().map_or(f64::NEG_INFINITY, |e| self.began_s + e.duration_s())
    }

    /// The joint state at `now_s`, measured with a delay of 5 ms and noise of 0.1 mrad.
    fn measure(&mut self, now_s: f64, random: &mut Random) {
        let (mut positions, mut velocities) = (self.standing.clone(), vec![0.0; self.standing.len()]);
        if let Some(executed) = &self.executed {
            let [q, v, ..] = executed.at((now_s - 0.005 - self.began_s).max(0.0));
            (positions, velocities) = (q.as_slice().to_vec(), v.as_slice().to_vec());
        }
        positions.iter_mut().for_each(|q| *q += random.between(-1e-4, 1e-4));
        let names = self.session.robot().chain.joint_names().to_vec();
        assert!(self.session.handle(now_s, Input::JointState { names, positions, velocities }).is_empty());
    }

    /// Takes up a motion that was published at `now_s`. It must go on exactly as the arm moves.
    fn execute(&mut self, now_s: f64, motion: &Motion) {
        let next = (*motion.trajectory).clone();
        if now_s < self.ends_s() {
            let executed = self.executed.as_ref().unwrap();
            let from_s = ((motion.starts_at_s - self.began_s) * 1e9).round() * 1e-9;
            assert!(motion.starts_at_s <= now_s, "a first point in the future would be approached by other means");
            assert_eq!(executed.state_at(from_s), next.points[0], "it begins at a point of what is executed");
            // A controller that hears of it up to 50 ms later sees no difference.
            for delay_s in [0.0, 0.02, 0.05] {
                let [old, new] =
                    [executed.at(now_s + delay_s - self.began_s), next.at(now_s + delay_s - motion.starts_at_s)];
                for order in 0..3 {
                    // Times differ in rounding: 1e-13 s at ten minutes, against a jerk of 50 rad/s³ and a step of 10 ms.
                    assert!(
                        (&old[order] - &new[order]).amax() < 1e-9,
                        "order {order} jumps {delay_s} s after publishing"
                    );
                }
            }
            self.executed = Some(executed.switched(from_s, &next));
        } else {
            self.judge();
            (self.began_s, self.executed) = (motion.starts_at_s, Some(next));
        }
    }

    /// All that was executed since the arm last stood is one legal trajectory from rest to rest.
    fn judge(&mut self) {
        let Some(executed) = self.executed.take() else { return };
        let found = audit(self.session.robot(), &executed);
        assert!(found.limits_ok && found.starts_and_ends_at_rest && found.times_increase, "{found:?}");
        self.standing.clone_from(&executed.points[executed.points.len() - 1].positions);
    }
}

fn only_job(outputs: Vec<Output>) -> Result<Job, Box<Outcome>> {
    match <[Output; 1]>::try_from(outputs).unwrap() {
        [Output::Run(job)] => Ok(job),
        [Output::Publish(outcome)] => Err(outcome),
        other => panic!("{other:?}"),
    }
}

fn reason(refusal: &Refusal) -> &'static str {
    match refusal {
        Refusal::InvalidPose { .. } => "a pose is none",
        Refusal::Verdict { .. } => "the order is uncertain",
        Refusal::Manipulator { source, .. } => match &**source {
            ManipulatorError::Unreachable(_) => "out of reach",
            ManipulatorError::UnreachableBetween { .. }
            | ManipulatorError::CutOff { .. }
            | ManipulatorError::JointLimit { .. }
            | ManipulatorError::Singular { .. }
            | ManipulatorError::Jump { .. }
            | ManipulatorError::NotCyclic { .. } => "the arm cannot follow",
            // Where the curve can be followed it can be led to, whatever the arm is doing.
            other => panic!("{other}"),
        },
        other => panic!("{other}"),
    }
}

/// The tool is at each input pose when the plan says so, counted from the hand-over.
fn assert_passes_poses(arm: &Arm, outcome: &Outcome, motion: &Motion) {
    let plan = outcome.result.as_ref().unwrap();
    let begins_s = motion.trajectory.duration_s() - plan.trajectory.duration_s();
    for (pose, &time) in outcome.request.poses.iter().zip(&plan.pose_times_s) {
        let tool = arm.session.robot().chain.forward(&motion.trajectory.at(begins_s + time)[0]);
        assert!((tool.translation.vector - pose.translation.vector).norm() < 2e-4);
        assert!(tool.rotation.angle_to(&pose.rotation) < 2e-3);
    }
}

fn assert_taken_over_or_stopped(name: &str) {
    let wanted = std::env::var("REORDER_SOAK_CASES").ok().map_or(SAMPLE, |n| n.parse().unwrap());
    let mut random = Random::new(2026);
    let mut arm = Arm::new(name);
    let home = arm.session.robot().chain.forward(&arm.session.robot().preferred);
    let mut tally = BTreeMap::<String, usize>::new();
    let mut now_s = 100.0;
    let (mut handovers, mut in_run) = (0, 0);
    while handovers < wanted {
        let under_way = now_s < arm.ends_s();
        arm.measure(now_s, &mut random);
        let mut asked = only_job(
            arm.session
                .handle(now_s, Input::Poses { frame_id: String::new(), stamp_ns: 0, poses: poses(&home, &mut random) }),
        );
        let outcome = loop {
            let job = match asked {
                Ok(job) => job,
                Err(outcome) => break outcome,
            };
            // One plan in ten takes longer than the lead.
            now_s += LEAD_S * if random.between(0.0, 1.0) < 0.1 { 1.3 } else { random.between(0.05, 0.85) };
            let outcome = job.run();
            arm.measure(now_s, &mut random);
            asked = only_job(arm.session.handle(now_s, Input::Finished(outcome)));
        };
        let what = match (&outcome.result, &outcome.motion) {
            (Ok(_), Some(motion)) => {
                assert_passes_poses(&arm, &outcome, motion);
                if outcome.request.handover.as_ref().is_some_and(|h| !h.is_at_rest()) {
                    "connected"
                } else {
                    "from rest"
                }
                .to_owned()
            }
            (Err(refusal), Some(_)) => format!("stopped: {}", reason(refusal)),
            (Err(refusal), None) => format!("refused, near its end anyway: {}", reason(refusal)),
            (Ok(_), None) => panic!("a plan without a motion"),
        };
        if let Some(motion) = &outcome.motion {
            arm.execute(now_s, motion);
        }
        if under_way {
            handovers += 1;
            in_run += 1;
            *tally.entry(what).or_default() += 1;
        }
        now_s += 0.001;
        let left = arm.ends_s() - now_s;
        if left > 0.0 {
            // Now and then the arm comes to rest, and all that it did is judged.
            now_s += if in_run >= HANDOVERS_A_RUN { left + 1.0 } else { random.between(0.0, 1.0).powi(2) * left };
        }
        if now_s > arm.ends_s() {
            now_s += 1.0;
            in_run = 0;
        }
    }
    arm.judge();
    println!("{handovers} hand-overs of the {name}: {tally:?}, {} plans late", arm.session.counters().late);
    let connected = tally.get("connected").copied().unwrap_or(0);
    assert!(8 * connected >= handovers, "too few to say anything: {tally:?}");
}

#[test]
fn the_ur5e_goes_over_or_stops() {
    assert_taken_over_or_stopped("ur5e");
}

#[test]
fn the_viperx_goes_over_or_stops() {
    assert_taken_over_or_stopped("vx300s");
}

#[test]
fn the_panda_goes_over_or_stops() {
    assert_taken_over_or_stopped("panda");
}
