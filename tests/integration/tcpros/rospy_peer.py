"""A rospy node, the other side of ours, driven by JSON lines.

stdin: [command, arguments...]; stdout: [what, values...]. Strings of more than 100 characters are told by their
length. With --guarded it is guarded as our own programs are.
"""

import json
import sys
import threading
from collections.abc import Callable
from typing import Any

import rospy
from roscpp.srv import SetLoggerLevel  # type: ignore[import-untyped]
from std_msgs.msg import Int8, String

from laser_bot_battle.rospy_cures import cure_rospy, cure_services
from laser_bot_battle.srv import AddNewRobot


class Peer:
    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._publishers: dict[str, rospy.Publisher] = {}
        self._subscribers: dict[str, rospy.Subscriber] = {}
        self._services: dict[str, rospy.Service] = {}
        self._proxies: dict[str, rospy.ServiceProxy] = {}

    def say(self, *line: Any) -> None:
        with self._lock:
            print(json.dumps(line), flush=True)

    def advertise(self, topic: str, latch: bool = False) -> None:
        self._publishers[topic] = rospy.Publisher(topic, String, queue_size=1000, latch=latch)
        self.say("advertised", topic)

    def publish(self, topic: str, *texts: Any) -> None:
        """A number is the length of a text."""
        for text in texts:
            self._publishers[topic].publish("x" * text if isinstance(text, int) else text)

    def subscribe(self, topic: str) -> None:
        def heard(message: Any) -> None:
            text = message.data
            self.say("heard", topic, text if len(text) <= 100 else len(text), message._connection_header["latching"])

        self._subscribers[topic] = rospy.Subscriber(topic, String, heard)
        self.say("subscribed", topic)

    def subscribe_as_int8(self, topic: str) -> None:
        self._subscribers[topic] = rospy.Subscriber(topic, Int8, lambda _: self.say("heard", topic, "int8"))
        self.say("subscribed", topic)

    def serve(self, name: str, answer: int) -> None:
        self._serve(name, AddNewRobot, lambda _: answer)

    def serve_failing(self, name: str) -> None:
        def fail(request: Any) -> None:
            raise rospy.ServiceException(f"no logger {request.logger}")

        self._serve(name, SetLoggerLevel, fail)

    def _serve(self, name: str, kind: Any, handler: Callable[[Any], Any]) -> None:
        if name in self._services:
            self._services[name].shutdown()
        self._services[name] = rospy.Service(name, kind, handler)

    def call(self, name: str, logger: str | int, persistent: bool = False) -> None:
        """A number is the length of a text."""
        if name not in self._proxies:
            self._proxies[name] = rospy.ServiceProxy(name, SetLoggerLevel, persistent=persistent)
        try:
            self._proxies[name]("x" * logger if isinstance(logger, int) else logger, "level")
        except rospy.ServiceException as error:
            self.say("failed", name, logger, str(error))
        else:
            self.say("done", name, logger)

    def drop(self, name: str) -> None:
        self._proxies.pop(name).close()

    def wait_for_service(self, name: str) -> None:
        rospy.wait_for_service(name, 10)
        self.say("there", name)


def main() -> None:
    if is_guarded := "--guarded" in sys.argv:
        cure_rospy()
    rospy.init_node(sys.argv[1], disable_signals=True)
    if is_guarded:
        cure_services()
    peer = Peer()
    peer.say("ready")
    for line in sys.stdin:
        command, *arguments = json.loads(line)
        method: Callable[..., None] = getattr(peer, command)
        method(*arguments)
    rospy.signal_shutdown("the test is over")


if __name__ == "__main__":
    main()
