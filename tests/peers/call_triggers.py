"""Calls std_srvs/Trigger services one after the other and prints each answer on stderr.

    call_triggers.py /reorder/replan /reorder/clear

Exit codes: 0 all answered, 3 one did not within 30 s.
"""

import sys

import rclpy
from std_srvs.srv import Trigger

from leave import leave

TIMEOUT_S = 30.0


def main():
    rclpy.init()
    node = rclpy.create_node("trigger_caller")
    for name in sys.argv[1:]:
        client = node.create_client(Trigger, name)
        if not client.wait_for_service(TIMEOUT_S):
            print(f"{name} is not there after {TIMEOUT_S:g} s.", file=sys.stderr)
            return 3
        answer = client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, answer, timeout_sec=TIMEOUT_S)
        if not answer.done():
            print(f"{name} did not answer within {TIMEOUT_S:g} s.", file=sys.stderr)
            return 3
        print(f"{name} {answer.result().success}: {answer.result().message}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    leave(main())
