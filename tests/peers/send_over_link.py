"""Is the arm and the source of poses for a node that is far away, and notes when what was sent, and when it was answered.

    send_over_link.py BAG --rate HZ

Prints MATCHED when the first answer has come. Sends until its standard input ends; then waits for late answers and prints one JSON object:
when each array was sent, and when its answer came (null if it did not), in s of the monotonic clock, and what the node says of what it
received. Exit codes: 0 done, 1 not, with one sentence on stderr.
"""

import argparse
import json
import select
import sys
import time

from check_health import Health
from conversation import run, wait_until
from leave import leave
from publish_bag import CONFIGURATIONS_RAD, JointStates
from recorded_poses import read_pose_array
from sender import Sender, fates

# Whatever has not been answered by then is lost.
PATIENCE_S = 5.0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bag")
    parser.add_argument("--rate", type=float, required=True)
    return parser.parse_args()


def converse(node):
    options = arguments()
    frame_id, rows = read_pose_array(options.bag)
    health, states = Health(node), JointStates(node, CONFIGURATIONS_RAD["home"])
    sender = Sender(node, frame_id, rows, options.rate)
    wait_until(node, lambda: sender.publisher.get_subscription_count() and states.settled(), "The node's subscriptions")
    sender.start()
    wait_until(node, lambda: len(sender.answered_s) > len(sender.refusals), "The first answer")
    # Those that were sent before everybody had found everybody do not count.
    counted_from = time.monotonic()
    print("MATCHED", flush=True)
    wait_until(node, lambda: select.select([sys.stdin], [], [], 0)[0], "The end of the input", 3600)
    sender.stop()
    stopped = time.monotonic()
    wait_until(node, lambda: time.monotonic() > stopped + PATIENCE_S, "Time", PATIENCE_S + 10)
    health.status.clear()
    wait_until(node, lambda: "reorder: input" in health.status, "Word from the node")
    received, answered, superseded, dropped, _ = fates(
        {entry.key: entry.value for entry in health.status["reorder: input"].values}
    )
    arrays = [[sent_s, sender.answered_s.get(stamp)] for stamp, sent_s in sender.sent_s.items()]
    account = {"received": received, "answered": answered, "superseded": superseded + dropped}
    print(json.dumps({"counted_from": counted_from, "arrays": arrays, **account}), flush=True)


if __name__ == "__main__":
    leave(run(converse, "far_away"))
