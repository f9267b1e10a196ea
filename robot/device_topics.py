"""The ROS side of the device's topics: rospy publishers for what it publishes, subscribers for what it subscribes."""

import io
import logging
from collections.abc import Callable
from typing import Any

import genpy
import rosgraph.names
import rospy

from robot.message_types import message_class
from robot.rosserial.topic_info import TopicInfo

_log = logging.getLogger(__name__)


class DeviceTopics:
    """Owned by one thread; `on_command(topic, payload)` is called from rospy's threads."""

    def __init__(self, on_command: Callable[[TopicInfo, bytes], None]) -> None:
        self._on_command = on_command
        self._known: dict[int, TopicInfo] = {}
        self._endpoints: dict[int, Any] = {}  # rospy.Publisher or rospy.Subscriber
        self._types: dict[int, Any] = {}

    def publish_for(self, info: TopicInfo) -> None:
        """Make ready for messages that the device will publish."""
        self._open(info, lambda kind: rospy.Publisher(info.topic_name, kind, queue_size=10, tcp_nodelay=True))

    def subscribe_for(self, info: TopicInfo) -> None:
        """Have what ROS publishes on the topic handed to `on_command`, of several waiting messages only the newest."""

        def received(message: genpy.Message) -> None:
            self._on_command(info, serialised(message))

        self._open(info, lambda kind: rospy.Subscriber(info.topic_name, kind, received, queue_size=1, tcp_nodelay=True))

    def publish(self, topic_id: int, payload: bytes) -> None:
        """Publish a message of the device; nothing happens for a topic that was refused."""
        publisher = self._endpoints.get(topic_id)
        if publisher is None:
            return
        message = self._types[topic_id]()
        try:
            message.deserialize(payload)
        except genpy.DeserializationError as error:
            _log.warning("message of %d bytes on %s dropped: %s", len(payload), publisher.resolved_name, error)
            return
        publisher.publish(message)

    def _open(self, info: TopicInfo, make: Callable[[Any], Any]) -> None:
        """A known topic stays as it is, a changed one is opened again, an impossible one is refused and logged."""
        if self._known.get(info.topic_id) == info:
            return
        self._known[info.topic_id] = info
        old = self._endpoints.pop(info.topic_id, None)
        if old is not None:
            old.unregister()
        try:
            if not info.topic_name.strip("/") or not rosgraph.names.is_legal_name(info.topic_name):
                raise ValueError(f"{info.topic_name!r} is not a legal name of a ROS topic")
            self._types[info.topic_id] = message_class(info)
            endpoint = make(self._types[info.topic_id])
        except (ValueError, rospy.ROSException) as error:
            _log.error("topic refused: %s", error)
            return
        self._endpoints[info.topic_id] = endpoint
        _log.info("%s (%s) joined, id %d", endpoint.resolved_name, info.message_type, info.topic_id)


def serialised(message: genpy.Message) -> bytes:
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()
