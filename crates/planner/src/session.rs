//! The state machine that a node drives.
//!
//! Planning takes seconds and must not block whoever receives messages, so the session never plans itself: it hands out a
//! [`Job`], which the shell runs wherever it likes and brings back as [`Input::Finished`]. While a job runs, the newest poses
//! wait; older waiting ones are superseded, and what comes of the running job is discarded: a robot must not set out along poses
//! when newer ones are known. The same poses again change nothing. What was cleared meanwhile is not published either.
//!
//! Where joint states arrive, a trajectory starts exactly where the robot stands; a robot that was not heard of for a while, or that
//! moved while its trajectory was planned, gets a refusal instead of a jump.
//!
//! The session remembers what it published and when that began. While the robot executes it, a new trajectory takes over from it a
//! lead ahead, in exactly the state that the running one has there; planning that outlasts the lead is done again with a longer one,
//! at last from the rest at the end. A refusal stops the robot on its planned path, unless the configuration lets it go on. A robot
//! that moves otherwise than it was told is refused.

use std::sync::Arc;

use manipulator::Robot;
use se3_geom::pose_from_xyzw;

use crate::config::{Config, OnRefusal};
use crate::exchange::{Counters, Input, Job, Outcome, Output, RawPose};
use crate::joints::MeasuredJoints;
use crate::motion::{Motion, PUBLISHING_S};
use crate::pipeline::{Plan, Request};
use crate::refusal::Refusal;

/// The state between messages.
#[derive(Debug)]
pub struct Session {
    robot: Arc<Robot>,
    config: Arc<Config>,
    joints: Option<MeasuredJoints>,
    last: Option<Request>,
    running: bool,
    waiting: bool,
    /// Whether the last message of poses has no answer yet.
    due: bool,
    generation: u64,
    counters: Counters,
    motion: Option<Motion>,
    asked_at_s: f64,
    lead_s: f64,
}

impl Session {
    /// A session that knows no poses and no joint state yet.
    pub fn new(robot: Robot, config: Config) -> Self {
        Self {
            motion: None,
            asked_at_s: 0.0,
            lead_s: config.handover_lead_s,
            robot: Arc::new(robot),
            config: Arc::new(config),
            joints: None,
            last: None,
            running: false,
            waiting: false,
            due: false,
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

    /// How long ago the robot was last heard of, in s; `None` where it never was.
    pub fn joint_state_age_s(&self, now_s: f64) -> Option<f64> {
        self.joints.as_ref().map(|joints| joints.age_s(now_s))
    }

    /// Takes one input that arrives at `now_s`, in s on a clock that never steps back, and says what to do, in this order.
    pub fn handle(&mut self, now_s: f64, input: Input) -> Vec<Output> {
        match input {
            Input::Poses { frame_id, stamp_ns, poses } => self.poses(now_s, frame_id, stamp_ns, &poses),
            Input::Unplaced { frame_id, stamp_ns, why } => {
                self.receive();
                let (given, base) = (frame_id.clone(), self.robot.base_frame.clone());
                let request = Request { frame_id, stamp_ns, ..Request::default() };
                self.refuse_poses(now_s, request, Refusal::Unplaced { given, base, why })
            }
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
                self.give_up();
                self.last = None;
                self.waiting = false;
                self.generation += 1;
                vec![Output::Withdraw, reply(true, "poses and results are forgotten")]
            }
            Input::Configure(config) => {
                self.config = Arc::new(*config);
                if self.running && self.last.is_some() {
                    self.generation += 1;
                    self.waiting = true;
                }
                Vec::new()
            }
            Input::Robot(robot) => {
                self.give_up();
                self.robot = Arc::new(*robot);
                (self.joints, self.motion, self.last) = (None, None, None);
                self.waiting = false;
                self.generation += 1;
                vec![Output::Withdraw]
            }
            Input::Finished(outcome) => self.finished(now_s, outcome),
        }
    }

    /// Takes new poses, or refuses them as a whole. Refused poses also displace the ones before: what was asked for last must
    /// not be answered with a motion through something older.
    fn poses(&mut self, now_s: f64, frame_id: String, stamp_ns: i64, raw: &[RawPose]) -> Vec<Output> {
        self.receive();
        if raw.len() > self.config.max_poses {
            let refusal = Refusal::TooManyPoses { given: raw.len(), allowed: self.config.max_poses };
            return self.refuse_poses(now_s, Request { frame_id, stamp_ns, ..Request::default() }, refusal);
        }
        let checked = raw.iter().enumerate().map(|(input_pose, raw)| {
            pose_from_xyzw(raw.position, raw.quaternion_xyzw)
                .map_err(|reason| Refusal::InvalidPose { input_pose, reason })
        });
        match checked.collect::<Result<Vec<_>, _>>() {
            Ok(poses) => {
                let request = Request { frame_id, stamp_ns, poses, ..Request::default() };
                let same = |last: &Request| last.frame_id == request.frame_id && last.poses == request.poses;
                if self.running && !self.waiting && self.last.as_ref().is_some_and(same) {
                    // A publisher that repeats itself asks for nothing new, and must not keep its own plan from ending.
                    return Vec::new();
                }
                self.last = Some(request);
                // A motion through older poses is not wanted any more.
                self.generation += u64::from(self.running);
                self.request_plan(now_s)
            }
            Err(refusal) => self.refuse_poses(now_s, Request { frame_id, stamp_ns, ..Request::default() }, refusal),
        }
    }

    /// A message of poses arrived: one before it that has no answer yet gets none.
    fn receive(&mut self) {
        self.counters.received += 1;
        self.give_up();
        self.due = true;
    }

    fn give_up(&mut self) {
        let replaced = u64::from(std::mem::take(&mut self.due));
        self.counters.superseded += replaced;
        self.counters.in_vain += replaced;
    }

    fn answer(&mut self) {
        self.counters.answered += u64::from(std::mem::take(&mut self.due));
        self.counters.in_vain = 0;
    }

    fn refuse_poses(&mut self, now_s: f64, request: Request, refusal: Refusal) -> Vec<Output> {
        self.last = None;
        self.waiting = false;
        self.generation += 1;
        vec![self.refuse(now_s, request, refusal)]
    }

    fn request_plan(&mut self, now_s: f64) -> Vec<Output> {
        self.lead_s = self.config.handover_lead_s;
        self.run(now_s)
    }

    fn run(&mut self, now_s: f64) -> Vec<Output> {
        if self.running {
            self.waiting = true;
            return Vec::new();
        }
        let Some(mut request) = self.last.clone() else { return Vec::new() };
        self.waiting = false;
        match self.begin(now_s, &mut request) {
            Ok(()) => {
                self.running = true;
                self.asked_at_s = now_s;
                vec![Output::Run(Job {
                    generation: self.generation,
                    robot: Arc::clone(&self.robot),
                    config: Arc::clone(&self.config),
                    request,
                })]
            }
            Err(refusal) => vec![self.refuse(now_s, request, refusal)],
        }
    }

    /// Where the trajectory of a request has to begin; a refusal where nothing reliable is known.
    fn begin(&self, now_s: f64, request: &mut Request) -> Result<(), Refusal> {
        match self.executing(now_s) {
            // Without an approach nothing leads over from a moving state.
            Some(motion) if self.config.approach => {
                self.check_on_time(now_s)?;
                request.handover = Some(motion.handover(now_s + self.lead_s));
            }
            _ => request.start = self.present_state(now_s)?,
        }
        Ok(())
    }

    /// What the robot was told to do and has not done yet, unless it is seen to do something else.
    fn executing(&self, now_s: f64) -> Option<&Motion> {
        let motion = self.motion.as_ref().filter(|motion| self.config.handover && now_s < motion.ends_at_s())?;
        self.off(motion).is_none().then_some(motion)
    }

    fn off(&self, motion: &Motion) -> Option<Refusal> {
        self.joints.as_ref()?.off(&self.robot, motion, self.config.handover_tolerance_rad)
    }

    /// Whether the robot was heard of lately, if anything is heard of it.
    fn check_on_time(&self, now_s: f64) -> Result<(), Refusal> {
        let Some(joints) = &self.joints else { return Ok(()) };
        joints.fresh(now_s, self.config.joint_state_max_age_s)
    }

    /// Where the robot stands, if anything says so; a refusal where that cannot be relied on.
    fn present_state(&self, now_s: f64) -> Result<Option<Vec<f64>>, Refusal> {
        let Some(joints) = &self.joints else {
            let unknown = Refusal::NoJointState { robot: self.robot.name.clone() };
            return if self.config.require_joint_state { Err(unknown) } else { Ok(None) };
        };
        joints.standing(&self.robot, now_s, self.config.joint_state_max_age_s).map(Some)
    }

    /// Publishes a refusal, and stops a robot that is under way if that is what the configuration asks for.
    fn refuse(&mut self, now_s: f64, request: Request, refusal: Refusal) -> Output {
        self.counters.refused += 1;
        self.answer();
        let stop = match self.executing(now_s) {
            Some(motion) if self.config.on_refusal == OnRefusal::Stop => {
                // The motion was audited under these very limits: where nothing better is found, its stop is its remainder.
                motion.stopped(&self.robot, now_s, &self.config.timing).ok().flatten()
            }
            _ => None,
        };
        if stop.is_some() {
            self.motion.clone_from(&stop);
        }
        Output::Publish(Box::new(Outcome { generation: self.generation, request, result: Err(refusal), motion: stop }))
    }

    fn finished(&mut self, now_s: f64, outcome: Box<Outcome>) -> Vec<Output> {
        self.running = false;
        let mut outputs = Vec::new();
        if outcome.generation == self.generation {
            let Outcome { request, result, .. } = *outcome;
            match result.and_then(|plan| Ok((self.take_over(now_s, &request, &plan)?, plan))) {
                Ok((Some(motion), plan)) => {
                    self.counters.planned += 1;
                    self.answer();
                    self.motion = Some(motion.clone());
                    let (generation, motion) = (self.generation, Some(motion));
                    outputs.push(Output::Publish(Box::new(Outcome { generation, request, result: Ok(plan), motion })));
                }
                Ok((None, _)) => {
                    self.counters.late += 1;
                    self.lead_s = self.lead_s.max(LEAD_PER_PLANNING_TIME * (now_s - self.asked_at_s) + PUBLISHING_S);
                    return self.run(now_s);
                }
                Err(refusal) => outputs.push(self.refuse(now_s, request, refusal)),
            }
        } else {
            self.counters.discarded += 1;
        }
        if self.waiting {
            outputs.extend(self.request_plan(now_s));
        }
        outputs
    }

    /// What to execute of a plan that was finished at `now_s`; `None` where it is too late to take over.
    fn take_over(&self, now_s: f64, request: &Request, plan: &Plan) -> Result<Option<Motion>, Refusal> {
        let (Some(handover), Some(running)) = (&request.handover, &self.motion) else {
            return self.set_out(now_s, plan).map(Some);
        };
        self.check_on_time(now_s)?;
        if let Some(refusal) = self.off(running) {
            return Err(refusal);
        }
        if now_s >= running.ends_at_s() {
            return Ok(handover.is_at_rest().then(|| Motion::from_rest(plan.trajectory.clone(), now_s)));
        }
        let in_time = now_s + PUBLISHING_S <= running.starts_at_s + handover.at_s;
        Ok(in_time.then(|| running.taken_over(now_s, handover.at_s, &plan.trajectory)))
    }

    /// A plan from rest: the robot must still stand where it begins, whatever was known when planning started.
    fn set_out(&self, now_s: f64, plan: &Plan) -> Result<Motion, Refusal> {
        self.present_state(now_s)?;
        let begin = &plan.trajectory.points[0].positions;
        match self.joints.as_ref().and_then(|joints| joints.moved_from(&self.robot, begin)) {
            Some(moved) => Err(moved),
            None => Ok(Motion::from_rest(plan.trajectory.clone(), now_s)),
        }
    }
}

/// The lead of the next attempt as a multiple of what the last took to plan.
const LEAD_PER_PLANNING_TIME: f64 = 1.5;

fn reply(success: bool, message: &str) -> Output {
    Output::Reply { success, message: message.to_owned() }
}
