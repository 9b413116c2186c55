//! The state machine that a node drives.
//!
//! Planning takes seconds and must not block whoever receives messages, so the session never plans itself: it hands out a
//! [`Job`], which the shell runs wherever it likes and brings back as [`Input::Finished`]. While a job runs, the newest poses
//! wait; older waiting ones are superseded, and what comes of the running job is discarded: a robot must not set out along poses
//! when newer ones are known. The same poses again change nothing. What was cleared meanwhile is not published either.
//!
//! Where joint states arrive, a trajectory starts exactly where the robot stands; a robot that moves, that was not heard of for a
//! while, or that moved while its trajectory was planned gets a refusal instead of a jump.

use std::sync::Arc;

use manipulator::Robot;
use se3_geom::pose_from_xyzw;

use crate::config::Config;
use crate::joints::MeasuredJoints;
use crate::pipeline::{Plan, Request, plan};
use crate::refusal::Refusal;

/// Something that happened.
#[derive(Debug)]
pub enum Input {
    /// Unordered poses arrived.
    Poses {
        /// Frame they are in.
        frame_id: String,
        /// When they were taken, in ns since the epoch; passed through.
        stamp_ns: i64,
        /// `base_from_tool`, unchecked.
        poses: Vec<RawPose>,
    },
    /// The robot's joints were measured, in any joint order; joints of other robots are ignored.
    JointState {
        /// Joint names.
        names: Vec<String>,
        /// Positions in rad (or m), one a name.
        positions: Vec<f64>,
        /// Velocities in rad/s (or m/s), one a name, or none at all.
        velocities: Vec<f64>,
    },
    /// Plan the last poses again, from the present joint state.
    Replan,
    /// Forget poses and results.
    Clear,
    /// A job was run.
    Finished(Box<Outcome>),
}

/// A pose as a message carries it, before anything was checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawPose {
    /// In m.
    pub position: [f64; 3],
    /// In the order x, y, z, w.
    pub quaternion_xyzw: [f64; 4],
}

/// Something to do.
#[derive(Debug)]
pub enum Output {
    /// Run this, off the receiving task, and bring back its outcome.
    Run(Job),
    /// Publish this outcome: a trajectory, or a refusal.
    Publish(Box<Outcome>),
    /// Answer to [`Input::Replan`] or [`Input::Clear`].
    Reply {
        /// Whether it was done.
        success: bool,
        /// One sentence.
        message: String,
    },
    /// Withdraw what was published: it no longer holds.
    Withdraw,
    /// Something that a person should know; one sentence.
    Warn(String),
}

/// A plan to be made.
#[derive(Debug, Clone)]
pub struct Job {
    generation: u64,
    robot: Arc<Robot>,
    config: Arc<Config>,
    request: Request,
}

/// A job that was run.
#[derive(Debug)]
pub struct Outcome {
    generation: u64,
    /// What was asked.
    pub request: Request,
    /// What came of it.
    pub result: Result<Plan, Refusal>,
}

/// What happened so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Pose messages received.
    pub received: u64,
    /// Pose messages replaced by a newer one before they were planned.
    pub superseded: u64,
    /// Trajectories published.
    pub planned: u64,
    /// Refusals published.
    pub refused: u64,
    /// Outcomes dropped because poses were cleared or replaced meanwhile.
    pub discarded: u64,
}

/// The state between messages.
#[derive(Debug)]
pub struct Session {
    robot: Arc<Robot>,
    config: Arc<Config>,
    joints: Option<MeasuredJoints>,
    last: Option<Request>,
    running: bool,
    waiting: bool,
    generation: u64,
    counters: Counters,
}

impl Job {
    /// The outcome of a job that was lost on the way, so that the session does not wait for it for ever.
    pub fn lost(self, why: String) -> Box<Outcome> {
        Box::new(Outcome { generation: self.generation, request: self.request, result: Err(Refusal::Internal(why)) })
    }

    /// Plans. Pure and possibly slow.
    pub fn run(self) -> Box<Outcome> {
        let result = plan(&self.robot, &self.config, &self.request);
        Box::new(Outcome { generation: self.generation, request: self.request, result })
    }
}

impl Session {
    /// A session that knows no poses and no joint state yet.
    pub fn new(robot: Robot, config: Config) -> Self {
        Self {
            robot: Arc::new(robot),
            config: Arc::new(config),
            joints: None,
            last: None,
            running: false,
            waiting: false,
            generation: 0,
            counters: Counters::default(),
        }
    }

    /// The robot that is planned for.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// What happened so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Takes one input that arrives at `now_s`, in s on a clock that never steps back, and says what to do, in this order.
    pub fn handle(&mut self, now_s: f64, input: Input) -> Vec<Output> {
        match input {
            Input::Poses { frame_id, stamp_ns, poses } => self.poses(now_s, frame_id, stamp_ns, &poses),
            Input::JointState { names, positions, velocities } => {
                match MeasuredJoints::read(&self.robot, now_s, &names, &positions, &velocities) {
                    Ok(Some(joints)) => self.joints = Some(joints),
                    Ok(None) => {}
                    Err(why) => return vec![Output::Warn(format!("a joint state is ignored: {why}"))],
                }
                Vec::new()
            }
            Input::Replan if self.last.is_none() => vec![reply(false, "there are no poses to plan")],
            Input::Replan => {
                let mut outputs = self.request_plan(now_s);
                outputs.push(reply(true, "planning the last poses again"));
                outputs
            }
            Input::Clear => {
                self.last = None;
                self.waiting = false;
                self.generation += 1;
                vec![Output::Withdraw, reply(true, "poses and results are forgotten")]
            }
            Input::Finished(outcome) => self.finished(now_s, outcome),
        }
    }

    /// Takes new poses, or refuses them as a whole. Refused poses also displace the ones before: what was asked for last must
    /// not be answered with a motion through something older.
    fn poses(&mut self, now_s: f64, frame_id: String, stamp_ns: i64, raw: &[RawPose]) -> Vec<Output> {
        self.counters.received += 1;
        let checked = raw.iter().enumerate().map(|(input_pose, raw)| {
            pose_from_xyzw(raw.position, raw.quaternion_xyzw)
                .map_err(|reason| Refusal::InvalidPose { input_pose, reason })
        });
        match checked.collect::<Result<Vec<_>, _>>() {
            Ok(poses) => {
                let request = Request { frame_id, stamp_ns, poses, start: None };
                let same = |last: &Request| last.frame_id == request.frame_id && last.poses == request.poses;
                if self.running && !self.waiting && self.last.as_ref().is_some_and(same) {
                    // A publisher that repeats itself asks for nothing new, and must not keep its own plan from ending.
                    return Vec::new();
                }
                self.last = Some(request);
                // A motion through older poses is not wanted any more.
                self.generation += u64::from(self.running);
                self.counters.superseded += u64::from(self.waiting);
                self.request_plan(now_s)
            }
            Err(refusal) => {
                self.last = None;
                self.waiting = false;
                self.generation += 1;
                let request = Request { frame_id, stamp_ns, ..Request::default() };
                vec![self.publish(request, Err(refusal))]
            }
        }
    }

    fn request_plan(&mut self, now_s: f64) -> Vec<Output> {
        if self.running {
            self.waiting = true;
            return Vec::new();
        }
        let Some(poses) = self.last.clone() else { return Vec::new() };
        self.waiting = false;
        match self.present_state(now_s) {
            Ok(start) => {
                self.running = true;
                vec![Output::Run(Job {
                    generation: self.generation,
                    robot: Arc::clone(&self.robot),
                    config: Arc::clone(&self.config),
                    request: Request { start, ..poses },
                })]
            }
            Err(refusal) => vec![self.publish(poses, Err(refusal))],
        }
    }

    /// Where the robot stands, if anything says so; a refusal where that cannot be relied on.
    fn present_state(&self, now_s: f64) -> Result<Option<Vec<f64>>, Refusal> {
        let Some(joints) = &self.joints else {
            let unknown = Refusal::NoJointState { robot: self.robot.name.clone() };
            return if self.config.require_joint_state { Err(unknown) } else { Ok(None) };
        };
        joints.standing(&self.robot, now_s, self.config.joint_state_max_age_s).map(Some)
    }

    fn publish(&mut self, request: Request, result: Result<Plan, Refusal>) -> Output {
        match result {
            Ok(_) => self.counters.planned += 1,
            Err(_) => self.counters.refused += 1,
        }
        Output::Publish(Box::new(Outcome { generation: self.generation, request, result }))
    }

    fn finished(&mut self, now_s: f64, outcome: Box<Outcome>) -> Vec<Output> {
        self.running = false;
        let mut outputs = Vec::new();
        if outcome.generation == self.generation {
            let Outcome { request, result, .. } = *outcome;
            // The robot must still stand where the trajectory begins, whatever was known when planning started.
            let result = result.and_then(|plan| {
                let begin = &plan.trajectory.points[0].positions;
                self.present_state(now_s)?;
                match self.joints.as_ref().and_then(|joints| joints.moved_from(&self.robot, begin)) {
                    Some(moved) => Err(moved),
                    None => Ok(plan),
                }
            });
            outputs.push(self.publish(request, result));
        } else {
            self.counters.discarded += 1;
        }
        if self.waiting {
            outputs.extend(self.request_plan(now_s));
        }
        outputs
    }
}

fn reply(success: bool, message: &str) -> Output {
    Output::Reply { success, message: message.to_owned() }
}
