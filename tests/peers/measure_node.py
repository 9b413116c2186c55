"""Measures how long a trajectory for 200 poses takes, from one Python process through the node and back.

    measure_node.py tests/data/lasa_sine [--rounds N]

Prints one JSON object: the median and the 99th percentile in ms, the node's own median of what planning alone took, and what rclpy
itself takes to turn the two messages into bytes and from them. Exit codes: 0 measured, 1 not, with one sentence on stderr.
"""

import argparse
import json
import random
import time
from pathlib import Path

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseArray
from rclpy.serialization import deserialize_message, serialize_message
from trajectory_msgs.msg import JointTrajectory

from check_health import Health
from conversation import check, run, wait_until
from leave import leave
from publish_bag import CONFIGURATIONS_RAD, JointStates, pose
from recorded_poses import read_pose_array

POSES = 200
# Another request each time, and as hard to plan.
SHIFT_M = 1e-4


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bag")
    parser.add_argument("--rounds", type=int, default=40)
    return parser.parse_args()


def converse(node):
    options = arguments()
    frame_id, rows = read_pose_array(options.bag)
    order = json.loads(Path(f"{options.bag}.truth.json").read_text(encoding="utf-8"))["order"][:POSES]
    random.Random(1).shuffle(order)
    health, trajectories = Health(node), []
    node.create_subscription(JointTrajectory, "/joint_trajectory", trajectories.append, 10)
    publisher = node.create_publisher(PoseArray, "/reorder/poses", 10)
    states = JointStates(node, CONFIGURATIONS_RAD["home"])
    wait_until(
        node,
        lambda: publisher.get_subscription_count() and states.settled() and node.count_publishers("/joint_trajectory"),
        "The node's topics",
    )
    took_s = []
    for round_ in range(options.rounds):
        message = PoseArray(poses=[pose([rows[row][0] + SHIFT_M * round_, *rows[row][1:]]) for row in order])
        message.header.frame_id = frame_id
        trajectories.clear()
        began = time.perf_counter()
        publisher.publish(message)
        wait_until(node, lambda: trajectories, "A trajectory")
        took_s.append(time.perf_counter() - began)
    heard = serialize_message(trajectories[0])
    rclpy_s = median_s(lambda: serialize_message(message)) + median_s(lambda: deserialize_message(heard, JointTrajectory))
    health.status.clear()
    values = health.reach("planning", DiagnosticStatus.OK)
    check(int(values["planned"]) == options.rounds, f"{values['planned']} of {options.rounds} were planned.")
    p50, p99 = (1e3 * float(np.quantile(took_s, part)) for part in (0.5, 0.99))
    planning = 1e3 * float(values["planning_p50_s"])
    print(json.dumps({"p50 ms": p50, "p99 ms": p99, "planning p50 ms": planning, "rclpy p50 ms": 1e3 * rclpy_s}))


def median_s(do, rounds=40):
    took_s = []
    for _ in range(rounds):
        began = time.perf_counter()
        do()
        took_s.append(time.perf_counter() - began)
    return float(np.median(took_s))


if __name__ == "__main__":
    leave(run(converse, "stopwatch"))
