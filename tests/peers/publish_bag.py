"""Publishes the PoseArray of a bag once, when somebody listens, and leaves when it has been answered.

    publish_bag.py tests/data/lasa_sine [--joint-state home | --positions Q1 ... Q6 | --await-robot] [--subscribers N] [--before-viperx]

With a joint state, sensor_msgs/JointState goes out at 50 Hz on /joint_states, from before the poses
until a report answers them, as a robot's driver would. With --await-robot the poses wait until the node
has heard of a robot. The recordings were drawn before a UR5e; --before-viperx moves them to where a ViperX reaches them. Prints one JSON line. Exit codes: 0 answered,
2 bad input, 3 nobody listened, acknowledged or answered in time.
"""

import argparse
import json
import math
import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from leave import leave
from recorded_poses import read_pose_array

TOPIC = "/reorder/poses"
# The middle of the board in the recordings, and where it stands before the ViperX, which is smaller.
BOARD_M = (-0.10, 0.55, 0.42)
VIPERX_FRAME = "vx300s/base_link"
BOARD_BEFORE_VIPERX_M = (0.33, 0.0, 0.20)
JOINT_STATE_PERIOD_S = 0.02
# Best effort: one of them may be lost, not all of them.
JOINT_STATES_BEFORE_POSES = 5

# The robot's own order, base to tool; the messages name them alphabetically, as the UR driver does.
UR5E_JOINTS = [
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
]
CONFIGURATIONS_RAD = {"home": [-1.5708, -1.5708, 1.5708, -1.5708, -1.5708, 0.0]}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bag")
    parser.add_argument("--subscribers", type=int, default=1, help="listeners to the poses to wait for")
    parser.add_argument("--timeout", type=float, default=30.0, help="seconds")
    parser.add_argument("--before-viperx", action="store_true", help="in vx300s/base_link, on a board that a ViperX reaches")
    state = parser.add_mutually_exclusive_group()
    state.add_argument("--joint-state", choices=CONFIGURATIONS_RAD)
    state.add_argument("--positions", type=float, nargs=6, metavar="RAD", help="base to tool")
    state.add_argument("--await-robot", action="store_true")
    return parser.parse_args()


def main():
    options = arguments()
    try:
        frame_id, rows = read_pose_array(options.bag)
    except Exception as error:  # rosbags raises many kinds; each says what is wrong with the bag
        print(f"{options.bag} cannot be read: {str(error).rstrip('.')}.", file=sys.stderr)
        return 2
    if options.before_viperx:
        frame_id, rows = VIPERX_FRAME, [before_viperx(row) for row in rows]
    positions = options.positions or CONFIGURATIONS_RAD.get(options.joint_state)
    rclpy.init()
    return publish(rclpy.create_node("bag_publisher"), options, frame_id, rows, positions)


def publish(node, options, frame_id, rows, positions):
    deadline = time.monotonic() + options.timeout
    poses = node.create_publisher(PoseArray, TOPIC, QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE))
    states = JointStates(node, positions) if positions else None
    answers, robots = [], []
    latched = QoSProfile(
        depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
    )
    node.create_subscription(String, "/reorder/report", answers.append, latched)

    if options.await_robot:
        node.create_subscription(DiagnosticArray, "/diagnostics", lambda message: robots.extend(heard(message)), 10)

    def everybody():
        robot = states.settled() if states else robots if options.await_robot else True
        return robot and poses.get_subscription_count() >= options.subscribers

    while not everybody():
        left = deadline - time.monotonic()
        if left <= 0:
            found = poses.get_subscription_count()
            print(
                f"{TOPIC} has {found} of {options.subscribers} subscribers"
                + (f", /joint_states {states.listeners()}" if states else "")
                + (", and the node has heard of no robot" if options.await_robot and not robots else "")
                + f" after {options.timeout:g} s.",
                file=sys.stderr,
            )
            return 3
        # The graph has no wait of its own here; 20 ms is the joint states' period anyway.
        rclpy.spin_once(node, timeout_sec=min(left, JOINT_STATE_PERIOD_S))

    message = PoseArray(poses=[pose(row) for row in rows])
    message.header.frame_id = frame_id
    message.header.stamp = node.get_clock().now().to_msg()
    listeners = poses.get_subscription_count()
    poses.publish(message)
    answers.clear()
    acknowledged = False
    while not (acknowledged and answers):
        if time.monotonic() > deadline:
            what = "answered" if acknowledged else "acknowledged"
            print(f"{TOPIC} was not {what} within {options.timeout:g} s.", file=sys.stderr)
            return 3
        acknowledged = acknowledged or poses.wait_for_all_acked(Duration(seconds=0))
        rclpy.spin_once(node, timeout_sec=JOINT_STATE_PERIOD_S)
    sent = states.sent if states else 0
    line = {"topic": TOPIC, "bag": options.bag, "frame_id": frame_id, "n_poses": len(rows)}
    print(json.dumps({**line, "subscribers": listeners, "joint_states": sent}), flush=True)
    return 0


def heard(diagnostics):
    """The states of health that say that joint states arrive at the node."""
    return [s for s in diagnostics.status if s.name.endswith("reorder: joint states") and s.level == DiagnosticStatus.OK]


class JointStates:
    """Publishes one configuration at 50 Hz and counts what somebody could hear."""

    def __init__(self, node, positions):
        self.node = node
        self.publisher = node.create_publisher(JointState, "/joint_states", qos_profile_sensor_data)
        names_and_positions = sorted(zip(UR5E_JOINTS, positions))
        self.names = [name for name, _ in names_and_positions]
        self.positions = [position for _, position in names_and_positions]
        self.sent = 0
        node.create_timer(JOINT_STATE_PERIOD_S, self.publish)

    def publish(self):
        if self.listeners() == 0:
            return
        message = JointState(name=self.names, position=self.positions, velocity=[0.0] * len(self.names))
        message.header.stamp = self.node.get_clock().now().to_msg()
        self.publisher.publish(message)
        self.sent += 1

    def listeners(self):
        return self.publisher.get_subscription_count()

    def settled(self):
        return self.sent >= JOINT_STATES_BEFORE_POSES


def before_viperx(row):
    """The board turned by a quarter from the UR5e's side to the ViperX's front, and the pen from the z axis of the one tool to the x
    axis of the other, as dynamixel-hil draws."""
    x, y, z = (p - middle for p, middle in zip(row[:3], BOARD_M))
    place = [p + middle for p, middle in zip((y, -x, z), BOARD_BEFORE_VIPERX_M)]
    half = math.sqrt(0.5)
    quarter = (0.0, 0.0, -half, half)
    # Columns: the ViperX tool's x (out of the gripper), y and z in the UR5e's, (0, 0, 1), (-1, 0, 0) and (0, -1, 0).
    tool = (0.5, -0.5, 0.5, 0.5)
    return (*place, *product(product(quarter, row[3:]), tool))


def product(a, b):
    """Of quaternions x, y, z, w."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def pose(row):
    x, y, z, qx, qy, qz, qw = row
    return Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))


if __name__ == "__main__":
    leave(main())
