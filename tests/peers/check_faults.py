"""Sends the node what it cannot use, one thing after the other, and expects a word on each, and an answer to the next good message.

    check_faults.py BAG

Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import json
import math
import sys

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseArray, TransformStamped
from rcl_interfaces.msg import Log, Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from check_health import ERROR, LATCHED, Health
from conversation import call, check, run, wait_until
from leave import leave
from publish_bag import CONFIGURATIONS_RAD, UR5E_JOINTS, JointStates, pose
from recorded_poses import read_pose_array


def converse(node):
    health = Health(node)
    frame_id, rows = read_pose_array(sys.argv[1])
    reports, logs = [], []
    node.create_subscription(String, "/reorder/report", lambda m: reports.append(json.loads(m.data)), LATCHED)
    node.create_subscription(Log, "/rosout", logs.append, 1000)
    poses = node.create_publisher(PoseArray, "/reorder/poses", 10)
    joints = node.create_publisher(JointState, "/joint_states", 10)
    tf = node.create_publisher(TFMessage, "/tf", 10)
    descriptions = node.create_publisher(String, "/robot_description", LATCHED)
    states = JointStates(node, CONFIGURATIONS_RAD["home"])
    wait_until(
        node,
        lambda: states.settled() and all(sender.get_subscription_count() for sender in (poses, tf, descriptions)),
        "The node's subscriptions",
    )

    def ask(given, frame=frame_id, stamp=None):
        message = PoseArray(poses=[pose(row) for row in given])
        message.header.frame_id, message.header.stamp = frame, stamp or Time()
        reports.clear()
        poses.publish(message)
        wait_until(node, lambda: reports, f"An answer to {len(given)} poses in {frame}")
        return reports[-1].get("refusal", "")

    def good(stamp=None):
        said = ask(rows, stamp=stamp)
        check(not said and reports[-1]["n"] == len(rows), f"A good message is refused: {said}")

    def changed(row, place, x):
        return [*rows[:row], [*rows[row][:place], x, *rows[row][place + 1 :]], *rows[row + 1 :]]

    for given, words in (
        (changed(3, 0, math.nan), "pose 3:"),
        (changed(7, 2, math.inf), "pose 7:"),
        (changed(5, 4, math.nan), "pose 5:"),
        ([[*row[:3], 0.0, 0.0, 0.0, 0.0] for row in rows], "pose 0: the quaternion is zero"),
        ([[*row[:6], 2.0] for row in rows], "pose 0:"),
        ([], "0 points"),
        (rows[:1], "1 point"),
        ([rows[0]] * 50, "all 50 points are equal"),
        ([[1e300, *row[1:]] for row in rows], ""),
        ([[x + 50.0, y, z, *q] for x, y, z, *q in rows], ""),
        (rows * 40, "max_poses"),
    ):
        said = ask(given)
        check(said and words in said, f"Instead of a refusal with {words!r}: {said or reports[-1]}")
        health.reach("planning", DiagnosticStatus.WARN, said[:60])
        wait_until(node, lambda: any(said in log.msg and log.level >= 30 for log in logs), "A word on /rosout")
        good()
    said = ask(rows, frame="nowhere")
    check("'nowhere'" in said and "is not known" in said, f"Instead of a refusal: {said}")

    # Messages of others that make no sense are said and change nothing.
    for message in (
        JointState(name=UR5E_JOINTS, position=[0.0] * 5),
        JointState(name=UR5E_JOINTS, position=[math.nan] * 6),
        JointState(name=[], position=[1.0]),
    ):
        logs.clear()
        joints.publish(message)
        wait_until(node, lambda: any("a joint state is ignored" in log.msg for log in logs), "A word on a joint state")
    logs.clear()
    tf.publish(TFMessage(transforms=[TransformStamped(child_frame_id="camera")] * 2))
    tf.publish(TFMessage(transforms=[bad_transform()]))
    wait_until(node, lambda: any("transforms are ignored" in log.msg for log in logs), "A word on a transform")

    logs.clear()
    descriptions.publish(String(data="no robot"))
    health.reach("robot", ERROR, "robot_description is ignored")
    wait_until(node, lambda: any("robot_description" in log.msg and log.level >= 40 for log in logs), "A word on it")
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="many")
    request = SetParameters.Request(parameters=[Parameter(name="max_poses", value=value)])
    answer = call(node, SetParameters, "/reorder/set_parameters", request).results[0]
    check(not answer.successful and "must be a whole number" in answer.reason, f"{answer}")
    good()

    # Stamps far in the past and the future are passed through: in the base frame nothing depends on them.
    for stamp in (Time(sec=-5), Time(sec=1), Time(sec=2**31 - 1, nanosec=999_999_999)):
        good(stamp)
        check(reports[-1]["stamp_ns"] == stamp.sec * 10**9 + stamp.nanosec, "The report answers something else.")


def bad_transform():
    message = TransformStamped(child_frame_id="camera")
    message.transform.rotation.w = math.nan
    return message


if __name__ == "__main__":
    leave(run(converse, "troublemaker"))
