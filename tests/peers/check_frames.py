"""Sends poses in the frame of a moving camera, which /tf knows, and expects them where they are in the robot's base frame.

    check_frames.py BAG

Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import json
import sys

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseArray, TransformStamped
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from scipy.spatial.transform import Rotation, Slerp
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from conversation import check, run, wait_until
from leave import leave
from publish_bag import CONFIGURATIONS_RAD, JointStates, pose
from recorded_poses import pose_row, read_pose_array

LATCHED = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# Rotations and translations of the size of 1 are composed a few times in double precision.
ROUNDING = 1e-12


def transform(parent, child, sec, place, rotation):
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, Time(sec=sec)
    t, r = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = map(float, place)
    r.x, r.y, r.z, r.w = map(float, rotation.as_quat())
    return message


def seen_from(rows, place, rotation):
    """Poses as rows, in a frame that stands at `place` and `rotation` in theirs."""
    positions, orientations = np.array(rows)[:, :3], Rotation.from_quat(np.array(rows)[:, 3:])
    inverse = rotation.inv()
    return np.hstack([inverse.apply(positions - place), (inverse * orientations).as_quat()])


def converse(node):
    base, rows = read_pose_array(sys.argv[1])
    reports, ordered = [], []
    node.create_subscription(String, "/reorder/report", lambda m: reports.append(json.loads(m.data)), LATCHED)
    node.create_subscription(PoseArray, "/reorder/ordered_poses", ordered.append, LATCHED)
    tf = node.create_publisher(TFMessage, "/tf", 100)
    tf_static = node.create_publisher(TFMessage, "/tf_static", LATCHED)
    poses = node.create_publisher(PoseArray, "/reorder/poses", 10)
    states = JointStates(node, CONFIGURATIONS_RAD["home"])
    wait_until(
        node,
        lambda: poses.get_subscription_count() and tf.get_subscription_count() and states.settled(),
        "The node's subscriptions",
    )

    def publish(frame, stamp, rows):
        message = PoseArray(poses=[pose(map(float, row)) for row in rows])
        message.header.frame_id, message.header.stamp = frame, stamp
        reports.clear(), ordered.clear()
        poses.publish(message)

    # world → base is fixed; world → camera moves from second 100 to second 101.
    base_at, base_turn = np.array([0.3, -0.2, 0.8]), Rotation.from_euler("z", 40, degrees=True)
    tf_static.publish(TFMessage(transforms=[transform("world", base, 0, base_at, base_turn)]))
    places = np.array([[1.0, 0.5, 1.2], [1.2, 0.1, 1.0]])
    turns = Rotation.from_euler("xyz", [[10, 20, 30], [-40, 35, 60]], degrees=True)

    def camera(second):
        tf.publish(TFMessage(transforms=[transform("world", "camera", 100 + second, places[second], turns[second])]))

    camera(0)
    # A quarter of a second on, which /tf does not know yet: the poses wait for it.
    at, turn = places[0] + 0.25 * (places[1] - places[0]), Slerp([0, 1], turns)([0.25])[0]
    world = np.array(rows)
    world_rows = np.hstack(
        [base_turn.apply(world[:, :3]) + base_at, (base_turn * Rotation.from_quat(world[:, 3:])).as_quat()]
    )
    publish("camera", Time(sec=100, nanosec=250_000_000), seen_from(world_rows, at, turn))
    camera(1)
    wait_until(node, lambda: reports and ordered and ordered[-1].poses, "The answer to poses of a moving camera")
    check("refusal" not in reports[-1], f"Refused: {reports[-1].get('refusal')}")
    check(ordered[-1].header.frame_id == base, f"The ordered poses are in {ordered[-1].header.frame_id}.")
    for place, row in zip(ordered[-1].poses, reports[-1]["order"]):
        there, here = np.array(pose_row(place)), world[row]
        here[3:] *= np.sign(there[3:] @ here[3:])
        check(np.abs(there - here).max() < ROUNDING, f"Pose {row} is off by {np.abs(there - here).max():.1e}.")

    publish("moon", Time(sec=100), rows)
    wait_until(node, lambda: reports, "The answer to poses of the moon")
    said = reports[-1].get("refusal", "")
    check("'moon'" in said and "nothing on /tf connects" in said, f"Instead of a refusal: {said}")
    publish("camera", Time(sec=50), rows)
    wait_until(node, lambda: reports, "The answer to poses of long ago")
    check("50.000 s earlier" in reports[-1].get("refusal", ""), f"Instead of a refusal: {reports[-1]}")
    publish(f"/{base}", Time(sec=100), rows)
    wait_until(node, lambda: reports and ordered and ordered[-1].poses, "The answer to poses in the base frame")


if __name__ == "__main__":
    leave(run(converse, "camera"))
