"""Uses an open rosbridge with roslibpy, as a lab does: python -m tests.integration.rosbridge.roslibpy_lab PORT.

Prints {name: value} per step. ROSLIBPY_TRANSPORT chooses the transport.
"""

import json
import os
import queue
import sys
from collections.abc import Callable
from typing import Any

import roslibpy
import roslibpy.tf
from roslibpy.ros1 import actionlib
from roslibpy.ros1.actionlib import GoalStatus

from tests.support.polling import until

SECONDS = 10
ENDED = (GoalStatus.PREEMPTED, GoalStatus.SUCCEEDED)
ACTION = "actionlib/TestAction"


def main() -> None:
    ros = roslibpy.Ros("127.0.0.1", int(sys.argv[1]))
    ros.run()
    use_topics(ros)
    use_services(ros)
    use_rosapi(ros)
    use_actions(ros)
    use_tf(ros)
    sys.stdout.flush()
    os._exit(0)  # its action server would publish for ever


def use_topics(ros: roslibpy.Ros) -> None:
    name = f"roslibpy {os.environ['ROSLIBPY_TRANSPORT']}"
    echo = Ear(ros, "/lab/echo", "std_msgs/String")
    # the first words are said before any connection between ROS nodes can be there
    say = roslibpy.Topic(ros, "/lab/say", "std_msgs/String")
    for number in range(20):
        say.publish(roslibpy.Message({"data": f"{name} {number}"}))
    say.publish(roslibpy.Message({"data": "end"}))
    tell("said", len(json.loads(echo.next(lambda message: f"{name} 0" in message["data"])["data"])))
    say.unadvertise()
    tell("none", Ear(ros, "/lab/numbers", "std_msgs/Float32MultiArray").next()["data"])


def use_services(ros: roslibpy.Ros) -> None:
    service = roslibpy.Service(ros, "/lab/set_bool", "std_srvs/SetBool")
    tell("calls", dict(service.call(roslibpy.ServiceRequest({"data": True}), timeout=SECONDS)))
    try:
        service.call(roslibpy.ServiceRequest({"data": False}), timeout=SECONDS)
    except Exception as error:
        tell("failure", str(error))

    def answer(request: dict[str, Any], response: dict[str, Any]) -> bool:
        response.update(success=request["data"], message="from the page")
        return True

    mine = roslibpy.Service(ros, "/client/set_bool", "std_srvs/SetBool")
    mine.advertise(answer)
    ask = roslibpy.Service(ros, "/lab/ask", "std_srvs/Trigger")
    tell("serves", dict(ask.call(roslibpy.ServiceRequest(), timeout=SECONDS)))
    mine.unadvertise()


def use_rosapi(ros: roslibpy.Ros) -> None:
    param = roslibpy.Param(ros, "/lab/roslibpy")
    param.set({"speeds": [1, 2.5], "name": "zwölf"}, timeout=SECONDS)
    tell("param", param.get(timeout=SECONDS))
    param.delete(timeout=SECONDS)
    tell("param is left", param.name in ros.get_params())
    tell("type", ros.get_topic_type("/lab/say"))
    tell("node", "/lab" in ros.get_nodes())


def use_actions(ros: roslibpy.Ros) -> None:
    counter = actionlib.ActionClient(ros, "/lab/action", ACTION)
    tell("action", run(counter, 3, lambda goal: None))
    tell("cancelled", run(counter, 200, actionlib.Goal.cancel)[1])

    server = actionlib.SimpleActionServer(ros, "/client/action", ACTION)

    def act(goal: dict[str, Any]) -> None:
        # actionlib's client takes no feedback before its send_goal() has returned
        ros.call_later(0.2, lambda: server.send_feedback({"feedback": 1}))
        ros.call_later(0.4, lambda: server.set_succeeded({"result": goal["goal"]}))

    server.start(act)
    request = roslibpy.Service(ros, "/lab/act", "std_srvs/Trigger")
    tell("acts", json.loads(request.call(roslibpy.ServiceRequest(), timeout=SECONDS)["message"]))


def run(client: actionlib.ActionClient, count: int, heard: Callable[[actionlib.Goal], None]) -> list[Any]:
    """The feedback, the status at the end and the result."""
    feedback: list[int] = []
    goal = actionlib.Goal(client, roslibpy.Message({"goal": count}))

    def hear(message: dict[str, Any]) -> None:
        feedback.append(message["feedback"])
        heard(goal)

    goal.on("feedback", hear)
    goal.send()
    result = goal.wait(SECONDS)
    # the status comes by a topic of its own, perhaps after the result
    until(lambda: goal.status["status"] in ENDED)
    return [feedback, goal.status["status"], result["result"]]


def use_tf(ros: roslibpy.Ros) -> None:
    heard: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
    transforms = roslibpy.tf.TFClient(ros, fixed_frame="arena")
    transforms.subscribe("robot", heard.put)
    tell("tf", heard.get(timeout=SECONDS)["translation"]["x"])
    tell("tf topic", Ear(ros, "/tf", "tf2_msgs/TFMessage").next()["transforms"][0]["child_frame_id"])


class Ear:
    """A subscription from now on."""

    def __init__(self, ros: roslibpy.Ros, name: str, kind: str) -> None:
        self._heard: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self._topic = roslibpy.Topic(ros, name, kind)
        self._topic.subscribe(self._heard.put)

    def next(self, wanted: Callable[[dict[str, Any]], bool] = lambda message: True) -> dict[str, Any]:
        """The next message that is wanted, which is the last one."""
        while not wanted(message := self._heard.get(timeout=SECONDS)):
            pass
        self._topic.unsubscribe()
        return message


def tell(name: str, value: Any) -> None:
    print(json.dumps({name: value}), flush=True)


if __name__ == "__main__":
    main()
