"""Asks the node about its parameters and changes them at run time, as `ros2 param` and rqt_reconfigure do.

    check_parameters.py BAG

Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import sys

from geometry_msgs.msg import PoseArray
from rcl_interfaces.msg import Parameter, ParameterEvent, ParameterType, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from trajectory_msgs.msg import JointTrajectory

from conversation import call, check, run, wait_until
from leave import leave
from publish_bag import pose
from recorded_poses import read_pose_array


def value(x):
    if isinstance(x, bool):
        return ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=x)
    if isinstance(x, int):
        return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=x)
    if isinstance(x, float):
        return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=x)
    return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=x)


def parameters(**wanted):
    return [Parameter(name=name.replace("__", "."), value=value(x)) for name, x in wanted.items()]


def converse(node):
    events = []
    node.create_subscription(ParameterEvent, "/parameter_events", events.append, 100)

    def ask(kind, name, **request):
        return call(node, kind, f"/reorder/{name}", kind.Request(**request))

    def get(name):
        return ask(GetParameters, "get_parameters", names=[name]).values[0]

    listed = ask(ListParameters, "list_parameters").result
    check({"approach", "timing.rate_hz", "use_sim_time"} <= set(listed.names), f"Listed are {listed.names}.")
    check({"robot", "path", "timing"} <= set(listed.prefixes), f"Groups are {listed.prefixes}.")
    timing = ask(ListParameters, "list_parameters", prefixes=["timing"]).result.names
    check(timing and all(name.startswith("timing.") for name in timing), f"Under timing are {timing}.")

    rate, robot = ask(DescribeParameters, "describe_parameters", names=["timing.rate_hz", "robot.name"]).descriptors
    bounds = rate.floating_point_range[0]
    check((bounds.from_value, bounds.to_value) == (10.0, 10000.0) and "second" in rate.description, f"{rate}")
    check(robot.read_only and robot.type == ParameterType.PARAMETER_STRING, f"{robot}")
    types = ask(GetParameterTypes, "get_parameter_types", names=["approach", "nonsense"]).types
    check(list(types) == [ParameterType.PARAMETER_BOOL, ParameterType.PARAMETER_NOT_SET], f"Types are {types}.")

    results = ask(
        SetParameters,
        "set_parameters",
        parameters=parameters(
            timing__rate_hz=50, timing__jerk_scale=2.0, aproach=True, robot__name="panda", topology=True
        ),
    ).results
    check([result.successful for result in results] == [True, False, False, False, False], f"{results}")
    reasons = [result.reason for result in results[1:]]
    check(
        reasons
        == [
            "timing.jerk_scale must be from 0.001 to 1, not 2",
            "there is no parameter aproach",
            "robot.name is read at the start only: start the node with the new value",
            "topology must be the string auto or open or closed, not a boolean",
        ],
        f"The reasons are {reasons}.",
    )
    check(get("timing.rate_hz").double_value == 50.0, "The rate was not changed.")
    check(get("timing.jerk_scale").double_value == 1.0, "A refused change changed something.")

    both = parameters(timing__rate_hz=200.0, timing__velocity_scale=0.0)
    result = ask(SetParametersAtomically, "set_parameters_atomically", parameters=both).result
    check(not result.successful and "velocity_scale" in result.reason, f"{result}")
    check(get("timing.rate_hz").double_value == 50.0, "Half of an atomic change was made.")
    both = parameters(timing__rate_hz=20.0, require_joint_state=False)
    check(ask(SetParametersAtomically, "set_parameters_atomically", parameters=both).result.successful, "Not set.")

    def changed():
        told = [{p.name for p in event.changed_parameters} for event in events if event.node == "/reorder"]
        return {"timing.rate_hz"} in told and {"timing.rate_hz", "require_joint_state"} in told

    wait_until(node, changed, "The event of the changed parameters")

    # What was changed is what the next plan heeds.
    trajectories = []
    node.create_subscription(JointTrajectory, "/joint_trajectory", trajectories.append, 10)
    poses = node.create_publisher(PoseArray, "/reorder/poses", 10)
    frame_id, rows = read_pose_array(sys.argv[1])
    wait_until(
        node,
        lambda: poses.get_subscription_count() and node.count_publishers("/joint_trajectory"),
        "The node's topics",
    )
    message = PoseArray(poses=[pose(row) for row in rows])
    message.header.frame_id = frame_id
    poses.publish(message)
    wait_until(node, lambda: trajectories, "A trajectory")
    steps = [point.time_from_start for point in trajectories[0].points[:2]]
    spacing_ns = (steps[1].sec - steps[0].sec) * 10**9 + steps[1].nanosec - steps[0].nanosec
    # The duration is divided evenly.
    check(45_000_000 < spacing_ns <= 50_000_000, f"Points are {spacing_ns} ns apart, not some 1/20 s.")


if __name__ == "__main__":
    leave(run(converse, "parameter_asker"))
