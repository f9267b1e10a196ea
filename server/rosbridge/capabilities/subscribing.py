"""subscribe, unsubscribe (rosbridge protocol 3.2.4, 3.2.5)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from server.rosbridge.capabilities.capability import Family, Handler
from server.rosbridge.effects import Effect
from server.rosbridge.gate import STATUS_TOPIC, STATUS_TYPE
from server.rosbridge.names import resolve
from server.rosbridge.subscription import Subscription
from server.rosbridge.wire import Request, RequestError, brief

if TYPE_CHECKING:
    from server.rosbridge.protocol import Session

MOST_TOPICS = 100
MOST_REQUESTS = 100  # for one topic
LONGEST_QUEUE = 1000


class Subscribing(Family):
    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._subscriptions: dict[str, Subscription] = {}

    def handlers(self) -> Mapping[str, Handler]:
        return {"subscribe": self.subscribe, "unsubscribe": self.unsubscribe}

    def subscribe(self, request: Request, _now: float) -> list[Effect]:
        topic, type_name = resolve(request.text("topic")), request.optional_text("type", "")
        throttle, queue_length = request.number("throttle_rate", 0) / 1000, request.count("queue_length", 0)
        compression = request.optional_text("compression", "none")
        if compression != "none":
            raise RequestError(f"compression {brief(compression)} is not supported, only none")
        request.count("fragment_size", 0)
        if reason := self.session.gate.refuses_subscribing(self.session.identity, topic, type_name):
            raise RequestError(reason)
        subscription = self._subscriptions.get(topic)
        effects: list[Effect] = []
        if subscription is None:
            effects, subscription = self._join(topic, type_name, request.text("topic"))
        elif subscription.requests >= MOST_REQUESTS:
            raise RequestError(f"a client may subscribe {MOST_REQUESTS} times to {topic}")
        subscription.add(request.id, throttle, min(queue_length, LONGEST_QUEUE))
        return effects

    def unsubscribe(self, request: Request, now: float) -> list[Effect]:
        topic = resolve(request.text("topic"))
        subscription = self._subscriptions.get(topic)
        if subscription is None or (request.id is not None and not subscription.has(request.id)):
            return self.session.report("warning", f"{topic} is not subscribed to under this id", now, request.id)
        if request.id is not None and not subscription.remove(request.id):
            return []
        del self._subscriptions[topic]
        return self.session.graph.unsubscribe(self.session, topic)

    def closed(self) -> list[Effect]:
        topics = list(self._subscriptions)
        self._subscriptions.clear()
        return [effect for topic in topics for effect in self.session.graph.unsubscribe(self.session, topic)]

    def _join(self, topic: str, type_name: str, name: str) -> tuple[list[Effect], Subscription]:
        if len(self._subscriptions) >= MOST_TOPICS:
            raise RequestError(f"a client may subscribe to {MOST_TOPICS} topics")
        message_type = self.session.graph.type_of(topic)
        if type_name or topic == STATUS_TOPIC:
            message_type = self.session.types.message(type_name or STATUS_TYPE)
        if message_type is None:
            raise RequestError(f"the type of {topic} is not known; give it in the field 'type'")
        subscription = Subscription(self.session, name)
        effects = self.session.graph.subscribe(topic, message_type, subscription)
        self._subscriptions[topic] = subscription
        return effects, subscription
