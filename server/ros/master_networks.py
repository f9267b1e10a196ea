"""The ROS master's answers for callers of several networks: each is told where it can reach the nodes that are here."""

import threading
from collections.abc import Sequence
from typing import Any

from rosmaster.master_api import ROSMasterHandler

from laser_bot_battle.arrival import Arrival, current, uri_for
from laser_bot_battle.netlink import own_networks

MAX_URI = 256  # characters
MAX_ARRIVALS = 10_000  # of subscribers, which anybody may register; the oldest are forgotten

Answer = tuple[int, str, Any]


class NetworksHandler(ROSMasterHandler):  # type: ignore[misc]
    """As rosmaster's, whose names its methods have. What it keeps are the nodes' own URIs."""

    def __init__(self, workers: int) -> None:
        super().__init__(workers)
        self._arrivals: dict[str, Arrival | None] = {}  # by the subscriber's URI
        self._arrivals_lock = threading.Lock()

    def lookupNode(self, caller_id: str, node_name: str) -> Answer:  # noqa: N802
        code, text, uri = super().lookupNode(caller_id, node_name)
        return code, text, uri_for(uri, current.get(), own_networks())

    def lookupService(self, caller_id: str, service: str) -> Answer:  # noqa: N802
        code, text, uri = super().lookupService(caller_id, service)
        return code, text, uri_for(uri, current.get(), own_networks())

    def registerSubscriber(  # noqa: N802
        self, caller_id: str, topic: str, topic_type: str, caller_api: str
    ) -> Answer:
        self._remember(caller_api, current.get())
        code, text, publishers = super().registerSubscriber(caller_id, topic, topic_type, caller_api)
        own = own_networks()
        return code, text, [uri_for(uri, current.get(), own) for uri in publishers]

    def _notify_topic_subscribers(self, topic: str, pub_uris: Sequence[str], sub_uris: Sequence[str]) -> None:
        """rosmaster's: tell the subscribers who publishes now."""
        own = own_networks()
        for subscriber in sub_uris:
            with self._arrivals_lock:
                arrival = self._arrivals.get(subscriber)
            publishers = [uri_for(uri, arrival, own) for uri in pub_uris]
            super()._notify_topic_subscribers(topic, publishers, [subscriber])

    def _remember(self, subscriber: Any, arrival: Arrival | None) -> None:
        if not isinstance(subscriber, str) or len(subscriber) > MAX_URI:
            return  # it is refused, or told as everybody
        with self._arrivals_lock:
            self._arrivals.pop(subscriber, None)
            self._arrivals[subscriber] = arrival
            if len(self._arrivals) > MAX_ARRIVALS:
                del self._arrivals[next(iter(self._arrivals))]
