"""Is a controller: takes trajectories as goals of FollowJointTrajectory, and ends them in every way there is.

    check_action.py BAG

The node is started with execution:=action. Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import sys

import rclpy
from control_msgs.action import FollowJointTrajectory
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseArray
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.task import Future
from std_srvs.srv import Trigger

from check_health import Health
from conversation import call, check, run, wait_until
from leave import leave
from publish_bag import CONFIGURATIONS_RAD, UR5E_JOINTS, JointStates, pose
from recorded_poses import read_pose_array

OK, ERROR = DiagnosticStatus.OK, DiagnosticStatus.ERROR


class Controller:
    """Accepts goals while `accepts`; each ends when `released` is given how."""

    def __init__(self, node):
        self.accepts, self.goals, self.released = True, [], Future()
        ActionServer(
            node,
            FollowJointTrajectory,
            "/joint_trajectory_controller/follow_joint_trajectory",
            self.execute,
            goal_callback=lambda goal: GoalResponse.ACCEPT if self.accepts else GoalResponse.REJECT,
            cancel_callback=lambda handle: CancelResponse.ACCEPT,
        )

    async def execute(self, handle):
        self.goals.append(handle)
        feedback = FollowJointTrajectory.Feedback(joint_names=list(handle.request.trajectory.joint_names))
        feedback.error.positions = [0.0, -0.003, 0.001, 0.0, 0.0, 0.0]
        for _ in range(3):
            handle.publish_feedback(feedback)
        way = await self.released
        self.released = Future()
        getattr(handle, way)()
        code = FollowJointTrajectory.Result.PATH_TOLERANCE_VIOLATED if way == "abort" else 0
        return FollowJointTrajectory.Result(error_code=code, error_string="elbow is stuck" if code else "")


def converse(node):
    health = Health(node)
    frame_id, rows = read_pose_array(sys.argv[1])
    poses = node.create_publisher(PoseArray, "/reorder/poses", 10)
    states = JointStates(node, CONFIGURATIONS_RAD["home"])
    wait_until(node, lambda: poses.get_subscription_count() and states.settled(), "The node's subscriptions")

    def publish():
        message = PoseArray(poses=[pose(row) for row in rows])
        message.header.frame_id = frame_id
        poses.publish(message)

    publish()
    health.reach("execution", ERROR, "nobody serves the action")
    controller = Controller(node)

    publish()
    health.reach("execution", OK, "the controller executes")
    trajectory = controller.goals[-1].request.trajectory
    check(list(trajectory.joint_names) == UR5E_JOINTS and len(trajectory.points) > 100, "That is no trajectory.")
    figures = {"feedbacks": "3", "worst_error_rad": "0.003000"}
    wait_until(node, lambda: health.reach("execution", OK) == figures, "The figures of the feedback")
    controller.released.set_result("succeed")
    values = health.reach("execution", OK, "was executed")
    check(values == figures, f"The figures are {values}.")
    check(len(controller.goals) == 1, "The trajectory that found no controller was sent later.")
    answer = call(node, Trigger, "/reorder/cancel", Trigger.Request())
    check(not answer.success and "no trajectory is under way" in answer.message, f"{answer}")

    publish()
    health.reach("execution", OK, "the controller executes")
    answer = call(node, Trigger, "/reorder/cancel", Trigger.Request())
    check(answer.success, f"{answer}")
    wait_until(node, lambda: controller.goals[-1].is_cancel_requested, "The request to cancel")
    controller.released.set_result("canceled")
    health.reach("execution", OK, "was cancelled")

    publish()
    health.reach("execution", OK, "the controller executes")
    controller.released.set_result("abort")
    health.reach("execution", ERROR, "path tolerance violated: elbow is stuck")

    controller.accepts = False
    publish()
    health.reach("execution", ERROR, "rejected")
    check(node.count_publishers("/joint_trajectory") == 1 and len(controller.goals) == 3, "Too many goals came.")


if __name__ == "__main__":
    rclpy.logging.set_logger_level("controller", rclpy.logging.LoggingSeverity.ERROR)
    leave(run(converse, "controller"))
