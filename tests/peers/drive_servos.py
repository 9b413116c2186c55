"""Drives the emulated arm of servos as a controller's client would, and expects of it what a real one does.

    drive_servos.py

Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import numpy as np
from action_msgs.msg import GoalStatus
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionClient
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import Trigger

from conversation import check, run, wait_until
from goals import goals_of
from drive_arm import LATCHED, move
from leave import leave

# A joint rests within two pulses of 0.0015 rad, and follows within what friction and a step of 5 ms leave.
THERE_RAD = 0.004
FOLLOWS_RAD = 0.04


def converse(node):
    states, descriptions = [], []
    node.create_subscription(JointState, "/joint_states", states.append, QoSProfile(depth=1000))
    node.create_subscription(String, "/robot_description", descriptions.append, LATCHED)
    client = ActionClient(node, FollowJointTrajectory, "/joint_trajectory_controller/follow_joint_trajectory")
    recover = node.create_client(Trigger, "/dynamixel_arm/recover")
    wait_until(
        node,
        lambda: states and descriptions and client.server_is_ready() and recover.service_is_ready(),
        "The arm's topics",
    )
    names = list(states[-1].name)
    check(len(names) == 6 and "vx300s" in descriptions[0].data, f"It is no ViperX: {names}.")

    def here():
        return np.array(states[-1].position)

    def rest():
        states.clear()
        wait_until(
            node, lambda: len(states) > 100 and np.ptp([s.position for s in states[-100:]], axis=0).max() < 0.002, "Rest"
        )
        return here()

    send, result = goals_of(node, client)

    # A goal is executed, with feedback, and the joints are where it says.
    home = rest()
    handle, feedback = send(move(names[::-1], home[::-1], 0.3, 2.0))
    check(handle.accepted, "A good goal is rejected.")
    ended = result(handle)
    check(ended.status == GoalStatus.STATUS_SUCCEEDED, f"It ended as {ended}.")
    check(len(feedback) >= 3 and feedback[0].joint_names == names[::-1], "There was hardly any feedback.")
    check(max(np.abs(message.error.positions).max() for message in feedback) < FOLLOWS_RAD, "It does not follow.")
    there = rest()
    check(np.abs(there - home - 0.3).max() < THERE_RAD, f"It went from {home} to {there}.")

    # Cancelled, it stops on the way.
    handle, feedback = send(move(names, there, -0.6, 4.0))
    check(handle.accepted, "A goal from where it rests is rejected.")
    wait_until(node, lambda: feedback and feedback[-1].desired.positions[0] < there[0] - 0.1, "Motion")
    handle.cancel_goal_async()
    check(result(handle).status == GoalStatus.STATUS_CANCELED, "It was not cancelled.")
    short = rest()
    check(np.all(short < there - 0.01) and np.all(short > there - 0.55), f"It stopped at {short}.")

    # What would begin with a jump, or is too fast, is rejected.
    handle, _ = send(move(names, short + 0.2, 0.1, 1.0))
    check(not handle.accepted, "A jump is accepted.")
    handle, _ = send(move(names, short, 0.3, 0.2))
    check(not handle.accepted, "A trajectory of 2.8 rad/s is accepted.")

    asked = recover.call_async(Trigger.Request())
    wait_until(node, asked.done, "The answer to ~/recover")
    check(asked.result().success, f"It cannot recover from nothing: {asked.result().message}")


if __name__ == "__main__":
    leave(run(converse, "driver"))
