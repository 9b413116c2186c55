"""Sends the node a million poses at once, and expects one clear sentence while everything else goes on.

    check_million.py BAG PID

PID is the node's. Prints one JSON object: how long the answer took in s, the longest time between two reports of health in s, memory at its
peak and afterwards in MiB. Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray

from check_health import Health
from conversation import check, run, wait_until
from drive_arm import seconds
from leave import leave
from load_node import resident_mib
from publish_bag import CONFIGURATIONS_RAD, JointStates, pose
from recorded_poses import read_pose_array
from sender import Sender

POSES = 1_000_000


def converse(node):
    frame_id, rows = read_pose_array(sys.argv[1])
    pid = int(sys.argv[2])
    health, states, told_s = Health(node), JointStates(node, CONFIGURATIONS_RAD["home"]), []
    node.create_subscription(DiagnosticArray, "/diagnostics", lambda m: told_s.append(seconds(m.header.stamp)), 10)
    sender = Sender(node, frame_id, rows, 1.0)
    wait_until(node, lambda: sender.publisher.get_subscription_count() and states.settled() and told_s, "The node")

    def answer(array):
        began = time.monotonic()
        sender.arrays = [array]
        sender.answered_s.clear()
        sender.send()
        wait_until(node, lambda: sender.answered_s, f"An answer to {len(array)} poses")
        return sender.refusals.get(next(iter(sender.answered_s)), ""), time.monotonic() - began

    # The same objects again and again: what is sent is as large.
    given = [pose(row) for row in rows]
    said, took_s = answer((given * (POSES // len(given) + 1))[:POSES])
    check("1000000 poses are more than the 10000" in said, f"Instead of a refusal: {said}")
    said, _ = answer(given)
    check(not said, f"The next good message was refused: {said}")
    told = len(told_s)
    wait_until(node, lambda: len(told_s) > told, "Health")
    # So many bytes a message, in a few copies of it.
    peak_mib = float(next(s for s in Path(f"/proc/{pid}/status").read_text().splitlines() if "VmHWM" in s).split()[1]) / 1024
    figures = {"answer_s": took_s, "longest_silence_s": float(np.diff(told_s).max()), "peak_mib": peak_mib}
    print(json.dumps({**figures, "memory_mib": resident_mib(pid)}), flush=True)
    check(figures["longest_silence_s"] < 2.5, "Health was not told of meanwhile.")
    check(peak_mib < 500, "Too much memory was needed.")
    check("reorder: planning" in health.status, "Nothing was said of planning.")


if __name__ == "__main__":
    leave(run(converse, "flood"))
