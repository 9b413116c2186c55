"""Watches how the node says that it is well, and what it shows, while good and bad things are sent to it.

    check_health.py BAG URDF

Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import sys
from pathlib import Path

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Pose, PoseArray
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

from conversation import check, run, wait_until
from leave import leave
from publish_bag import CONFIGURATIONS_RAD, JointStates, pose
from recorded_poses import read_pose_array

OK, WARN, ERROR, STALE = (getattr(DiagnosticStatus, level) for level in ("OK", "WARN", "ERROR", "STALE"))
LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Health:
    """The latest status of everything that the node reports."""

    def __init__(self, node):
        self.node, self.status = node, {}
        node.create_subscription(DiagnosticArray, "/diagnostics", self.heard, 10)

    def heard(self, message):
        self.status |= {status.name: status for status in message.status}

    def reach(self, what, level, words=""):
        def reached():
            status = self.status.get(f"reorder: {what}")
            return status and status.level == level and words in status.message

        wait_until(self.node, reached, f"{what} at level {level} with {words!r}")
        return {entry.key: entry.value for entry in self.status[f"reorder: {what}"].values}


def converse(node):
    health = Health(node)
    logs, shown = [], []
    node.create_subscription(Log, "/rosout", logs.append, 100)
    node.create_subscription(MarkerArray, "/reorder/markers", shown.append, LATCHED)
    descriptions = node.create_publisher(String, "/robot_description", LATCHED)
    poses = node.create_publisher(PoseArray, "/reorder/poses", 10)
    wait_until(
        node,
        lambda: poses.get_subscription_count() and descriptions.get_subscription_count(),
        "The node's subscriptions",
    )
    health.reach("planning", OK, "no poses")
    health.reach("joint states", STALE, "no joint state")
    health.reach("robot", OK, "ur5e")

    # A description that is none leaves the node with the robot it has; a good one is taken up.
    descriptions.publish(String(data="<robot name='none'><link name='base_link'/></robot>"))
    health.reach("robot", ERROR, "robot_description is ignored")
    wait_until(node, lambda: any(log.name == "reorder" and log.level >= 40 for log in logs), "A word on /rosout")
    urdf = Path(sys.argv[2]).read_text(encoding="utf-8")
    descriptions.publish(String(data=urdf.replace('<robot name="ur5e"', '<robot name="ur5e_of_cell_7"')))
    check(health.reach("robot", OK, "ur5e_of_cell_7")["joints"] == "6", "It has six joints.")

    states = JointStates(node, CONFIGURATIONS_RAD["home"])
    health.reach("joint states", OK)

    frame_id, rows = read_pose_array(sys.argv[1])
    message = PoseArray(poses=[pose(row) for row in rows])
    message.header.frame_id = frame_id
    poses.publish(message)
    values = health.reach("planning", OK, f"{len(rows)} poses")
    check(values["planned"] == "1" and float(values["latency_last_s"]) > 0.0, f"The figures are {values}.")
    wait_until(node, lambda: shown, "Markers")
    markers = {}
    for marker in shown[-1].markers:
        markers.setdefault(marker.ns, []).append(marker)
    check(shown[-1].markers[0].action == Marker.DELETEALL, "Old markers stay.")
    check(len(markers["poses"][0].points) == len(rows), "Not every pose is shown.")
    order = markers["order"][0]
    colors = {(color.r, color.g, color.b) for color in order.colors}
    check(len(order.points) == len(colors) == len(rows), "The order has not a colour of its own at every pose.")
    check(len(markers["spline"][0].points) > 3 * len(rows), "The spline is not finer than the poses.")
    check(order.header.frame_id == frame_id and "doubts" not in markers, "A clear order shows doubts.")

    # A cross: whatever order it is given, something speaks against it.
    shown.clear()
    cross = [(0.01 * (k - 5), 0.0) for k in range(11)] + [(0.0, 0.01 * (k - 5)) for k in range(11) if k != 5]
    message.poses = [Pose(position=message.poses[0].position, orientation=message.poses[0].orientation) for _ in cross]
    for place, (dx, dz) in zip(message.poses, cross):
        centre = pose(rows[0]).position
        place.position = type(centre)(x=centre.x + dx, y=centre.y, z=centre.z + dz)
    poses.publish(message)
    health.reach("planning", WARN, "the last poses were refused")
    wait_until(node, lambda: shown, "Markers of doubts")
    doubts = [marker for marker in shown[-1].markers if marker.ns == "doubts"]
    check(doubts and doubts[0].color.r == 1.0 and doubts[0].color.g < 0.2, "The doubts are not red.")
    check(all(marker.text for marker in doubts[1:]) and len(doubts) > 1, "A doubt has no reason.")
    check(states.sent > 0, "No joint states went out.")


if __name__ == "__main__":
    leave(run(converse, "watcher"))
