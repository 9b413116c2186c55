"""Receives a planned trajectory and what explains it, judges them, and writes them down.

    receive_trajectory.py --limits config/robots/ur5e.yaml --urdf config/robots/ur5e.urdf --out DIR
                          [--bag BAG] [--timeout S]

Prints READY when it listens and MATCHED when a publisher of every topic has been found. Writes
trajectory.json, report.json, ordered_poses.json and check.json. Exit codes: 0 sound, 1 problems (one
sentence each on stderr), 2 bad input, 3 nothing in time, 4 the planner refused.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

import rclpy
from geometry_msgs.msg import PoseArray
from nav_msgs.msg import Path as PosePath
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from leave import leave
from limits import read_limits
from recorded_poses import pose_row, read_pose_array
from trajectory_check import Trajectory, check_ordered_poses, check_trajectory

TOPICS = {
    "/joint_trajectory": JointTrajectory,
    "/reorder/report": String,
    "/reorder/ordered_poses": PoseArray,
    "/reorder/path": PosePath,
}
ONLY_LIVE = {"/joint_trajectory"}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--limits", required=True, help="YAML or JSON: joints by name, with their limits")
    parser.add_argument("--urdf", help="velocity limits that the limits file leaves to it")
    parser.add_argument("--bag", help="the recorded poses, to compare the ordered ones with")
    parser.add_argument("--out", required=True, type=Path)
    parser.add_argument("--timeout", type=float, default=60.0, help="seconds")
    return parser.parse_args()


def main():
    options = arguments()
    try:
        limits = read_limits(options.limits, options.urdf)
        recorded = read_pose_array(options.bag) if options.bag else None
        options.out.mkdir(parents=True, exist_ok=True)
    except Exception as error:  # of three libraries; each says what is wrong with its file
        print(f"The input cannot be read: {str(error).rstrip('.')}.", file=sys.stderr)
        return 2
    got = receive(options.timeout)
    report = json.loads(got["/reorder/report"].data) if "/reorder/report" in got else {}
    if report:
        write(options.out / "report.json", report)
    if report.get("refusal"):
        print(f"Refused: {report['refusal']}", file=sys.stderr)
        return 4
    missing = [topic for topic in TOPICS if topic not in got]
    if missing:
        print(f"Nothing arrived on {', '.join(missing)} within {options.timeout:g} s.", file=sys.stderr)
        return 3
    return judge(got, report, limits, recorded, options.out)


def receive(timeout_s):
    """The first message of each topic, until all are there, a refusal is, or time is up."""
    rclpy.init()
    node = rclpy.create_node("trajectory_receiver")
    got = {}

    def listen(topic, kind):
        live = topic in ONLY_LIVE
        durability = DurabilityPolicy.VOLATILE if live else DurabilityPolicy.TRANSIENT_LOCAL
        qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE, durability=durability)
        return node.create_subscription(kind, topic, lambda message: got.setdefault(topic, message), qos)

    def refused():
        return "/reorder/report" in got and json.loads(got["/reorder/report"].data).get("refusal")

    subscriptions = [listen(topic, kind) for topic, kind in TOPICS.items()]
    print("READY", flush=True)
    matched = False
    deadline = time.monotonic() + timeout_s
    while len(got) < len(subscriptions) and not refused() and time.monotonic() < deadline:
        if not matched and all(node.count_publishers(topic) for topic in TOPICS):
            matched = True
            print("MATCHED", flush=True)
        rclpy.spin_once(node, timeout_sec=min(0.05, max(deadline - time.monotonic(), 0.0)))
    return got


def trajectory_of(message):
    """What a trajectory_msgs/JointTrajectory says, as plain lists."""
    return Trajectory(
        list(message.joint_names),
        [p.time_from_start.sec * 10**9 + p.time_from_start.nanosec for p in message.points],
        [list(p.positions) for p in message.points],
        [list(p.velocities) for p in message.points],
        [list(p.accelerations) for p in message.points],
    )


def judge(got, report, limits, recorded, out):
    message, ordered = got["/joint_trajectory"], got["/reorder/ordered_poses"]
    trajectory = trajectory_of(message)
    rows = [pose_row(pose) for pose in ordered.poses]
    problems, ratios = check_trajectory(trajectory, limits)
    problems += check_ordered_poses(rows, report, recorded and recorded[1])
    problems += check_frames(got, recorded and recorded[0])

    stamp = message.header.stamp
    write(
        out / "trajectory.json",
        {
            "names": trajectory.names,
            "times": [ns / 1e9 for ns in trajectory.times_ns],
            "q": trajectory.positions,
            "v": trajectory.velocities,
            "a": trajectory.accelerations,
            "stamp": {"sec": stamp.sec, "nanosec": stamp.nanosec},
        },
    )
    write(out / "ordered_poses.json", {"frame_id": ordered.header.frame_id, "poses": rows})
    write(out / "check.json", {"ok": not problems, "problems": problems, "max_ratio": ratios})
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


def check_frames(got, recorded_frame):
    """The path and the ordered poses are in one frame (the recorded one), and the path is no coarser."""
    ordered, path = got["/reorder/ordered_poses"], got["/reorder/path"]
    frames = {ordered.header.frame_id, path.header.frame_id, recorded_frame or ordered.header.frame_id}
    if len(frames) != 1 or "" in frames:
        return [f"The poses and the path should be in one frame, not in {sorted(frames)}."]
    if len(path.poses) < len(ordered.poses):
        return [f"The path has {len(path.poses)} poses, fewer than the {len(ordered.poses)} it passes through."]
    return []


def write(file, value):
    """Whole or not at all."""
    scratch = file.with_name(file.name + ".part")
    scratch.write_text(json.dumps(value) + "\n", encoding="utf-8")
    os.replace(scratch, file)


if __name__ == "__main__":
    leave(main())
