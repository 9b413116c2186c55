"""Leads the node through its life cycle beside a managed node of rclpy, which is the model for every answer.

    check_lifecycle.py

The node is started with autostart:=false. Exit codes: 0 all as it should be, 1 not, with one sentence on stderr.
"""

import rclpy
from geometry_msgs.msg import PoseArray
from lifecycle_msgs.msg import Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String
from std_srvs.srv import Trigger

from conversation import call, check, run, wait_until
from leave import leave

SERVICES = {
    "get_state": GetState,
    "get_available_states": GetAvailableStates,
    "get_available_transitions": GetAvailableTransitions,
    "get_transition_graph": GetAvailableTransitions,
}


def answers(node, of):
    """What a managed node says of itself, without the order of lists: nothing depends on that."""
    said = {name: call(node, kind, f"{of}/{name}", kind.Request()) for name, kind in SERVICES.items()}
    said["get_state"] = [said["get_state"].current_state]
    said["get_available_states"] = said["get_available_states"].available_states
    for name in ("get_available_transitions", "get_transition_graph"):
        said[name] = said[name].available_transitions
    return {name: sorted(map(repr, entries)) for name, entries in said.items()}


def change(node, of, **transition):
    request = ChangeState.Request(transition=Transition(**transition))
    return call(node, ChangeState, f"{of}/change_state", request).success


def converse(node):
    model = LifecycleNode("model")
    rclpy.get_global_executor().add_node(model)  # which spins whenever this node waits
    events, model_events, reports = [], [], []
    node.create_subscription(TransitionEvent, "/reorder/transition_event", events.append, 100)
    node.create_subscription(TransitionEvent, "/model/transition_event", model_events.append, 100)
    node.create_subscription(String, "/reorder/report", reports.append, 10)
    poses = node.create_publisher(PoseArray, "/reorder/poses", 10)
    wait_until(
        node,
        lambda: all(node.count_publishers(f"/{of}/transition_event") for of in ("reorder", "model"))
        and node.count_publishers("/reorder/report")
        and poses.get_subscription_count(),
        "The topics of both nodes",
    )
    both = ("/reorder", "/model")

    def same(after):
        ours, theirs = (answers(node, of) for of in both)
        for name in SERVICES:
            check(ours[name] == theirs[name], f"After {after}, {name} says {ours[name]}, the model {theirs[name]}.")

    same("the start")
    refused = call(node, Trigger, "/reorder/replan", Trigger.Request())
    check(not refused.success and "unconfigured" in refused.message, f"{refused}")
    # The model raises an exception here.
    check(not change(node, "/reorder", id=Transition.TRANSITION_ACTIVATE), "It went from unconfigured to active.")
    steps = [
        {"id": Transition.TRANSITION_CONFIGURE},
        {"label": "activate"},
        {"id": Transition.TRANSITION_DEACTIVATE},
        {"id": Transition.TRANSITION_CLEANUP},
        {"label": "configure"},
        {"label": "activate"},
    ]
    for step in steps:
        ours, theirs = (change(node, of, **step) for of in both)
        check(ours == theirs, f"{step} succeeds: {ours}, with the model: {theirs}.")
        same(step)
    # Active, it answers poses, if only by a refusal; inactive it does not.
    poses.publish(PoseArray())
    wait_until(node, lambda: any("refusal" in report.data for report in reports), "A refusal of no poses")
    for step in ({"label": "deactivate"}, {"label": "shutdown"}):
        check(all(change(node, of, **step) for of in both), f"{step} was refused.")
        same(step)
    wait_until(node, lambda: len(events) == len(model_events) == 16, "Sixteen events of each node")
    told = [[(event.start_state.label, event.goal_state.label) for event in of] for of in (events, model_events)]
    check(told[0] == told[1], f"The events are {told[0]}, the model's {told[1]}.")
    # The model leaves this out.
    labels = [event.transition.label for event in events]
    check(labels[:4] == ["configure", "transition_success", "activate", "transition_success"], f"{labels}")


if __name__ == "__main__":
    leave(run(converse, "manager"))
