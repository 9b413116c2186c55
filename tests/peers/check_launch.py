"""Sees a motion through a pipeline that somebody else started: poses go in, and the arm arrives.

    check_launch.py [BAG]

Without a bag somebody else has the poses, too. Exit codes: 0 the arm arrived, 1 not, with one sentence on stderr.
"""

import sys

from geometry_msgs.msg import PoseArray
from sensor_msgs.msg import JointState

from check_health import OK, Health
from conversation import run, wait_until
from leave import leave
from publish_bag import TOPIC, pose
from recorded_poses import read_pose_array


def converse(node):
    health, states = Health(node), []
    node.create_subscription(JointState, "/joint_states", states.append, 100)
    poses = node.create_publisher(PoseArray, TOPIC, 10)
    wait_until(node, lambda: poses.get_subscription_count() and states, "The node and the arm")
    if len(sys.argv) > 1:
        health.reach("joint states", OK)
        frame_id, rows = read_pose_array(sys.argv[1])
        message = PoseArray(poses=[pose(row) for row in rows])
        message.header.frame_id = frame_id
        poses.publish(message)
    wait_until(node, lambda: max(map(abs, states[-1].velocity)) > 0.1, "Motion")
    health.reach("execution", OK, "was executed")
    states.clear()
    wait_until(node, lambda: states and max(map(abs, states[-1].velocity)) < 1e-3, "Rest")


if __name__ == "__main__":
    leave(run(converse, "onlooker"))
