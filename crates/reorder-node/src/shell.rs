//! What happens to everything that arrives.

mod changes;
mod goals;
mod poses;
mod reports;

use std::sync::Arc;
use std::time::{Duration, Instant};

use planner::{Input, Motion, Outcome, Output, Session};
use r2r::control_msgs::action::FollowJointTrajectory;
use r2r::std_srvs::srv::Trigger;
use r2r::{ActionClientGoal, ServiceRequest};
use tokio::sync::mpsc;

use crate::collecting::Collecting;
use crate::diagnostics::{Answer, Health, Level, OddPoses, Progress};
use crate::execution::Controller;
use crate::inbox::Inbox;
use crate::interface::{Arrival, Interface, Publishers};
use crate::lifecycle::LifeCycle;
use crate::log::Log;
use crate::managed::LifeCycleServices;
use crate::message::{joint_state_input, trajectory_message};
use crate::parameters::{ParameterServices, Parameters};
use crate::placing::Placing;
use crate::stamps::Stamps;

/// The session and everything around it that is not the middleware's.
pub(crate) struct Shell {
    session: Session,
    parameters: Parameters,
    life: LifeCycle,
    health: Health,
    collecting: Collecting,
    odd_poses: OddPoses,
    placing: Placing,
    /// Where trajectories are goals of an action.
    controller: Option<Controller>,
    /// The last goal, and its handle once it is accepted, until it ends.
    goal: (u64, Option<ActionClientGoal<FollowJointTrajectory::Action>>),
    /// When the poses arrived that have no answer yet.
    asked: Option<Instant>,
    /// The worst level of the last report.
    told: Level,
    /// The last robot_description, so that the same one again changes nothing.
    description: String,
    stamps: Stamps,
    publishers: Publishers,
    services: Services,
    name: String,
    log: Log,
    finish: mpsc::UnboundedSender<Finished>,
}

/// Where everything goes that the shell says.
pub(crate) struct Outward {
    pub(crate) publishers: Publishers,
    /// Where trajectories are goals of an action.
    pub(crate) controller: Option<Controller>,
    /// The node's full name.
    pub(crate) name: String,
    pub(crate) log: Log,
}

/// What comes of a job.
pub(crate) struct Finished {
    outcome: Box<Outcome>,
    took: Duration,
}

/// What the shell needs of the interface.
struct Services {
    poses: Arc<Inbox<r2r::geometry_msgs::msg::PoseArray>>,
    single_poses: Arc<Inbox<r2r::geometry_msgs::msg::PoseStamped>>,
    joint_states: Arc<Inbox<r2r::sensor_msgs::msg::JointState>>,
    parameters: ParameterServices,
    life_cycle: LifeCycleServices,
}

impl Shell {
    /// A shell whose finished jobs go to `finish`, and the arrivals that it has to be given.
    pub(crate) fn new(
        session: Session,
        parameters: Parameters,
        interface: Interface,
        outward: Outward,
        finish: mpsc::UnboundedSender<Finished>,
    ) -> (Self, futures::stream::BoxStream<'static, Arrival>) {
        let Outward { publishers, controller, name, log } = outward;
        let Interface {
            arrivals, poses, single_poses, joint_states, parameters: parameter_services, life_cycle, ..
        } = interface;
        let shell = Self {
            session,
            parameters,
            life: LifeCycle::unconfigured(),
            health: Health {
                execution: controller.as_ref().map(|_| Progress::new("nothing has been sent yet")),
                ..Health::default()
            },
            collecting: Collecting::default(),
            odd_poses: OddPoses::default(),
            placing: Placing::default(),
            controller,
            goal: (0, None),
            asked: None,
            told: Level::Ok,
            description: String::new(),
            stamps: Stamps::new(),
            publishers,
            services: Services { poses, single_poses, joint_states, parameters: parameter_services, life_cycle },
            name,
            log,
            finish,
        };
        (shell, arrivals)
    }

    /// Tells what there is, and becomes active if that is wanted.
    pub(crate) fn start(&mut self) {
        let told = self.services.parameters.declare(&self.parameters, Stamps::now_ns());
        self.check("telling the parameters", told);
        if self.parameters.autostart {
            for transition in ["configure", "activate"] {
                let changed = self.services.life_cycle.change(&mut self.life, 0, transition, Stamps::now_ns());
                self.check("telling the state", changed.map(drop));
            }
        }
        let robot = self.session.robot();
        self.log.info(format!(
            "{} and ready for {} ({} joints, base frame {}); one radian counts as {} m",
            self.life.state().1,
            robot.name,
            robot.chain.dof(),
            robot.base_frame,
            self.parameters.config.metres_per_radian
        ));
    }

    pub(crate) fn take(&mut self, arrival: Arrival) {
        match arrival {
            Arrival::Poses(at, message) if self.life.is_active() => {
                tracing::debug!(poses = message.poses.len(), frame = message.header.frame_id, "poses arrived");
                if self.collecting.finish().is_some() {
                    self.log
                        .warn("the poses that came one by one so far are dropped: an array of poses takes their place");
                }
                self.ask(at, message);
            }
            Arrival::Pose(at, message) if self.life.is_active() => self.collect(at, message),
            Arrival::Poses(..) | Arrival::Pose(..) => {
                self.log.warn(format!("poses are ignored: the node is {}", self.life.state().1))
            }
            Arrival::JointState(message) => self.handle(joint_state_input(message), None),
            Arrival::Description(urdf) => self.describe(urdf),
            Arrival::Transforms(message, fixed) => {
                let bad = self.placing.learn(&message, fixed);
                if bad > 0 {
                    self.log.warn(format!("{bad} transforms are ignored: their numbers are no rotation or no place"));
                }
                self.place();
            }
            Arrival::Cancel(request) => self.cancel(request),
            Arrival::Trigger(Input::Replan, request) if !self.life.is_active() => {
                let message = format!("the node is {}: activate it first", self.life.state().1);
                self.respond(request, false, message);
            }
            Arrival::Trigger(Input::Replan, request) if self.collecting.len() > 0 => {
                let message = format!("planning the {} poses that came one by one", self.collecting.len());
                self.finish_collecting();
                self.respond(request, true, message);
            }
            Arrival::Trigger(input, request) => {
                if matches!(input, Input::Clear) {
                    self.forget_waiting();
                }
                self.handle(input, Some(request));
            }
            Arrival::Parameters(call) => self.answer(call),
            Arrival::LifeCycle(call) => self.live(call),
        }
    }

    pub(crate) fn finish(&mut self, Finished { outcome, took }: Finished) {
        self.health.planning.add(took.as_secs_f64());
        self.handle(Input::Finished(outcome), None);
    }

    /// Gives an input to the session and does what comes of it.
    fn handle(&mut self, input: Input, mut request: Option<ServiceRequest<Trigger::Service>>) {
        for output in self.session.handle(self.stamps.now_s(), input) {
            match output {
                Output::Run(job) => {
                    tracing::debug!("planning begins");
                    let finish = self.finish.clone();
                    tokio::spawn(async move {
                        let (spare, began) = (job.clone(), Instant::now());
                        let ran = tokio::task::spawn_blocking(move || job.run()).await;
                        let outcome = ran.unwrap_or_else(|panic| spare.lost(panic.to_string()));
                        // The receiver is gone only when the node shuts down.
                        let _ = finish.send(Finished { outcome, took: began.elapsed() });
                    });
                }
                Output::Publish(outcome) => self.publish(&outcome),
                Output::Reply { success, message } => {
                    if let Some(request) = request.take() {
                        self.respond(request, success, message);
                    }
                }
                Output::Withdraw => {
                    self.health.last = None;
                    let withdrawn = self.publishers.withdraw();
                    self.check("withdrawing", withdrawn);
                }
                Output::Warn(sentence) => self.log.warn(sentence),
            }
        }
    }

    fn publish(&mut self, outcome: &Outcome) {
        self.health.last = Some(match &outcome.result {
            Ok(plan) => {
                let sentence = format!(
                    "{} poses in {:?} order, {} points, {:.2} s",
                    outcome.request.poses.len(),
                    plan.ordering.verdict,
                    plan.trajectory.points.len(),
                    plan.trajectory.duration_s()
                );
                self.log.info(&sentence);
                Answer::planned(sentence)
            }
            Err(refusal) => {
                let stops = if outcome.motion.is_some() { "stopping, because there is" } else { "there is" };
                self.log.warn(format!("{stops} no trajectory: {refusal}"));
                Answer::refused(refusal)
            }
        });
        let robot = self.session.robot();
        let (stamped, stamps, controller) =
            (self.parameters.planner_config().handover, &mut self.stamps, self.controller.as_mut());
        let (goal, publishers) = (&mut self.goal, &self.publishers);
        let send = |motion: &Motion| {
            // Without a stamp a trajectory starts when it arrives.
            let stamp_ns = if stamped { stamps.of(motion) } else { 0 };
            let message = trajectory_message(&motion.trajectory, &robot.base_frame, stamp_ns);
            match controller {
                Some(controller) => *goal = (controller.execute(message), None),
                None => publishers.publish_trajectory(&message)?,
            }
            Ok(())
        };
        let published = publishers.publish(robot, outcome, send);
        self.check("publishing", published);
        if let Some(asked) = self.asked.take() {
            tracing::debug!(latency = ?asked.elapsed(), "answered");
            self.health.latency.add(asked.elapsed().as_secs_f64());
        }
        self.report_if_changed();
    }

    pub(crate) fn say_goodbye(&self) {
        self.log.info("shutting down");
    }

    fn respond(&self, request: ServiceRequest<Trigger::Service>, success: bool, message: String) {
        self.check("answering a service", request.respond(Trigger::Response { success, message }));
    }

    fn check(&self, doing: &str, result: r2r::Result<()>) {
        if let Err(error) = result {
            self.log.error(format!("{doing} failed: {error}"));
        }
    }
}
