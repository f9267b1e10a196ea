# mypy: disable-error-code="import-untyped,import-not-found"
"""The ROS side of a lab, a process of its own, as other people's programs are: topics, services, actions and tf.

`/lab/echo` tells all that `/lab/say` has heard, once it was the word END. Services: `/lab/set_bool`; `/lab/ask` calls
the client's `/client/set_bool`, `/lab/act` gives the client's `/client/action` a goal, and `/lab/acted` answers when
feedback has come. Action server: `/lab/action`.
tf: `/tf`, and what tf2_web_republisher has to offer. Prints "ready".
"""

import json
from functools import partial
from typing import Any

import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import Float32MultiArray, String
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse
from tf2_msgs.msg import TFMessage
from tf2_web_republisher.msg import TFArray, TFSubscriptionAction, TFSubscriptionFeedback
from tf2_web_republisher.srv import RepublishTFs, RepublishTFsResponse

from tests.support.polling import until

END = "end"
NUMBERS = [0.5, -2.0, 1e6]
STEP = 0.05  # s between two numbers of an action's feedback
GOAL = 3


def main() -> None:
    rospy.init_node("lab")
    kept = [serve_topics(), serve_services(), serve_action(), serve_tf()]
    print(f"ready: {len(kept)} parts", flush=True)
    rospy.spin()


def serve_topics() -> object:
    echo = rospy.Publisher("/lab/echo", String, queue_size=10, latch=True)
    numbers = rospy.Publisher("/lab/numbers", Float32MultiArray, queue_size=10, latch=True)
    numbers.publish(data=NUMBERS)
    heard: list[str] = []

    def hear(message: String) -> None:
        heard.append(message.data)
        if message.data == END:
            echo.publish(json.dumps(heard))
            heard.clear()

    return rospy.Subscriber("/lab/say", String, hear), numbers


def serve_services() -> object:
    def set_bool(request: SetBool) -> SetBoolResponse:
        if not request.data:
            raise rospy.ServiceException("not today")
        return SetBoolResponse(True, "grüß Gott")

    def ask(_: Trigger) -> TriggerResponse:
        rospy.wait_for_service("/client/set_bool", 5)
        answer = rospy.ServiceProxy("/client/set_bool", SetBool)(True)
        return TriggerResponse(answer.success, answer.message)

    feedback: list[int] = []

    def act(_: Trigger) -> TriggerResponse:
        feedback.clear()
        client = actionlib.SimpleActionClient("/client/action", TestAction)
        reached = client.wait_for_server(rospy.Duration(5))
        # rospy's own numbers count connections that are only being made, too
        for subscriber in (client.action_client.feedback_sub, client.action_client.result_sub):
            until(partial(is_connected, subscriber.impl), what=subscriber.name)
        client.send_goal(TestGoal(GOAL), feedback_cb=lambda message: feedback.append(message.feedback))
        client.wait_for_result(rospy.Duration(5))
        result = client.get_result()
        return TriggerResponse(
            reached, json.dumps([sorted(set(feedback)), client.get_state(), result and result.result])
        )

    def acted(_: Trigger) -> TriggerResponse:
        until(lambda: feedback, what="feedback of the goal")
        return TriggerResponse(True, "")

    services = {
        "/lab/set_bool": (SetBool, set_bool),
        "/lab/ask": (Trigger, ask),
        "/lab/act": (Trigger, act),
        "/lab/acted": (Trigger, acted),
    }
    return [rospy.Service(name, kind, answer) for name, (kind, answer) in services.items()]


def is_connected(topic: Any) -> bool:
    return any(connection.header for connection in topic.connections)


def serve_action() -> object:
    def count(goal: TestGoal) -> None:
        for number in range(1, goal.goal + 1):
            rospy.sleep(STEP)
            if server.is_preempt_requested():
                server.set_preempted(TestResult(number))
                return
            server.publish_feedback(TestFeedback(number))
        rospy.sleep(STEP)
        server.set_succeeded(TestResult(goal.goal))

    server = actionlib.SimpleActionServer("/lab/action", TestAction, count, auto_start=False)
    server.start()
    return server


def serve_tf() -> object:
    publisher = rospy.Publisher("/tf", TFMessage, queue_size=10)
    republished = rospy.Publisher("/lab/republished", TFArray, queue_size=10, latch=True)

    def transform(frame: str, target: str) -> TransformStamped:
        stamped = TransformStamped()
        stamped.header.stamp = rospy.Time.now()
        stamped.header.frame_id, stamped.child_frame_id = target, frame
        stamped.transform.translation.x = 0.0 if frame.strip("/") == target.strip("/") else 1.5
        stamped.transform.rotation.w = 1.0
        return stamped

    def republish(goal: object) -> None:
        while not server.is_preempt_requested() and not rospy.is_shutdown():
            transforms = [transform(frame, goal.target_frame) for frame in goal.source_frames]  # type: ignore[attr-defined]
            server.publish_feedback(TFSubscriptionFeedback(transforms))
            rospy.sleep(STEP)
        server.set_preempted()

    def republish_on_topic(request: RepublishTFs) -> RepublishTFsResponse:
        republished.publish([transform(frame, request.target_frame) for frame in request.source_frames])
        return RepublishTFsResponse("/lab/republished")

    server = actionlib.SimpleActionServer("/tf2_web_republisher", TFSubscriptionAction, republish, auto_start=False)
    server.start()
    service = rospy.Service("/republish_tfs", RepublishTFs, republish_on_topic)
    timer = rospy.Timer(rospy.Duration(STEP), lambda _: publisher.publish([transform("robot", "arena")]))
    return server, service, timer


if __name__ == "__main__":
    main()
