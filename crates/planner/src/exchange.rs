//! What goes into a session, and what comes out.

use std::sync::Arc;

use manipulator::Robot;

use crate::config::Config;
use crate::motion::Motion;
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
    /// Unordered poses arrived in a frame whose place to the robot's base is not known.
    Unplaced {
        /// The frame.
        frame_id: String,
        /// When they were taken, in ns since the epoch.
        stamp_ns: i64,
        /// Why its place is not known.
        why: String,
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
    /// From now on this is asked for. What is being planned is planned again: nobody must set out by limits that were lowered meanwhile.
    Configure(Box<Config>),
    /// From now on this robot is planned for. Poses, results, joint states and motions of the one before are forgotten.
    Robot(Box<Robot>),
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
    /// Publish this outcome: a plan, or a refusal; and send its motion to the controller, if there is one.
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
    pub(crate) generation: u64,
    pub(crate) robot: Arc<Robot>,
    pub(crate) config: Arc<Config>,
    pub(crate) request: Request,
}

/// A job that was run.
#[derive(Debug)]
pub struct Outcome {
    pub(crate) generation: u64,
    /// What was asked.
    pub request: Request,
    /// What came of it.
    pub result: Result<Plan, Refusal>,
    /// What the robot has to do now: execute the plan, or stop because of the refusal. `None` where it is to go on as it does.
    pub motion: Option<Motion>,
}

/// What happened so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Pose messages received. All are answered or superseded but the last, which may still be planned.
    pub received: u64,
    /// Pose messages that a trajectory or a refusal answered.
    pub answered: u64,
    /// Pose messages without an answer, because newer ones came, or they were cleared.
    pub superseded: u64,
    /// How many of these came since the last answer.
    pub in_vain: u64,
    /// Trajectories published.
    pub planned: u64,
    /// Refusals published.
    pub refused: u64,
    /// Outcomes dropped because poses were cleared or replaced meanwhile.
    pub discarded: u64,
    /// Plans made again because planning outlasted the lead of the hand-over.
    pub late: u64,
}

impl Job {
    /// The outcome of a job that was lost on the way, so that the session does not wait for it for ever.
    pub fn lost(self, why: String) -> Box<Outcome> {
        Box::new(Outcome {
            generation: self.generation,
            request: self.request,
            result: Err(Refusal::Internal(why)),
            motion: None,
        })
    }

    /// Plans. Pure and possibly slow.
    pub fn run(self) -> Box<Outcome> {
        let result = plan(&self.robot, &self.config, &self.request);
        Box::new(Outcome { generation: self.generation, request: self.request, result, motion: None })
    }
}
