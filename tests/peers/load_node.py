"""Publishes 200 poses again and again, while others subscribe and leave, and accounts for every answer.

    load_node.py BAG --pid PID --seconds S [--warm-up S] [--rate HZ]

PID is the node's. Prints one JSON object: what was sent and what became of it, latencies in ms in the first and the last third, memory in
MiB. Exit codes: 0 everything adds up, 1 not, with one sentence on stderr.
"""

import argparse
import json
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from nav_msgs.msg import Path as PosePath
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import MarkerArray

from check_health import LATCHED, Health
from conversation import check, run, wait_until
from leave import leave
from publish_bag import CONFIGURATIONS_RAD, JointStates
from recorded_poses import read_pose_array
from sender import Sender, fates

POSES = 200
# A subscription of this process lives so long, and another process so long before it is killed.
SUBSCRIPTION_S, SUBSCRIBER_S = 2.0, 10.0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bag")
    parser.add_argument("--pid", type=int, required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--warm-up", type=float, default=5.0)
    parser.add_argument("--rate", type=float, default=10.0)
    return parser.parse_args()


class Visitors:
    """Subscriptions that come and go, some in good order, some because their process is killed."""

    def __init__(self, node):
        self.node, self.subscriptions, self.process, self.came, self.heard = node, [], None, 0, 0
        self.turn()
        self.replace()
        node.create_timer(SUBSCRIPTION_S, self.turn)
        node.create_timer(SUBSCRIBER_S, self.replace)

    def turn(self):
        if self.subscriptions:
            while self.subscriptions:
                self.node.destroy_subscription(self.subscriptions.pop())
            return
        self.came += 1
        for kind, topic, qos in (
            (JointTrajectory, "/joint_trajectory", 10),
            (PosePath, "/reorder/path", LATCHED),
            (MarkerArray, "/reorder/markers", LATCHED),
        ):
            self.subscriptions.append(self.node.create_subscription(kind, topic, self.listen, qos))

    def listen(self, _):
        self.heard += 1

    def replace(self):
        self.leave()
        self.came += 1
        self.process = subprocess.Popen([sys.executable, Path(__file__).with_name("listen.py")])

    def leave(self):
        if self.process:
            self.process.send_signal(signal.SIGKILL)
            self.process.wait()


def resident_mib(pid):
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * 4096 / 2**20


def converse(node):
    options = arguments()
    frame_id, rows = read_pose_array(options.bag)
    order = json.loads(Path(f"{options.bag}.truth.json").read_text(encoding="utf-8"))["order"][:POSES]
    random.Random(1).shuffle(order)
    health, states = Health(node), JointStates(node, CONFIGURATIONS_RAD["home"])
    sender = Sender(node, frame_id, [rows[row] for row in order], options.rate)
    wait_until(node, lambda: sender.publisher.get_subscription_count() and states.settled(), "The node's subscriptions")
    visitors = Visitors(node)

    def load(seconds):
        began = time.monotonic()
        wait_until(node, lambda: time.monotonic() > began + seconds, "Time", seconds + 10)
        return resident_mib(options.pid)

    try:
        sender.start()
        before_mib = load(options.warm_up)
        warm = len(sender.latencies_s())
        after_mib = load(options.seconds)
    finally:
        visitors.leave()
    sender.stop()

    # What is still planned ends, and is reported within a second; so is what the middleware lost, which never adds up.
    stopped = time.monotonic()
    health.status.clear()

    def settled():
        status = health.status.get("reorder: input")
        found = status and fates({entry.key: entry.value for entry in status.values})
        all_there = found and found[-1] and found[0] == len(sender.sent_s)
        return found if all_there or (found and time.monotonic() > stopped + 5) else None

    received, answered, superseded, dropped, adds_up = wait_until(node, settled, "An account of all that was sent")
    heard = len(sender.answered_s)
    latencies_ms = 1e3 * np.array(sender.latencies_s()[warm:])
    thirds = np.array_split(latencies_ms, 3)
    quantiles = {
        f"p{round(100 * part)}_ms_{name}_third": round(float(np.quantile(third, part)), 1)
        for part in (0.5, 0.99)
        for name, third in (("first", thirds[0]), ("last", thirds[-1]))
    }
    figures = {
        "sent": len(sender.sent_s),
        "answered": answered,
        "superseded": superseded + dropped,
        "lost": len(sender.sent_s) - received,
        "answers_heard": heard,
        "refused": len(sender.refusals),
        "visitors": visitors.came,
        **quantiles,
        "memory_mib_warm": round(before_mib, 1),
        "memory_mib_end": round(after_mib, 1),
    }
    print(json.dumps(figures), flush=True)
    check(adds_up and received == len(sender.sent_s), "What was sent and what became of it do not add up.")
    check(not sender.refusals, f"Good poses were refused: {next(iter(sender.refusals.values()), '')}")
    check(heard == answered, f"The node answered {answered} arrays, and {heard} answers came.")
    check(visitors.heard > 0, "The visitors heard nothing.")


if __name__ == "__main__":
    leave(run(converse, "load"))
