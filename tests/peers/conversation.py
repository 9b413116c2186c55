"""Waiting for what a peer needs, never longer than a deadline."""

import sys
import time

import rclpy

TIMEOUT_S = 60.0


class Failed(Exception):
    """What did not come, or was not as it should be, in one sentence."""


def wait_until(node, condition, what, timeout_s=TIMEOUT_S):
    """Spins until `condition()` is true, and returns what it returned."""
    deadline = time.monotonic() + timeout_s
    while not (found := condition()):
        if time.monotonic() > deadline:
            raise Failed(f"{what} did not come within {timeout_s:g} s.")
        rclpy.spin_once(node, timeout_sec=0.05)
    return found


def call(node, kind, name, request):
    """The answer of a service, once it is there."""
    client = node.create_client(kind, name)
    wait_until(node, client.service_is_ready, f"The service {name}")
    answer = client.call_async(request)
    wait_until(node, answer.done, f"The answer of {name}")
    node.destroy_client(client)
    return answer.result()


def check(holds, sentence):
    if not holds:
        raise Failed(sentence)


def run(conversation, name):
    """Exit code 0 where the conversation went as it should, 1 with the reason on stderr."""
    rclpy.init()
    try:
        conversation(rclpy.create_node(name))
    except Failed as failed:
        print(failed, file=sys.stderr)
        return 1
    return 0
