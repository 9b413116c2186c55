"""Goals of FollowJointTrajectory, for peers that drive an arm."""

from control_msgs.action import FollowJointTrajectory

from conversation import wait_until


def goals_of(node, client):
    """How goals of FollowJointTrajectory are sent (a handle and the feedback to come), and how one ends."""

    def send(trajectory):
        goal, feedback = FollowJointTrajectory.Goal(trajectory=trajectory), []
        sent = client.send_goal_async(goal, feedback_callback=lambda message: feedback.append(message.feedback))
        wait_until(node, sent.done, "The answer to a goal")
        return sent.result(), feedback

    def result(handle):
        asked = handle.get_result_async()
        wait_until(node, asked.done, "The result of a goal")
        return asked.result()

    return send, result
