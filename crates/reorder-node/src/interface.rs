//! Topics and services of the node.

use planner::{Motion, Outcome, Report};
use r2r::geometry_msgs::msg::PoseArray;
use r2r::nav_msgs::msg::Path;
use r2r::sensor_msgs::msg::JointState;
use r2r::std_srvs::srv::Trigger;
use r2r::trajectory_msgs::msg::JointTrajectory;
use r2r::{Node, Publisher, QosProfile, ServiceRequest};

use futures::stream::{Stream, StreamExt};
use planner::Input;

use crate::message::{header, joint_state_input, path_message, pose_array, poses_input, trajectory_message};

/// What arrives at the node.
pub(crate) enum Arrival {
    Message(Input),
    Service(Input, ServiceRequest<Trigger::Service>),
}

/// Subscribes to everything and merges it into one stream.
pub(crate) fn arrivals(node: &mut Node) -> r2r::Result<impl Stream<Item = Arrival> + Unpin + Send + use<>> {
    let reliable = || QosProfile::default().reliable().keep_last(10);
    let poses = node.subscribe::<PoseArray>("~/poses", reliable())?.map(|m| Arrival::Message(poses_input(m)));
    let joint_states = node
        .subscribe::<JointState>("joint_states", QosProfile::sensor_data())?
        .map(|m| Arrival::Message(joint_state_input(m)));
    let mut trigger = |name: &str| node.create_service::<Trigger::Service>(name, QosProfile::services_default());
    let replan = trigger("~/replan")?.map(|request| Arrival::Service(Input::Replan, request));
    let clear = trigger("~/clear")?.map(|request| Arrival::Service(Input::Clear, request));
    Ok(futures::stream::select_all([poses.boxed(), joint_states.boxed(), replan.boxed(), clear.boxed()]))
}

/// Everything the node says.
pub(crate) struct Publishers {
    trajectory: Publisher<JointTrajectory>,
    ordered_poses: Publisher<PoseArray>,
    path: Publisher<Path>,
    report: Publisher<r2r::std_msgs::msg::String>,
}

impl Publishers {
    pub(crate) fn create(node: &mut Node) -> r2r::Result<Self> {
        let latched = || QosProfile::default().reliable().transient_local().keep_last(1);
        Ok(Self {
            trajectory: node.create_publisher("joint_trajectory", QosProfile::default().reliable())?,
            ordered_poses: node.create_publisher("~/ordered_poses", latched())?,
            path: node.create_publisher("~/path", latched())?,
            report: node.create_publisher("~/report", latched())?,
        })
    }

    /// Publishes a plan or a refusal; what the robot has to do last, when everything that explains it is out.
    pub(crate) fn publish(
        &self,
        robot: &planner::manipulator::Robot,
        outcome: &Outcome,
        stamp_ns: impl FnOnce(&Motion) -> i64,
    ) -> r2r::Result<()> {
        let report = Report::of(&robot.name, &outcome.result, outcome.motion.as_ref());
        self.report.publish(&r2r::std_msgs::msg::String { data: report.to_json() })?;
        match &outcome.result {
            Ok(plan) => {
                let header = header(&robot.base_frame, outcome.request.stamp_ns);
                self.path.publish(&path_message(&plan.path(), header.clone()))?;
                // Equal poses once: whoever follows these must not meet the same waypoint twice. The report has every input index.
                self.ordered_poses.publish(&pose_array(&plan.ordered_poses(&outcome.request), header))?;
            }
            Err(_) => self.withdraw_poses()?,
        }
        let Some(motion) = &outcome.motion else { return Ok(()) };
        self.trajectory.publish(&trajectory_message(&motion.trajectory, &robot.base_frame, stamp_ns(motion)))
    }

    /// Empties the latched topics, so that latecomers do not take up what no longer holds.
    pub(crate) fn withdraw(&self) -> r2r::Result<()> {
        self.report.publish(&r2r::std_msgs::msg::String { data: "{}".into() })?;
        self.withdraw_poses()
    }

    fn withdraw_poses(&self) -> r2r::Result<()> {
        self.path.publish(&Path::default())?;
        self.ordered_poses.publish(&PoseArray::default())
    }
}
