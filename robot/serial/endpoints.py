"""What ROS sees of the device's topics and services. They are joined to ROS by a thread of its own: the ROS master may
be slow, and the serial line may not."""

import logging
import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import rosgraph.names
import rospy

from laser_bot_battle.master import Master
from laser_bot_battle.msg import Setup
from laser_bot_battle.rospy_cures import hear_again
from robot.rosserial.events import DeviceCalls, DevicePublishes, DeviceServes, DeviceSubscribes
from robot.rosserial.topic_info import TopicInfo
from robot.serial.device_services import CalledService, ServedService
from robot.serial.device_topics import PublishedTopic, SubscribedTopic, TakenTopic
from robot.serial.name_rules import refusal
from robot.task_thread import TaskThread

_log = logging.getLogger(__name__)

Told = DevicePublishes | DeviceSubscribes | DeviceServes | DeviceCalls


class Endpoint(Protocol):
    name: str  # as ROS resolved it

    def receive(self, payload: bytes) -> None: ...

    def close(self) -> None: ...


class Endpoints:
    """`tell` and `receive` are called by the thread of the serial line."""

    def __init__(
        self,
        on_command: Callable[[TopicInfo, bytes], None],
        send: Callable[[int, bytes], None],
        taken: Mapping[str, Callable[[Any], None]],
        master: Master,
    ) -> None:
        """`on_command(topic, payload)`: what ROS publishes; `send(id, payload)`: of a service, to the device. Both are
        called from rospy's threads. Messages of the types in `taken` are not published, but go to these functions."""
        self._on_command = on_command
        self._send = send
        self._taken = taken
        self._master = master
        self._told: dict[int, Told] = {}
        self._open: dict[int, Endpoint] = {}  # by the id of what the device sends; of a subscribed topic, by its own
        self._hears_again = False  # waits for its turn
        self._tasks = TaskThread("endpoints", 0)  # the protocol limits how many there are
        node = rospy.get_name()
        self._node = node
        self._remapped = {rosgraph.names.resolve_name(name, node) for name in rospy.names.get_mappings()}

    def tell(self, told: Told) -> None:
        """A known one stays as it is, a changed one is opened again, an impossible one is refused and logged."""
        key = _key(told)
        if self._told.get(key) == told:
            return
        self._told[key] = told
        self._tasks.do(lambda: self._join(key, told))

    def receive(self, topic_id: int, payload: bytes) -> None:
        """A message of the device; nothing happens for a topic that was refused, or that is not joined yet."""
        endpoint = self._open.get(topic_id)
        if endpoint is not None:
            endpoint.receive(payload)

    def hear_again(self) -> None:
        """To be called now and then: a setup is told only once, so that its publisher must not be missed."""
        if not self._hears_again:
            self._hears_again = True
            self._tasks.do(self._hear_again)

    def _hear_again(self) -> None:
        self._hears_again = False
        topics = [
            endpoint.subscription
            for key, endpoint in self._open.items()
            if isinstance(endpoint, SubscribedTopic) and _words(self._told[key])[2] == Setup._type
        ]
        hear_again(topics, self._master, time.monotonic())

    def _join(self, key: int, told: Told) -> None:
        old = self._open.pop(key, None)
        if old is not None:
            old.close()
        what, name, type_name = _words(told)
        try:
            reason = refusal(name, self._node, self._remapped, isinstance(told, DevicePublishes | DeviceServes))
            if reason:
                raise ValueError(f"{what} {reason}")
            endpoint = self._made(told)
        except (ValueError, rospy.ROSException, rospy.ServiceException) as error:
            _log.error("%s refused: %s", what, error)
            return
        self._open[key] = endpoint
        _log.info("%s (%s) joined, id %d", endpoint.name, type_name, key)

    def _made(self, told: Told) -> Endpoint:
        match told:
            case DevicePublishes(info) if info.message_type in self._taken:
                return TakenTopic(info, self._taken[info.message_type])
            case DevicePublishes(info):
                return PublishedTopic(info)
            case DeviceSubscribes(info):
                return SubscribedTopic(info, self._on_command)
            case DeviceServes(service):
                return ServedService(service, self._send)
            case DeviceCalls(service):
                return CalledService(service, self._send)


def _key(told: Told) -> int:
    match told:
        case DeviceServes(service):
            return service.answer_id
        case DeviceCalls(service):
            return service.request_id
    return told.info.topic_id


def _words(told: Told) -> tuple[str, str, str]:
    """Whether topic or service, its name, its type."""
    if isinstance(told, DeviceServes | DeviceCalls):
        return "service", told.info.name, told.info.service_type
    return "topic", told.info.topic_name, told.info.message_type
