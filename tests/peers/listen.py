"""Listens to what the node says, and does nothing with it, until it is killed."""

import rclpy
from nav_msgs.msg import Path
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from check_health import LATCHED


def main():
    rclpy.init()
    node = rclpy.create_node("listener")
    for kind, topic, qos in (
        (JointTrajectory, "/joint_trajectory", 10),
        (Path, "/reorder/path", LATCHED),
        (String, "/reorder/report", LATCHED),
    ):
        node.create_subscription(kind, topic, lambda message: None, qos)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
