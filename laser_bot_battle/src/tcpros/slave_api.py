"""What the master and other nodes may ask a node by XML-RPC (wiki.ros.org/ROS/Slave_API)."""

import os
from collections.abc import Callable
from typing import Any, Protocol

from laser_bot_battle.arrival import current, host_for
from laser_bot_battle.netlink import own_networks
from tcpros.publisher import Publisher
from tcpros.subscriber import Subscriber

Answer = tuple[int, str, Any]


class Served(Protocol):
    """The node as its Slave API sees it."""

    master_uri: str
    tcpros_address: tuple[str, int]

    def publishers(self) -> list[Publisher]: ...
    def subscribers(self) -> list[Subscriber]: ...
    def publisher_update(self, topic: str, publishers: list[str]) -> None: ...
    def shut_down(self, reason: str) -> None: ...


class SlaveApi:
    """`handle` answers one call with code (1 success, 0 failure, -1 the caller's error), text and value."""

    def __init__(self, node: Served) -> None:
        self._node = node
        self._methods: dict[str, Callable[..., Answer]] = {
            "getBusInfo": self._bus_info,
            "getBusStats": self._bus_stats,
            "getMasterUri": lambda: (1, "", node.master_uri),
            "getPid": lambda: (1, "", os.getpid()),
            "getPublications": self._publications,
            "getSubscriptions": self._subscriptions,
            "paramUpdate": lambda _key, _value: (-1, "not subscribed", 0),
            "publisherUpdate": self._publisher_update,
            "requestTopic": self._request_topic,
            "shutdown": self._shutdown,
        }

    def handle(self, method: str, arguments: tuple[Any, ...]) -> Answer:
        implementation = self._methods.get(method)
        if implementation is None:
            return -1, f"there is no method {method!r:.100}", 0
        if not arguments or not isinstance(arguments[0], str):
            return -1, "the first argument must be the caller's name", 0
        _, *rest = arguments
        try:
            return implementation(*rest)
        except TypeError:  # a wrong number of arguments, or values of other kinds
            return -1, f"{method} does not take these arguments", 0

    def _request_topic(self, topic: str, protocols: list[list[Any]]) -> Answer:
        if not any(publisher.topic == topic for publisher in self._node.publishers()):
            return -1, f"not a publisher of {topic!r:.100}", []
        if not any(isinstance(protocol, list) and protocol[:1] == ["TCPROS"] for protocol in protocols):
            return 0, "only TCPROS is spoken here", []
        host, port = self._node.tcpros_address
        host = host_for(host, current.get(), own_networks())
        return 1, f"ready on {host}:{port}", ["TCPROS", host, port]

    def _publisher_update(self, topic: str, publishers: list[str]) -> Answer:
        if not isinstance(publishers, list) or not all(isinstance(uri, str) for uri in publishers):
            return -1, "publishers must be a list of URIs", 0
        self._node.publisher_update(topic, publishers)
        return 1, "", 0

    def _shutdown(self, reason: str = "") -> Answer:
        self._node.shut_down(str(reason))
        return 1, "shutdown", 0

    def _publications(self) -> Answer:
        return 1, "publications", [[publisher.topic, publisher.spec.name] for publisher in self._node.publishers()]

    def _subscriptions(self) -> Answer:
        found = {subscriber.topic: subscriber.spec.name for subscriber in self._node.subscribers()}
        return 1, "subscriptions", [list(item) for item in found.items()]

    def _bus_info(self) -> Answer:
        lines: list[list[Any]] = []
        for publisher in self._node.publishers():
            for peer in publisher.peers():
                lines.append([peer.number, peer.callerid, "o", "TCPROS", publisher.topic, True, peer.info])
        for subscriber in self._node.subscribers():
            for uri, connection in subscriber.peers().items():
                lines.append([connection.number, uri, "i", "TCPROS", subscriber.topic, True, connection.info])
        return 1, "bus info", lines

    def _bus_stats(self) -> Answer:
        published = [
            [
                publisher.topic,
                publisher.published_bytes,
                [[peer.number, peer.sent_bytes, peer.sent_messages, True] for peer in publisher.peers()],
            ]
            for publisher in self._node.publishers()
        ]
        subscribed = [
            [
                subscriber.topic,
                [[peer.number, peer.received_bytes, -1, True] for peer in subscriber.peers().values()],
            ]
            for subscriber in self._node.subscribers()
        ]
        return 1, "", [published, subscribed, []]
