"""The ROS side of the device's topics: a publisher for what it publishes, a subscriber for what it subscribes."""

import io
import logging
import time
from collections.abc import Callable
from typing import Any

import genpy
import rospy

from laser_bot_battle.rospy_cures import Subscription
from robot.rosserial.topic_info import TopicInfo
from robot.serial.message_types import message_class

_log = logging.getLogger(__name__)


class PublishedTopic:
    """What the device publishes is published in ROS; ValueError if it has a type that cannot be."""

    def __init__(self, info: TopicInfo) -> None:
        self._kind = message_class(info)
        self._publisher = rospy.Publisher(info.topic_name, self._kind, queue_size=10, tcp_nodelay=True)
        self.name = self._publisher.resolved_name

    def receive(self, payload: bytes) -> None:
        message = deserialised(self._kind, payload, self.name)
        if message is not None:
            self._publisher.publish(message)

    def close(self) -> None:
        self._publisher.unregister()


class TakenTopic:
    """What the device publishes is handed to this node; ValueError if it has another version of the type."""

    def __init__(self, info: TopicInfo, take: Callable[[Any], None]) -> None:
        self._kind = message_class(info)
        self._take = take
        self.name = info.topic_name

    def receive(self, payload: bytes) -> None:
        message = deserialised(self._kind, payload, self.name)
        if message is not None:
            self._take(message)

    def close(self) -> None:
        """Nothing in ROS knows of it."""


class SubscribedTopic:
    """What ROS publishes on the topic is handed to `on_command(info, payload)`, of several waiting messages only the
    newest; ValueError if it has a type that cannot be."""

    def __init__(self, info: TopicInfo, on_command: Callable[[TopicInfo, bytes], None]) -> None:
        self._info = info
        self._kind = message_class(info)
        self._on_command = on_command
        self.subscription = Subscription(self._subscribe, time.monotonic())
        self.name = self.subscription.name

    def _subscribe(self) -> rospy.Subscriber:
        def received(message: genpy.Message) -> None:
            self._on_command(self._info, serialised(message))

        return rospy.Subscriber(self._info.topic_name, self._kind, received, queue_size=1, tcp_nodelay=True)

    def receive(self, payload: bytes) -> None:
        """A device sends nothing on what it subscribes to."""

    def close(self) -> None:
        self.subscription.close()


def serialised(message: genpy.Message) -> bytes:
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def deserialised(kind: Any, payload: bytes, where: str) -> Any:
    """The message, or None with a line in the log if the bytes are none."""
    message = kind()
    try:
        message.deserialize(payload)
    except genpy.DeserializationError as error:
        _log.warning("message of %d bytes on %s dropped: %s", len(payload), where, error)
        return None
    return message
