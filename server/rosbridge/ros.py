"""rosbridge's topics and services in ROS, on a node of its own event loop."""

import asyncio
import itertools
import logging
import struct
from collections.abc import Awaitable, Callable, Hashable, Mapping
from contextlib import suppress
from functools import partial
from pickle import PickleBuffer

from laser_bot_battle.master import MasterError
from server.messages.outside import Outside
from server.messages.types import MessageType, ServiceType, Types
from server.rosbridge.drivers import COMMAND_TOPICS
from server.rosbridge.effects import CallService, Response
from server.rosbridge.large_requests import Kept, packed_request
from server.websocket.requests import RequestError
from tcpros.clock import Clock
from tcpros.node import Node
from tcpros.publisher import Publisher
from tcpros.service import Service
from tcpros.specs import ServiceError, ServiceSpec, TypeSpec
from tcpros.subscriber import Subscriber

_log = logging.getLogger(__name__)

# A publisher outlives its last client, so that its last messages reach those who are just connecting to it, and a
# client that comes and goes costs the ROS master nothing. Upstream's rosbridge waits as long.
LINGER = 10.0  # s

# A publisher that cannot be reached keeps nobody waiting for longer.
SETTLING = 1.0  # s

_SEQ = struct.Struct("<I")

Deliver = Callable[[str, MessageType, bytes], None]  # (topic, type, serialized message)
Troubled = Callable[[str, str], None]  # (topic, why a publisher of it cannot be reached)


class TopicSubscriber:
    """One topic's subscriber."""

    def __init__(self, node: Node, topic: str, message_type: MessageType, deliver: Deliver, troubled: Troubled) -> None:
        self._topic, self._type, self._deliver = topic, message_type, deliver
        self._subscriber: Subscriber = node.subscribe(topic, type_spec(message_type), self._received)
        self._subscriber.on_trouble = partial(troubled, topic)

    async def settled(self) -> None:
        await self._subscriber.settled()

    def latched(self, ours: str) -> list[bytes]:
        """Without those of the node with the URI `ours`."""
        peers = self._subscriber.peers()
        return [peer.latched for uri, peer in peers.items() if uri != ours and peer.latched is not None]

    def troubles(self) -> list[str]:
        return self._subscriber.troubles()

    def close(self) -> None:
        self._subscriber.close()

    def _received(self, data: bytes, _: Mapping[str, str]) -> None:
        self._deliver(self._topic, self._type, data)


class TopicPublisher:
    """One topic's publisher, until its time after the last client is over."""

    def __init__(self, node: Node, topic: str, message_type: MessageType, latch: bool) -> None:
        self.terms = (message_type.name, latch)
        self.closing: asyncio.TimerHandle | None = None
        self._has_header = bool(message_type.message_class._has_header)
        self._numbers = itertools.count(1)
        self._publisher: Publisher = node.advertise(
            topic, type_spec(message_type), latch=latch, latest=topic in COMMAND_TOPICS
        )

    def publish(self, data: bytes, source: Hashable) -> None:
        if self._has_header:  # which begins with the message's number, for the publisher to count
            data = _SEQ.pack(next(self._numbers) & 0xFFFFFFFF) + data[_SEQ.size :]
        self._publisher.publish(data, source)

    def unlatch(self, source: Hashable) -> None:
        self._publisher.unlatch(source)

    def orphan(self) -> None:
        self._publisher.orphan()

    def latched(self) -> list[bytes]:
        return self._publisher.latched()

    def close(self) -> None:
        self._publisher.close()


class Ros:
    """All that rosbridge has open. For the event loop's thread; nothing blocks."""

    def __init__(
        self, node: Node, types: Types, clock: Clock, outside: Outside, *, deliver: Deliver, troubled: Troubled
    ) -> None:
        self._node, self._types, self._clock, self._outside = node, types, clock, outside
        self._deliver, self._troubled = deliver, troubled
        self._loop = asyncio.get_running_loop()
        self._publishers: dict[str, TopicPublisher] = {}
        self._subscribers: dict[str, TopicSubscriber] = {}
        self._services: dict[str, Service] = {}

    def open_publisher(self, topic: str, message_type: MessageType, latch: bool) -> None:
        lingering = self._publishers.get(topic)
        if lingering is not None and lingering.closing is not None:
            lingering.closing.cancel()
            lingering.closing = None
            if lingering.terms == (message_type.name, latch):
                return
            lingering.close()
        self._publishers[topic] = TopicPublisher(self._node, topic, message_type, latch)

    def publish(self, topic: str, data: bytes, source: Hashable) -> None:
        """`source`: whose last message it is, for a topic that latches."""
        self._publishers[topic].publish(data, source)

    def unlatch(self, topic: str, source: Hashable) -> None:
        """That source's last message goes with it; others still publish."""
        self._publishers[topic].unlatch(source)

    def close_publisher(self, topic: str) -> None:
        self._publishers[topic].orphan()
        self._publishers[topic].closing = self._loop.call_later(LINGER, self._close_publisher, topic)

    def open_subscription(self, topic: str, message_type: MessageType) -> None:
        self._subscribers[topic] = TopicSubscriber(self._node, topic, message_type, self._deliver, self._troubled)

    async def settled(self, topic: str) -> None:
        """Wait until the publishers of an open topic have this subscriber, as far as they answer in time."""
        if topic in self._subscribers:
            with suppress(TimeoutError):
                async with asyncio.timeout(SETTLING):
                    await self._subscribers[topic].settled()

    def latched(self, topic: str) -> list[bytes]:
        """The newest messages of an open topic's latching publishers, and of each of our own clients."""
        ours = self._publishers.get(topic)
        return [*self._subscribers[topic].latched(self._node.uri), *(ours.latched() if ours else ())]

    def troubles(self, topic: str) -> list[str]:
        """Why publishers of an open topic are not connected."""
        return self._subscribers[topic].troubles()

    def close_subscription(self, topic: str) -> None:
        self._subscribers.pop(topic).close()

    def open_service(self, service: str, service_type: ServiceType, ask: Callable[[bytes], Awaitable[bytes]]) -> None:
        """Calls of `service` are answered by `ask`."""
        self._services[service] = self._node.serve(service, ServiceSpec(service_type.name, service_type.md5sum), ask)

    def close_service(self, service: str) -> None:
        self._services.pop(service).close()

    async def type_of(self, topic: str) -> str | None:
        """The type of a topic that somebody else in ROS publishes or subscribes to now; None when nobody does, or the
        master does not answer. (The master alone remembers types of topics long gone.)"""
        try:
            publishers, subscribers, _ = await self._node.master("getSystemState")
            nodes = {node for name, who in [*publishers, *subscribers] if name == topic for node in who}
            if not nodes - {self._node.name}:
                return None
            types: dict[str, str] = dict(await self._node.master("getTopicTypes"))
        except (OSError, MasterError, TypeError, ValueError) as error:
            _log.warning("the ROS master does not tell the type of %s: %s", topic, error)
            return None
        found = types.get(topic, "*")
        return None if found == "*" else found

    async def call(self, call: CallService) -> Response:
        """The response; RequestError says why there is none."""
        found: list[ServiceType] = []

        async def make_request(header: Mapping[str, str]) -> bytes:
            service_type = self._types.service(header.get("type", ""))
            if header.get("md5sum") != service_type.md5sum:
                raise RequestError(f"the service has another version of {service_type.name} than rosbridge")
            found.append(service_type)
            if type(call.args) is not Kept:
                return service_type.pack_request(call.args, self._clock.now)
            args, now = PickleBuffer(call.args.data), self._clock.nanoseconds()
            return await self._outside.make(packed_request, service_type.name, args, now)

        try:
            data, _ = await self._node.call(call.service, make_request, call.timeout)
        except (ServiceError, RuntimeError) as error:
            raise RequestError(str(error)) from None
        return Response(found[0].response, data)

    def _close_publisher(self, topic: str) -> None:
        self._publishers.pop(topic).close()


def type_spec(message_type: MessageType) -> TypeSpec:
    return TypeSpec(message_type.name, message_type.md5sum, message_type.definition)
