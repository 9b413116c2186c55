"""Executes what the node plans, asks for other poses on the way, and judges how the robot goes over to them.

    take_over.py FIRST_BAG SECOND_BAG --limits config/robots/ur5e.yaml --urdf config/robots/ur5e.urdf

Publishes on /joint_states at 50 Hz where a controller would have the robot. Prints one JSON line. Exit codes:
0 sound, 1 problems (one sentence each on stderr), 2 bad input, 3 something was not heard in time.
"""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np
import rclpy
from geometry_msgs.msg import PoseArray
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from handover_check import check_handover, state_at
from leave import leave
from limits import read_limits
from publish_bag import CONFIGURATIONS_RAD, JOINT_STATE_PERIOD_S, JOINT_STATES_BEFORE_POSES, TOPIC, UR5E_JOINTS, pose
from receive_trajectory import trajectory_of
from recorded_poses import read_pose_array

# Well under way: by then the approach has its full speed, and much of the motion is left.
UNDER_WAY_NS = 1_000_000_000
POINT_NS = 10_000_000
# Planned several times as fast, so that also on a busy machine a plan is there long before the motion ends.
THINNED = 4


class TooLate(Exception):
    """Says what was waited for in vain."""


class Arm:
    """A robot whose controller executes the newest trajectory by its stamp, without error."""

    def __init__(self, node):
        self.node = node
        self.trajectory = None
        self.start_ns = 0
        self.sent = 0
        self.publisher = node.create_publisher(JointState, "/joint_states", qos_profile_sensor_data)
        node.create_timer(JOINT_STATE_PERIOD_S, self.publish)

    def execute(self, trajectory, start_ns):
        self.trajectory, self.start_ns = trajectory, start_ns

    def elapsed_ns(self):
        return now_ns(self.node) - self.start_ns

    def publish(self):
        if self.publisher.get_subscription_count() == 0:
            return
        names, position = UR5E_JOINTS, np.array(CONFIGURATIONS_RAD["home"])
        velocity = np.zeros(len(names))
        if self.trajectory:
            names = self.trajectory.names
            position, velocity, _ = state_at(self.trajectory, self.elapsed_ns())
        message = JointState(name=names, position=position.tolist(), velocity=velocity.tolist())
        message.header.stamp = self.node.get_clock().now().to_msg()
        self.publisher.publish(message)
        self.sent += 1


class Listener:
    """Every message of a topic, with the time of its arrival."""

    def __init__(self, node, kind, topic, durability):
        self.node, self.heard = node, []
        qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE, durability=durability)
        node.create_subscription(kind, topic, lambda message: self.heard.append((message, now_ns(node))), qos)


def now_ns(node):
    return node.get_clock().now().nanoseconds


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bags", nargs=2)
    parser.add_argument("--limits", required=True)
    parser.add_argument("--urdf", required=True)
    parser.add_argument("--timeout", type=float, default=60.0, help="seconds")
    options = parser.parse_args()
    try:
        limits = read_limits(options.limits, options.urdf)
        recorded = [thinned(bag) for bag in options.bags]
    except Exception as error:  # of three libraries; each says what is wrong with its file
        print(f"The input cannot be read: {str(error).rstrip('.')}.", file=sys.stderr)
        return 2
    rclpy.init()
    try:
        problems = Encounter(options.timeout).run(recorded, limits)
    except TooLate as what:
        print(f"In {options.timeout:g} s there was no {what}.", file=sys.stderr)
        return 3
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


def thinned(bag):
    """Frame and poses, of which every so many along the curve stay, in the order of the bag."""
    frame_id, rows = read_pose_array(bag)
    order = json.loads(Path(f"{bag}.truth.json").read_text(encoding="utf-8"))["order"]
    return frame_id, [rows[row] for row in sorted(order[::THINNED])]


class Encounter:
    def __init__(self, timeout_s):
        self.node = rclpy.create_node("executing_robot")
        self.deadline = time.monotonic() + timeout_s
        self.arm = Arm(self.node)
        self.poses = self.node.create_publisher(
            PoseArray, TOPIC, QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
        )
        self.trajectories = Listener(self.node, JointTrajectory, "/joint_trajectory", DurabilityPolicy.VOLATILE)
        self.reports = Listener(self.node, String, "/reorder/report", DurabilityPolicy.TRANSIENT_LOCAL)

    def wait_for(self, what, condition):
        while not condition():
            if time.monotonic() > self.deadline:
                raise TooLate(what)
            rclpy.spin_once(self.node, timeout_sec=JOINT_STATE_PERIOD_S)

    def run(self, recorded, limits):
        self.wait_for("node", lambda: self.poses.get_subscription_count())
        self.wait_for("listener to joint states", lambda: self.arm.sent >= JOINT_STATES_BEFORE_POSES)
        self.wait_for("publisher of trajectories", lambda: self.node.count_publishers("/joint_trajectory"))
        starts, trajectories, problems = [], [], []
        for frame_id, rows in recorded:
            if trajectories:
                self.wait_for("motion", lambda: self.arm.elapsed_ns() > UNDER_WAY_NS)
            asked_ns = self.ask(frame_id, rows)
            k = len(trajectories)
            self.wait_for(f"report {k}", lambda: len(self.reports.heard) > k)
            report = json.loads(self.reports.heard[k][0].data)
            if "refusal" in report:
                return [f"Pose set {k} was refused: {report['refusal']}"]
            self.wait_for(f"trajectory {k}", lambda: len(self.trajectories.heard) > k)
            message, heard_ns = self.trajectories.heard[k]
            trajectories.append(trajectory_of(message))
            starts.append(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec)
            # It begins when it is published, or at the last point before of what is running.
            if not asked_ns - POINT_NS <= starts[k] <= heard_ns:
                problems.append(f"Trajectory {k} starts {(starts[k] - asked_ns) / 1e9} s after it was asked for.")
            self.arm.execute(trajectories[k], starts[k])
        plan = report["plan"]
        offset_ns = starts[1] - starts[0]
        problems += check_report(plan, trajectories[-1])
        problems += check_handover(*trajectories, offset_ns, plan["takes_over_s"], limits)
        line = {"offset_s": offset_ns / 1e9, "takes_over_s": plan["takes_over_s"], "durations_s": []}
        line["durations_s"] = [trajectory.times_ns[-1] / 1e9 for trajectory in trajectories]
        print(json.dumps(line), flush=True)
        return problems

    def ask(self, frame_id, rows):
        message = PoseArray(poses=[pose(row) for row in rows])
        message.header.frame_id = frame_id
        message.header.stamp = self.node.get_clock().now().to_msg()
        self.poses.publish(message)
        return now_ns(self.node)


def check_report(plan, trajectory):
    """Times in the report are times of the trajectory that came with it."""
    end_s = trajectory.times_ns[-1] / 1e9
    problems = []
    if abs(plan["duration_s"] - end_s) > 1e-9 or plan["points"] != len(trajectory.times_ns):
        said = f"{plan['points']} points in {plan['duration_s']} s"
        problems.append(f"The report is of {said}, not of what was published.")
    first_s, last_s = min(plan["pose_times_s"]), max(plan["pose_times_s"])
    if not plan["takes_over_s"] + plan["approach_s"] <= first_s + 1e-9 <= last_s <= end_s + 1e-9:
        problems.append(f"Poses are said to be passed from {first_s} s to {last_s} s, of {end_s} s.")
    return problems


if __name__ == "__main__":
    leave(main())
