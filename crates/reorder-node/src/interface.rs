//! Topics and services of the node.

use std::sync::Arc;
use std::time::Instant;

use futures::stream::{BoxStream, StreamExt, select_all};
use planner::pose_bag::encode;
use planner::pose_bag::msg::{self, MarkerArray, Message};
use planner::{Drawn, Input, Motion, Outcome, Report};
use r2r::diagnostic_msgs::msg::DiagnosticArray;
use r2r::geometry_msgs::msg::{PoseArray, PoseStamped};
use r2r::nav_msgs::msg::Path;
use r2r::sensor_msgs::msg::JointState;
use r2r::std_msgs::msg::Header;
use r2r::std_srvs::srv::Trigger;
use r2r::tf2_msgs::msg::TFMessage;
use r2r::trajectory_msgs::msg::JointTrajectory;
use r2r::{Node, Publisher, PublisherUntyped, QosProfile, ServiceRequest};

use crate::inbox::{Emptying, Inbox};
use crate::managed::{LifeCycleCall, LifeCycleServices};
use crate::message::{header, path_message, pose_array};
use crate::parameters::{ParameterCall, ParameterServices};

/// Newer poses replace older ones that nobody has looked at: only the last asks for a motion.
const POSES_KEPT: usize = 1;
/// All of them belong to the set.
const SINGLE_POSES_KEPT: usize = 100_000;
/// Of several robots on one topic each may say something else, so some are kept.
const JOINT_STATES_KEPT: usize = 64;
/// Each may be about other frames.
const TRANSFORMS_KEPT: usize = 1000;

/// What arrives at the node.
pub(crate) enum Arrival {
    Poses(Instant, PoseArray),
    /// One of a set.
    Pose(Instant, PoseStamped),
    JointState(JointState),
    Description(String),
    /// Transforms; whether they hold for ever.
    Transforms(TFMessage, bool),
    /// The goal under way is not wanted any more.
    Cancel(ServiceRequest<Trigger::Service>),
    Trigger(Input, ServiceRequest<Trigger::Service>),
    Parameters(ParameterCall),
    LifeCycle(LifeCycleCall),
}

/// Everything the node hears and is asked.
pub(crate) struct Interface {
    pub(crate) arrivals: BoxStream<'static, Arrival>,
    /// To be called after every spin.
    pub(crate) emptying: Vec<Emptying>,
    pub(crate) poses: Arc<Inbox<PoseArray>>,
    pub(crate) single_poses: Arc<Inbox<PoseStamped>>,
    pub(crate) joint_states: Arc<Inbox<JointState>>,
    pub(crate) parameters: ParameterServices,
    pub(crate) life_cycle: LifeCycleServices,
}

impl Interface {
    /// Subscribes to everything and merges it into one stream.
    pub(crate) fn create(node: &mut Node) -> r2r::Result<Self> {
        let reliable = |depth| QosProfile::default().reliable().keep_last(depth);
        let latched = |depth| reliable(depth).transient_local();
        let (poses, arrays, empty_poses) = Inbox::emptying(node.subscribe("~/poses", reliable(10))?, POSES_KEPT);
        let (single_poses, singles, empty_singles) =
            Inbox::emptying(node.subscribe("~/pose", reliable(1000))?, SINGLE_POSES_KEPT);
        let (joint_states, states, empty_states) =
            Inbox::emptying(node.subscribe("joint_states", QosProfile::sensor_data())?, JOINT_STATES_KEPT);
        let (_, descriptions, empty_descriptions) =
            Inbox::emptying(node.subscribe::<r2r::std_msgs::msg::String>("robot_description", latched(1))?, 1);
        let (_, transforms, empty_transforms) =
            Inbox::emptying(node.subscribe::<TFMessage>("/tf", reliable(100))?, TRANSFORMS_KEPT);
        let (_, fixed_transforms, empty_fixed) =
            Inbox::emptying(node.subscribe::<TFMessage>("/tf_static", latched(100))?, TRANSFORMS_KEPT);
        let emptying =
            vec![empty_poses, empty_singles, empty_states, empty_descriptions, empty_transforms, empty_fixed];
        let mut trigger = |name: &str| node.create_service::<Trigger::Service>(name, QosProfile::services_default());
        let replan = trigger("~/replan")?;
        let clear = trigger("~/clear")?;
        let cancel = trigger("~/cancel")?;
        let (parameters, parameter_calls) = ParameterServices::create(node)?;
        let (life_cycle, life_cycle_calls) = LifeCycleServices::create(node)?;
        let arrivals = select_all([
            arrays.map(|(at, message)| Arrival::Poses(at, message)).boxed(),
            singles.map(|(at, message)| Arrival::Pose(at, message)).boxed(),
            states.map(|(_, message)| Arrival::JointState(message)).boxed(),
            descriptions.map(|(_, message)| Arrival::Description(message.data)).boxed(),
            transforms.map(|(_, message)| Arrival::Transforms(message, false)).boxed(),
            fixed_transforms.map(|(_, message)| Arrival::Transforms(message, true)).boxed(),
            cancel.map(Arrival::Cancel).boxed(),
            replan.map(|request| Arrival::Trigger(Input::Replan, request)).boxed(),
            clear.map(|request| Arrival::Trigger(Input::Clear, request)).boxed(),
            parameter_calls.map(Arrival::Parameters).boxed(),
            life_cycle_calls.map(Arrival::LifeCycle).boxed(),
        ]);
        Ok(Self { arrivals: arrivals.boxed(), emptying, poses, single_poses, joint_states, parameters, life_cycle })
    }
}

/// Everything the node says.
pub(crate) struct Publishers {
    trajectory: Publisher<JointTrajectory>,
    ordered_poses: Publisher<PoseArray>,
    path: Publisher<Path>,
    report: Publisher<r2r::std_msgs::msg::String>,
    /// Of messages that are bytes already: the planner draws them with types of its own.
    markers: PublisherUntyped,
    diagnostics: Publisher<DiagnosticArray>,
}

impl Publishers {
    pub(crate) fn create(node: &mut Node) -> r2r::Result<Self> {
        let latched = || QosProfile::default().reliable().transient_local().keep_last(1);
        Ok(Self {
            trajectory: node.create_publisher("joint_trajectory", QosProfile::default().reliable())?,
            ordered_poses: node.create_publisher("~/ordered_poses", latched())?,
            path: node.create_publisher("~/path", latched())?,
            report: node.create_publisher("~/report", latched())?,
            markers: node.create_publisher_untyped("~/markers", MarkerArray::TYPE, latched())?,
            diagnostics: node.create_publisher("/diagnostics", QosProfile::default().reliable())?,
        })
    }

    /// Publishes a plan or a refusal; what the robot has to do, which `send` sends, when everything that it needs to know is out.
    pub(crate) fn publish(
        &self,
        robot: &planner::manipulator::Robot,
        outcome: &Outcome,
        send: impl FnOnce(&Motion) -> r2r::Result<()>,
    ) -> r2r::Result<()> {
        let mut report = Report::of(&robot.name, &outcome.result, outcome.motion.as_ref());
        report.stamp_ns = Some(outcome.request.stamp_ns);
        self.report.publish(&r2r::std_msgs::msg::String { data: report.to_json() })?;
        let header = header(&robot.base_frame, outcome.request.stamp_ns);
        match &outcome.result {
            Ok(plan) => {
                self.path.publish(&path_message(&plan.path(), header.clone()))?;
                // Equal poses once: whoever follows these must not meet the same waypoint twice. The report has every input index.
                self.ordered_poses.publish(&pose_array(&plan.ordered_poses(&outcome.request), header.clone()))?;
            }
            Err(_) => self.withdraw_poses()?,
        }
        if let Some(motion) = &outcome.motion {
            send(motion)?;
        }
        let Header { stamp, frame_id } = header;
        let stamp = msg::Time { sec: stamp.sec, nanosec: stamp.nanosec };
        self.show(&planner::markers(outcome, &msg::Header { stamp, frame_id }))
    }

    pub(crate) fn publish_trajectory(&self, trajectory: &JointTrajectory) -> r2r::Result<()> {
        self.trajectory.publish(trajectory)
    }

    /// Empties the latched topics, so that latecomers do not take up what no longer holds.
    pub(crate) fn withdraw(&self) -> r2r::Result<()> {
        self.report.publish(&r2r::std_msgs::msg::String { data: "{}".into() })?;
        self.show(&Drawn { poses: &[], ordering: None, curve: &[], refusal: None }.markers(&msg::Header::default()))?;
        self.withdraw_poses()
    }

    pub(crate) fn tell(&self, diagnostics: &DiagnosticArray) -> r2r::Result<()> {
        self.diagnostics.publish(diagnostics)
    }

    fn show(&self, markers: &MarkerArray) -> r2r::Result<()> {
        let bytes = encode(markers).map_err(|_| r2r::Error::RCL_RET_INVALID_ARGUMENT)?;
        self.markers.publish_raw(&bytes)
    }

    fn withdraw_poses(&self) -> r2r::Result<()> {
        self.path.publish(&Path::default())?;
        self.ordered_poses.publish(&PoseArray::default())
    }
}
