//! The state machine that a node drives.
//!
//! Planning takes seconds and must not block whoever receives messages, so the session never plans itself: it hands out a
//! [`Job`], which the shell runs wherever it likes and brings back as [`Input::Finished`]. While a job runs, the newest poses
//! wait; older waiting ones are superseded and counted. What was cleared meanwhile is not published.

use std::sync::Arc;

use manipulator::Robot;
use se3_geom::pose_from_xyzw;

use crate::config::Config;
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
    /// Outcomes dropped because poses were cleared or replaced by invalid ones meanwhile.
    pub discarded: u64,
}

/// The state between messages.
#[derive(Debug)]
pub struct Session {
    robot: Arc<Robot>,
    config: Arc<Config>,
    joint_positions: Option<Vec<f64>>,
    last: Option<Request>,
    running: bool,
    waiting: bool,
    generation: u64,
    counters: Counters,
}

impl Job {
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
            joint_positions: None,
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

    /// Takes one input and says what to do, in this order.
    pub fn handle(&mut self, input: Input) -> Vec<Output> {
        match input {
            Input::Poses { frame_id, stamp_ns, poses } => self.poses(frame_id, stamp_ns, &poses),
            Input::JointState { names, positions } => self.joint_state(&names, &positions),
            Input::Replan if self.last.is_none() => vec![reply(false, "there are no poses to plan")],
            Input::Replan => {
                let mut outputs = self.request_plan();
                outputs.push(reply(true, "planning the last poses again"));
                outputs
            }
            Input::Clear => {
                self.last = None;
                self.waiting = false;
                self.generation += 1;
                vec![reply(true, "poses and results are forgotten")]
            }
            Input::Finished(outcome) => self.finished(outcome),
        }
    }

    /// Takes new poses, or refuses them as a whole. Refused poses also displace the ones before: what was asked for last must
    /// not be answered with a motion through something older.
    fn poses(&mut self, frame_id: String, stamp_ns: i64, raw: &[RawPose]) -> Vec<Output> {
        self.counters.received += 1;
        self.counters.superseded += u64::from(self.waiting);
        let checked = raw.iter().enumerate().map(|(input_pose, raw)| {
            pose_from_xyzw(raw.position, raw.quaternion_xyzw)
                .map_err(|reason| Refusal::InvalidPose { input_pose, reason })
        });
        match checked.collect::<Result<Vec<_>, _>>() {
            Ok(poses) => {
                self.last = Some(Request { frame_id, stamp_ns, poses, start: None });
                self.request_plan()
            }
            Err(refusal) => {
                self.last = None;
                self.waiting = false;
                self.generation += 1;
                self.counters.refused += 1;
                let request = Request { frame_id, stamp_ns, ..Request::default() };
                vec![Output::Publish(Box::new(Outcome { generation: self.generation, request, result: Err(refusal) }))]
            }
        }
    }

    fn request_plan(&mut self) -> Vec<Output> {
        if self.running {
            self.waiting = true;
            return Vec::new();
        }
        let Some(poses) = self.last.clone() else { return Vec::new() };
        self.running = true;
        self.waiting = false;
        vec![Output::Run(Job {
            generation: self.generation,
            robot: Arc::clone(&self.robot),
            config: Arc::clone(&self.config),
            request: Request { start: self.joint_positions.clone(), ..poses },
        })]
    }

    fn finished(&mut self, outcome: Box<Outcome>) -> Vec<Output> {
        self.running = false;
        let mut outputs = Vec::new();
        if outcome.generation == self.generation {
            match outcome.result {
                Ok(_) => self.counters.planned += 1,
                Err(_) => self.counters.refused += 1,
            }
            outputs.push(Output::Publish(outcome));
        } else {
            self.counters.discarded += 1;
        }
        if self.waiting {
            outputs.extend(self.request_plan());
        }
        outputs
    }

    /// Keeps the positions of this robot's joints, by name. A message that lacks some of them belongs to something else.
    fn joint_state(&mut self, names: &[String], positions: &[f64]) -> Vec<Output> {
        if names.len() != positions.len() {
            return vec![Output::Warn(format!(
                "a joint state has {} names but {} positions and is ignored",
                names.len(),
                positions.len()
            ))];
        }
        let position_of = |joint: &String| names.iter().position(|name| name == joint).map(|i| positions[i]);
        let Some(ours) = self.robot.chain.joint_names().iter().map(position_of).collect::<Option<Vec<_>>>() else {
            return Vec::new();
        };
        if let Some(bad) = ours.iter().position(|q| !q.is_finite()) {
            let joint = &self.robot.chain.joint_names()[bad];
            return vec![Output::Warn(format!("the joint state of {joint} is not a finite number and is ignored"))];
        }
        self.joint_positions = Some(ours);
        Vec::new()
    }
}

fn reply(success: bool, message: &str) -> Output {
    Output::Reply { success, message: message.to_owned() }
}
