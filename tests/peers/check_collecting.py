"""Sends poses one by one, some twice, some wrong, and expects one answer to all of them.

    check_collecting.py BAG

The node is started with quiet_s:=0.0 and require_joint_state:=false. Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import json
import sys

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseArray, PoseStamped
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_msgs.msg import String
from std_srvs.srv import Trigger

from check_health import LATCHED, Health
from conversation import call, check, run, wait_until
from leave import leave
from publish_bag import pose
from recorded_poses import read_pose_array


def converse(node):
    health = Health(node)
    frame_id, rows = read_pose_array(sys.argv[1])
    reports = []
    node.create_subscription(String, "/reorder/report", lambda m: reports.append(json.loads(m.data)), LATCHED)
    single = node.create_publisher(PoseStamped, "/reorder/pose", 1000)
    array = node.create_publisher(PoseArray, "/reorder/poses", 10)
    wait_until(
        node,
        lambda: single.get_subscription_count() and array.get_subscription_count(),
        "The node's subscriptions",
    )

    def send(row, second, frame=frame_id):
        message = PoseStamped(pose=pose(row))
        message.header.frame_id, message.header.stamp = frame, Time(sec=second)
        single.publish(message)

    def waiting(count):
        def reached():
            status = health.status.get("reorder: input")
            values = {entry.key: entry.value for entry in status.values} if status else {}
            return values if values.get("single_poses_waiting") == str(count) else None

        return wait_until(node, reached, f"Word of {count} waiting poses")

    # Stamps in no order; the first pose is wrong at first, one comes twice, one is in another frame.
    seconds = [1 + (7 * k) % len(rows) for k in range(len(rows))]
    check(len(set(seconds)) == len(rows), "Stamps repeat.")
    send(rows[1], seconds[0])
    for row, second in zip(rows, seconds):
        send(row, second)
    send(rows[5], seconds[5])
    send(rows[5], 10**6, "moon")
    values = waiting(len(rows))
    odd = [values[f"single_poses_{kind}"] for kind in ("repeated", "corrected", "refused")]
    check(odd == ["1", "1", "1"], f"Repeated, corrected, refused: {odd}.")
    check(not reports, "It did not wait.")
    answer = call(node, Trigger, "/reorder/replan", Trigger.Request())
    check(answer.success and f"the {len(rows)} poses" in answer.message, f"{answer}")
    wait_until(node, lambda: reports, "The report of all poses")
    check(reports[-1].get("n") == len(rows) and "plan" in reports[-1], f"The report is {str(reports[-1])[:200]}.")

    # An array takes the place of what is not complete.
    for second in range(3):
        send(rows[second], 1 + second)
    waiting(3)
    reports.clear()
    message = PoseArray(poses=[pose(row) for row in rows[:40]])
    message.header.frame_id = frame_id
    array.publish(message)
    wait_until(node, lambda: reports, "The report of the array")
    check("refusal" in reports[-1] or reports[-1]["n"] == 40, f"The report is {str(reports[-1])[:200]}.")
    waiting(0)

    # Complete by silence.
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=0.2)
    request = SetParameters.Request(parameters=[Parameter(name="quiet_s", value=value)])
    check(call(node, SetParameters, "/reorder/set_parameters", request).results[0].successful, "quiet_s is not set.")
    reports.clear()
    for second, row in enumerate(rows):
        send(row, 1 + second)
    wait_until(node, lambda: any(report.get("n") == len(rows) for report in reports), "The report after silence")
    health.reach("planning", DiagnosticStatus.OK, f"{len(rows)} poses")


if __name__ == "__main__":
    leave(run(converse, "scanner"))
