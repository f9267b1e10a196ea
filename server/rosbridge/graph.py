"""What rosbridge has open in ROS, and for whom: one publisher and one subscriber a topic for all clients, and services,
each of one client."""

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field

from server.messages.types import MessageType
from server.rosbridge.effects import (
    ClosePublisher,
    CloseSubscription,
    Effect,
    OpenPublisher,
    OpenSubscription,
    Replay,
    Unlatch,
)
from server.rosbridge.subscription import Subscription
from server.websocket.requests import RequestError


@dataclass(slots=True)
class Topic:
    """One open topic."""

    type: MessageType
    publishers: set[Hashable] = field(default_factory=set)
    subscriptions: dict[Hashable, Subscription] = field(default_factory=dict)


class Graph:
    """Clients are any hashable objects; the topics' types are fixed while anybody uses them."""

    def __init__(self) -> None:
        self._topics: dict[str, Topic] = {}
        self._services: dict[str, Hashable] = {}

    def offer(self, client: Hashable, service: str) -> Hashable | None:
        """`client` will answer calls, in place of the one that is returned, if any: a page that was loaded again must
        not wait until its old connection is found to be dead."""
        before = self._services.get(service)
        self._services[service] = client
        return before

    def withdraw(self, service: str) -> None:
        del self._services[service]

    def type_of(self, topic: str) -> MessageType | None:
        """The type of an open topic."""
        open_topic = self._topics.get(topic)
        return open_topic.type if open_topic else None

    def types(self) -> dict[str, str]:
        """Names of the types of all open topics."""
        return {topic: opened.type.name for topic, opened in self._topics.items()}

    def subscriptions(self, topic: str) -> Iterable[Subscription]:
        open_topic = self._topics.get(topic)
        return open_topic.subscriptions.values() if open_topic else ()

    def advertise(self, client: Hashable, topic: str, message_type: MessageType, latch: bool) -> list[Effect]:
        """`client` will publish. Whether the topic is latched is the first client's choice. RequestError when the topic
        is open with another type."""
        publishers = self._open(topic, message_type).publishers
        first = not publishers
        publishers.add(client)
        return [OpenPublisher(topic, message_type, latch)] if first else []

    def unadvertise(self, client: Hashable, topic: str) -> list[Effect]:
        open_topic = self._topics[topic]
        open_topic.publishers.remove(client)
        self._forget_unused(topic, open_topic)
        return [Unlatch(topic) if open_topic.publishers else ClosePublisher(topic)]

    def subscribe(self, topic: str, message_type: MessageType, subscription: Subscription) -> list[Effect]:
        """`subscription.client` gets the topic's messages, from a latched one on."""
        subscriptions = self._open(topic, message_type).subscriptions
        first = not subscriptions
        subscriptions[subscription.client] = subscription
        return [OpenSubscription(topic, message_type) if first else Replay(topic)]

    def unsubscribe(self, client: Hashable, topic: str) -> list[Effect]:
        open_topic = self._topics[topic]
        open_topic.subscriptions.pop(client).end()
        self._forget_unused(topic, open_topic)
        return [] if open_topic.subscriptions else [CloseSubscription(topic)]

    def _open(self, topic: str, message_type: MessageType) -> Topic:
        open_topic = self._topics.setdefault(topic, Topic(message_type))
        if open_topic.type is not message_type:
            raise RequestError(f"{topic} is of type {open_topic.type.name}, not {message_type.name}")
        return open_topic

    def _forget_unused(self, topic: str, open_topic: Topic) -> None:
        if not open_topic.publishers and not open_topic.subscriptions:
            del self._topics[topic]
