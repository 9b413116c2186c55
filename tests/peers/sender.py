"""Publishes arrays of poses at a rate, and notes which of them are answered, and when."""

import json
import time

from geometry_msgs.msg import PoseArray
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from publish_bag import TOPIC, pose

# Another request each time, and as hard to plan.
SHIFT_M = 1e-4
# After so many it begins again.
SHIFTS = 100
# The node latches its last report only; a reader that keeps more loses none while its process is busy.
REPORTS = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Sender:
    """Every array has a stamp of its own, in ns, which its report repeats."""

    def __init__(self, node, frame_id, rows, rate_hz):
        self.node, self.frame_id = node, frame_id
        self.arrays = [[pose([row[0] + SHIFT_M * shift, *row[1:]]) for row in rows] for shift in range(SHIFTS)]
        self.sent_s, self.answered_s, self.refusals = {}, {}, {}
        self.publisher = node.create_publisher(PoseArray, TOPIC, 10)
        node.create_subscription(String, "/reorder/report", self.heard, REPORTS)
        self.timer = node.create_timer(1 / rate_hz, self.send, autostart=False)

    def start(self):
        self.timer.reset()

    def stop(self):
        self.timer.cancel()

    def send(self):
        message = PoseArray(poses=self.arrays[len(self.sent_s) % len(self.arrays)])
        message.header.frame_id, message.header.stamp = self.frame_id, self.node.get_clock().now().to_msg()
        stamp = message.header.stamp
        self.sent_s[stamp.sec * 10**9 + stamp.nanosec] = time.monotonic()
        self.publisher.publish(message)

    def heard(self, message):
        report = json.loads(message.data)
        stamp = report.get("stamp_ns")
        if stamp in self.sent_s and stamp not in self.answered_s:
            self.answered_s[stamp] = time.monotonic()
            if "refusal" in report:
                self.refusals[stamp] = report["refusal"]

    def latencies_s(self):
        """Of those that were answered, in the order in which they were sent."""
        return [self.answered_s[stamp] - sent_s for stamp, sent_s in self.sent_s.items() if stamp in self.answered_s]


def fates(values):
    """What the node says has become of its messages: received, answered, superseded, dropped. Nothing is under way when they add up."""
    names = ("received", "answered", "superseded", "dropped")
    received, answered, superseded, dropped = (int(values[f"poses_{name}"]) for name in names)
    return received, answered, superseded, dropped, received == answered + superseded + dropped
