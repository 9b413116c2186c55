"""Lets a controller die while it executes, and expects the node to notice, and nobody to wait for ever.

    check_dead_controller.py BAG

The node is started with execution:=action. With --die it is the controller that will be killed. Exit codes: 0 all as it should be, 1 not,
with one sentence on stderr.
"""

import subprocess
import sys
import time

import rclpy
from geometry_msgs.msg import PoseArray
from std_srvs.srv import Trigger

from check_action import Controller
from check_health import ERROR, OK, Health
from conversation import call, check, run, wait_until
from leave import leave
from publish_bag import CONFIGURATIONS_RAD, TOPIC, JointStates, pose
from recorded_poses import read_pose_array

# What the node gives a controller to answer in, and some more.
ANSWER_S = 4.0


def converse(node):
    health, states = Health(node), JointStates(node, CONFIGURATIONS_RAD["home"])
    poses = node.create_publisher(PoseArray, TOPIC, 10)
    controller = subprocess.Popen([sys.executable, __file__, "--die"])
    try:
        wait_until(node, lambda: poses.get_subscription_count() and states.settled(), "The node's subscriptions")
        frame_id, rows = read_pose_array(sys.argv[1])
        message = PoseArray(poses=[pose(row) for row in rows])
        message.header.frame_id = frame_id
        action = "/joint_trajectory_controller/follow_joint_trajectory/_action/feedback"
        wait_until(node, lambda: node.count_publishers(action), "The controller")
        poses.publish(message)
        health.reach("execution", OK, "the controller executes")
    finally:
        controller.kill()
        controller.wait()
    asked = time.monotonic()
    answer = call(node, Trigger, "/reorder/cancel", Trigger.Request())
    check(not answer.success and "does not answer" in answer.message, f"{answer}")
    check(time.monotonic() - asked < ANSWER_S, "The answer took too long.")
    health.reach("execution", ERROR, "nobody serves the action")
    answer = call(node, Trigger, "/reorder/cancel", Trigger.Request())
    check(not answer.success and "no trajectory is under way" in answer.message, f"{answer}")


def be_killed():
    rclpy.init()
    node = rclpy.create_node("mortal_controller")
    Controller(node)
    rclpy.spin(node)


if __name__ == "__main__":
    if sys.argv[1] == "--die":
        be_killed()
    else:
        leave(run(converse, "mourner"))
