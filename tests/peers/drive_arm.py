"""Drives the simulated arm as a controller's client would, and expects of it what a real arm does.

    drive_arm.py

The arm is started with clock:=true, speed:=3.0 and rate_hz:=100.0. Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import time

import numpy as np
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionClient
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from conversation import check, run, wait_until
from goals import goals_of
from leave import leave

LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# The servos follow a gentle motion to a milliradian; noise there is none.
THERE_RAD = 0.002


def move(names, start, by, duration_s, points=41):
    """A quintic from rest to rest, every joint by as much."""
    u = np.linspace(0, 1, points)
    s = u**3 * (10 - 15 * u + 6 * u**2)
    ds = 30 * u**2 * (1 - u) ** 2 / duration_s
    dds = 60 * u * (1 - 3 * u + 2 * u**2) / duration_s**2
    trajectory = JointTrajectory(joint_names=list(names))
    for k in range(points):
        ns = round(u[k] * duration_s * 1e9)
        trajectory.points.append(
            JointTrajectoryPoint(
                positions=[q + by * s[k] for q in start],
                velocities=[by * ds[k]] * len(names),
                accelerations=[by * dds[k]] * len(names),
                time_from_start=Duration(sec=ns // 10**9, nanosec=ns % 10**9),
            )
        )
    return trajectory


def seconds(stamp):
    return stamp.sec + stamp.nanosec * 1e-9


def converse(node):
    states, clocks, descriptions = [], [], []
    node.create_subscription(JointState, "/joint_states", states.append, QoSProfile(depth=1000))
    node.create_subscription(Clock, "/clock", clocks.append, qos_profile_sensor_data)
    node.create_subscription(String, "/robot_description", descriptions.append, LATCHED)
    publisher = node.create_publisher(JointTrajectory, "/joint_trajectory", 10)
    client = ActionClient(node, FollowJointTrajectory, "/joint_trajectory_controller/follow_joint_trajectory")
    wait_until(
        node,
        lambda: states and clocks and descriptions and client.server_is_ready() and publisher.get_subscription_count(),
        "The arm's topics",
    )
    names = list(states[-1].name)
    check(len(names) == 6 and "<robot" in descriptions[0].data, f"It is no arm: {names}.")

    def here():
        return np.array(states[-1].position)

    send, result = goals_of(node, client)

    def arrive(where):
        wait_until(node, lambda: states and np.abs(here() - where).max() < THERE_RAD, f"The joints at {where}")

    # A goal is executed, faster than in its own time, with feedback, and the joints are where it says.
    home, began = here(), time.monotonic()
    states.clear()
    backwards = move(names[::-1], home[::-1], 0.3, 2.0)
    handle, feedback = send(backwards)
    check(handle.accepted, "A good goal is rejected.")
    ended = result(handle)
    took_s = time.monotonic() - began
    check(ended.status == GoalStatus.STATUS_SUCCEEDED, f"It ended as {ended}.")
    check(took_s < 2.0, f"Two seconds of the arm took {took_s} s.")
    arrive(home + 0.3)
    check(len(feedback) >= 3 and feedback[0].joint_names == names[::-1], "There was hardly any feedback.")
    check(max(np.abs(message.error.positions).max() for message in feedback) < THERE_RAD, "It does not follow.")
    steps = np.diff([seconds(state.header.stamp) for state in states])
    check(np.abs(steps - 1 / 100).max() < 0.0021, f"Joint states are {steps.min()} to {steps.max()} s apart.")
    check(np.all(np.diff([seconds(message.clock) for message in clocks]) > 0), "The clock does not go forward.")

    # Cancelled, it stops on the way, smoothly: no faster than the arm may brake.
    there = here()
    handle, feedback = send(move(names, there, -0.6, 4.0))
    wait_until(node, lambda: feedback and feedback[-1].desired.positions[0] < there[0] - 0.1, "Motion")
    states.clear()
    asked = handle.cancel_goal_async()
    check(result(handle).status == GoalStatus.STATUS_CANCELED, "It was not cancelled.")
    check(asked.done() and len(asked.result().goals_canceling) == 1, "The cancellation was not accepted.")
    # What was sent before may arrive only now.
    wait_until(node, lambda: any(abs(state.velocity[0]) > 0.05 for state in states), "Motion")
    wait_until(node, lambda: np.abs(states[-1].velocity).max() < 1e-4, "Rest")
    short = here()
    check(np.all(short < there - 0.01) and np.all(short > there - 0.55), f"It stopped at {short}.")
    rates = np.array([state.velocity for state in states])
    times = np.array([seconds(state.header.stamp) for state in states])
    braking = np.abs(np.diff(rates, axis=0) / np.diff(times)[:, None]).max()
    check(braking < 1.2 * 5.0, f"It brakes with {braking:.2f} rad/s².")

    # What would begin with a jump is rejected, and does not move the arm.
    handle, _ = send(move(names, short + 0.2, 0.1, 1.0))
    check(not handle.accepted, "A jump is accepted.")
    handle, _ = send(move([*names[:5], "seventh"], short, 0.1, 1.0))
    check(not handle.accepted, "A joint that the arm has not is accepted.")

    # A trajectory on the topic takes over from a goal that has not begun to move, and the goal knows.
    later = move(names, short, 0.1, 1.0)
    now_s = seconds(states[-1].header.stamp)
    later.header.stamp.sec = int(now_s) + 20
    handle, _ = send(later)
    publisher.publish(move(names, short, 0.2, 1.0))
    ended = result(handle)
    check(ended.status == GoalStatus.STATUS_ABORTED and "newer" in ended.result.error_string, f"{ended}")
    arrive(short + 0.2)


if __name__ == "__main__":
    leave(run(converse, "driver"))
