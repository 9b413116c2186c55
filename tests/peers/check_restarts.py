"""Kills the node, the publisher of poses and the arm in every order, and expects the rest to go on, and all to find together again.

    check_restarts.py NODE ARM BAG --execution topic|action [--within S]

NODE and ARM are executables. Prints one JSON object with the times in s. Exit codes: 0 all as it should be, 1 not, with one sentence on
stderr.
"""

import argparse
import itertools
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from action_msgs.msg import GoalStatusArray
from geometry_msgs.msg import PoseArray
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from check_health import LATCHED, OK, Health
from conversation import check, run, wait_until
from drive_arm import move, seconds
from leave import leave
from publish_bag import TOPIC, pose
from recorded_poses import read_pose_array

PEERS = Path(__file__).parent
# Planned without jerk limits: what is measured is who finds whom again.
QUICK = ["-p", "timing.limits:=acceleration"]
# A joint that is faster than this moves; one at rest has a hundredth of it.
MOVING_RAD_S = 0.02
# Joint states of half a second.
AT_REST = 100
# As long as a late trajectory would need to arrive and to show.
QUIET_S = 2.0
# Of config/robots/ur5e.yaml, with a fifth for the servos.
ACCELERATION_RAD_S2 = 1.2 * 5.0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("node")
    parser.add_argument("arm")
    parser.add_argument("bag")
    parser.add_argument("--execution", choices=("topic", "action"), required=True)
    parser.add_argument("--within", type=float, default=5.0, help="s, until everything works again")
    return parser.parse_args()


class Pipeline:
    """The three processes, and everything that can be seen of them."""

    def __init__(self, node, options):
        self.node, self.running = node, {}
        self.commands = {
            "node": [options.node, "--ros-args", "-p", f"execution:={options.execution}", *QUICK, "--log-level", "fatal"],
            "arm": [options.arm, "--ros-args", "--log-level", "fatal"],
            "publisher": [sys.executable, PEERS / "publish_steadily.py", options.bag],
        }
        self.health = Health(node)
        self.states, self.reports, self.trajectories, self.goals = [], [], [], set()
        node.create_subscription(JointState, "/joint_states", self.states.append, QoSProfile(depth=1000))
        node.create_subscription(String, "/reorder/report", self.heard, LATCHED)
        node.create_subscription(JointTrajectory, "/joint_trajectory", self.trajectories.append, 10)
        action = "/joint_trajectory_controller/follow_joint_trajectory/_action/status"
        node.create_subscription(GoalStatusArray, action, self.status, LATCHED)

    def heard(self, message):
        self.reports.append(json.loads(message.data))

    def status(self, message):
        self.goals |= {bytes(status.goal_info.goal_id.uuid) for status in message.status_list}

    def start(self, *names):
        for name in names:
            self.running[name] = subprocess.Popen(self.commands[name])

    def kill(self, *names):
        for name in names:
            process = self.running.pop(name)
            check(process.poll() is None, f"The {name} had ended by itself.")
            process.kill()
            process.wait()

    def moves(self):
        return self.states and moving(self.states[-1])

    def motions(self):
        """How many trajectories went to the arm."""
        return len(self.trajectories) + len(self.goals)

    def wait(self, condition, what, timeout_s=30.0):
        return wait_until(self.node, condition, what, timeout_s)

    def rest(self):
        """The arm is seen for a while, and does not move; nothing is sent to it."""
        self.states.clear()
        before, began = self.motions(), time.monotonic()
        self.wait(lambda: self.states and time.monotonic() > began + QUIET_S, "Joint states")
        fastest = max(max(map(abs, state.velocity)) for state in self.states)
        check(fastest < MOVING_RAD_S, f"The arm moves by itself, at {fastest:.3f} rad/s.")
        check(self.motions() == before, "A trajectory was sent that nobody asked for.")

    def stand(self):
        """The arm comes to rest, without a jump on the way."""
        # Between the approach and the curve it stops for a moment.
        self.wait(lambda: len(self.states) > AT_REST and not any(map(moving, self.states[-AT_REST:])), "Rest")
        rates = np.array([state.velocity for state in self.states])
        times = np.array([seconds(state.header.stamp) for state in self.states])
        # Stamps of an arm that was started anew do not go on from those before.
        steps = np.diff(times) > 1e-3
        fastest = np.abs(np.diff(rates, axis=0)[steps] / np.diff(times)[steps][:, None]).max()
        check(fastest < ACCELERATION_RAD_S2, f"The arm was accelerated with {fastest:.1f} rad/s².")


def moving(state):
    return max(map(abs, state.velocity)) > MOVING_RAD_S


def executing(pipeline, poses, message):
    """Asks for one motion, and returns when it is well under way."""
    pipeline.health.status.clear()
    pipeline.health.reach("joint states", OK)
    pipeline.wait(poses.get_subscription_count, "The node's subscription")
    pipeline.reports.clear()
    pipeline.states.clear()
    before = pipeline.motions()
    poses.publish(message)
    pipeline.wait(lambda: pipeline.motions() == before + 1, f"A trajectory: {pipeline.reports[-1:]}")
    pipeline.wait(pipeline.moves, "Motion")


def converse(node):
    options = arguments()
    pipeline = Pipeline(node, options)
    try:
        figures = {**one_motion(node, pipeline, options), **every_order(pipeline, options.within)}
    finally:
        for process in pipeline.running.values():
            process.kill()
            process.wait()
    print(json.dumps(figures), flush=True)


def one_motion(node, pipeline, options):
    """Each of those that matter dies while a motion is executed, and comes back: nothing is executed twice."""
    frame_id, rows = read_pose_array(options.bag)
    message = PoseArray(poses=[pose(row) for row in rows])
    message.header.frame_id = frame_id
    poses = node.create_publisher(PoseArray, TOPIC, 10)
    # Somebody's latched trajectory is no request either: whoever starts late must not set out because of it.
    latched = node.create_publisher(JointTrajectory, "/joint_trajectory", LATCHED)

    pipeline.start("node", "arm")
    executing(pipeline, poses, message)
    home = list(pipeline.states[0].position)
    began = time.monotonic()
    pipeline.kill("node")
    pipeline.start("node")
    pipeline.stand()
    finished_s = time.monotonic() - began
    pipeline.rest()

    executing(pipeline, poses, message)
    old = move(pipeline.states[-1].name, home, 0.3, 2.0)
    pipeline.kill("arm")
    latched.publish(old)
    pipeline.wait(lambda: pipeline.trajectories[-1:] == [old], "The latched trajectory")
    pipeline.start("arm")
    pipeline.states.clear()
    pipeline.wait(lambda: pipeline.states, "The arm")
    pipeline.rest()
    node.destroy_publisher(latched)
    node.destroy_publisher(poses)
    pipeline.kill("node", "arm")
    return {"motion_without_its_node_s": round(finished_s, 2)}


def every_order(pipeline, within_s):
    """Kills and restarts all three, one after the other, while they work."""
    reconnected_s = {}
    pipeline.start("node", "arm", "publisher")
    for order in itertools.permutations(("node", "publisher", "arm")):
        pipeline.wait(pipeline.moves, "Motion")
        for name in order:
            pipeline.kill(name)
            pipeline.start(name)
        restarted, restarted_ns = time.monotonic(), time.time_ns()
        # What was on its way shows nothing; that takes less than this.
        pipeline.reports.clear()
        pipeline.states.clear()
        pipeline.wait(lambda: answered(pipeline.reports, restarted_ns) and pipeline.moves(), "An answer, and motion")
        took_s = time.monotonic() - restarted
        reconnected_s[", ".join(order)] = round(took_s, 2)
        check(took_s < within_s, f"After {', '.join(order)} it took {took_s:.1f} s until everything worked again.")
    return {"reconnected_s": reconnected_s}


def answered(reports, restarted_ns):
    """Somebody published after the restart, and was answered by a node that knows where the robot is."""
    said = [report for report in reports if report.get("stamp_ns", 0) > restarted_ns]
    return any("refusal" not in report or "is moving" in report["refusal"] for report in said)


if __name__ == "__main__":
    leave(run(converse, "gremlin"))
