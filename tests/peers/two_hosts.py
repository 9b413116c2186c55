"""Lets the node answer poses across a long link, cuts that and restores it, and accounts for every array.

    two_hosts.py NODE BAG --profile config/dds/wan.xml|none [--seconds S] [--cuts S ...] [--delay-ms D] [--loss P]

To be run in a network namespace of its own: `unshare --net`, or `unshare --user --map-root-user --net` without root. Prints one JSON object.
Exit codes: 0 everything is accounted for and came back after every cut, 1 not, with one sentence on stderr.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from conversation import Failed, check
from link import Link

PEERS = Path(__file__).parent
RATE_HZ = 1.0
# What is measured is the link, not how long planning takes.
QUICK = ["-p", "timing.limits:=acceleration"]
# Discovery announces itself every 3 s and gives a peer up after 20 s.
AFTER_A_CUT_S = 15.0
RECOVERY_S = 10.0
# An array that was sent shortly before a cut may be answered after it only.
PATIENCE_S = 3.0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("node")
    parser.add_argument("bag")
    parser.add_argument("--profile", required=True, help="a file for Fast DDS, or none for its defaults over UDP")
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--cuts", type=float, nargs="*", default=[])
    parser.add_argument("--delay-ms", type=float, default=100.0, help="each way")
    parser.add_argument("--loss", type=float, default=0.05, help="each way, of packets")
    return parser.parse_args()


def environment(profile):
    """Shared memory does not end at a network namespace, so a profile without one would go around the link."""
    transport = {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"}
    if profile != "none":
        transport = {"FASTRTPS_DEFAULT_PROFILES_FILE": str(Path(profile).resolve(strict=True))}
    return {**os.environ, "ROS_DOMAIN_ID": "1", "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET", **transport}


def cross(options):
    """What the sender says of it, until when the link was steady, and when it was restored after each cut."""
    link, started = Link(options.delay_ms, options.loss), []
    try:
        env = environment(options.profile)
        started.append(link.b.start(options.node, "--ros-args", *QUICK, "--log-level", "error", env=env))
        words = (sys.executable, PEERS / "send_over_link.py", options.bag, "--rate", str(RATE_HZ))
        sender = link.a.start(*words, env=env, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        started.append(sender)
        check(sender.stdout.readline().strip() == "MATCHED", "The two hosts did not find each other.")
        time.sleep(options.seconds)
        steady_until, restored = time.monotonic(), []
        for cut_s in options.cuts:
            link.cut()
            time.sleep(cut_s)
            link.restore()
            restored.append(time.monotonic())
            time.sleep(AFTER_A_CUT_S)
        output, _ = sender.communicate()
        check(sender.returncode == 0, "The sender failed.")
        return json.loads(output), steady_until, restored
    finally:
        for process in started:
            process.send_signal(signal.SIGKILL)
            process.wait()
        link.close()


def main():
    options = arguments()
    try:
        account, steady_until, restored = cross(options)
        arrays = account["arrays"]
        heard = sum(answered is not None for _, answered in arrays)
        steady = [array for array in arrays if account["counted_from"] <= array[0] < steady_until - PATIENCE_S]
        took_s = [answered - sent for sent, answered in steady if answered is not None]
        check(took_s, "Nothing was answered before the first cut.")
        recoveries = [recovery(arrays, again) for again in restored]
        figures = {
            "sent": len(arrays),
            "heard_answers": heard,
            "superseded": account["superseded"],
            "lost_on_the_way_there": len(arrays) - account["received"],
            "lost_on_the_way_back": account["answered"] - heard,
            "steady_sent": len(steady),
            "steady_answered": len(took_s),
            "steady_p50_s": round(float(np.quantile(took_s, 0.5)), 2),
            "steady_p99_s": round(float(np.quantile(took_s, 0.99)), 2),
            "recovered_after_s": [again and round(again, 2) for again in recoveries],
        }
        print(json.dumps(figures), flush=True)
        fates = ("heard_answers", "superseded", "lost_on_the_way_there", "lost_on_the_way_back")
        check(sum(figures[fate] for fate in fates) == len(arrays), "Not every array is accounted for.")
        check(all(figures[fate] >= 0 for fate in fates), "More came than was sent.")
        check(all(again and again < RECOVERY_S for again in recoveries), "It did not recover from a cut.")
    except Failed as failed:
        print(failed, file=sys.stderr)
        return 1
    return 0


def recovery(arrays, restored):
    """From when the link was there again to the first answer to an array that was sent after that, in s."""
    answers = [answered for sent, answered in arrays if sent > restored and answered is not None]
    return min(answers) - restored if answers else None


if __name__ == "__main__":
    sys.exit(main())
