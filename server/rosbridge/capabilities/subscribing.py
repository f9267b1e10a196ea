"""subscribe, unsubscribe (rosbridge protocol 3.2.4, 3.2.5)."""

from collections.abc import Mapping

from server.rosbridge.capabilities.capability import Capability, Handler, compression, fragment_size
from server.rosbridge.compression import COMPRESSIONS
from server.rosbridge.context import Context
from server.rosbridge.effects import Effect, Replay
from server.rosbridge.subscription import Subscription, Terms
from server.websocket.requests import Request, RequestError

MAX_TOPICS = 1000
MAX_REQUESTS = 100  # for one topic
MAX_QUEUE_LENGTH = 1000


class Subscribing(Capability):
    def __init__(self, client: Context) -> None:
        super().__init__(client)
        self._subscriptions: dict[str, Subscription] = {}

    def handlers(self) -> Mapping[str, Handler]:
        return {"subscribe": self.subscribe, "unsubscribe": self.unsubscribe}

    def subscribe(self, request: Request, _now: float) -> list[Effect]:
        topic, type_name = request.ros_name("topic"), request.ros_type("")
        terms = Terms(
            request.number("throttle_rate", 0) / 1000,
            min(request.count("queue_length", 0), MAX_QUEUE_LENGTH),
            compression(request, COMPRESSIONS),
            fragment_size(request),
        )
        if reason := self.client.gate.refuses_subscribing(self.client.identity, topic, type_name):
            raise self.client.gate.refusal("subscribe", reason)
        subscription = self._subscriptions.get(topic)
        # a page may have several parts that each wait for a latched message
        effects: list[Effect] = [Replay(topic)]
        if subscription is None:
            effects, subscription = self._open(topic, type_name, request.text("topic"))
        elif subscription.requests >= MAX_REQUESTS:
            raise RequestError(f"a client may subscribe {MAX_REQUESTS} times to {topic}")
        else:
            self.client.topic_type(topic, type_name)
        subscription.add(request.id, terms)
        return effects

    def unsubscribe(self, request: Request, now: float) -> list[Effect]:
        topic = request.ros_name("topic")
        subscription = self._subscriptions.get(topic)
        if subscription is None or (request.id is not None and not subscription.has(request.id)):
            return self.client.report("warning", f"{topic} is not subscribed to under this id", now, request.id)
        if request.id is not None and not subscription.remove(request.id):
            return []
        del self._subscriptions[topic]
        return self.client.graph.unsubscribe(self.client, topic)

    def closed(self) -> list[Effect]:
        topics = list(self._subscriptions)
        self._subscriptions.clear()
        return [effect for topic in topics for effect in self.client.graph.unsubscribe(self.client, topic)]

    def _open(self, topic: str, type_name: str, name: str) -> tuple[list[Effect], Subscription]:
        if len(self._subscriptions) >= MAX_TOPICS:
            raise RequestError(f"a client may subscribe to {MAX_TOPICS} topics")
        message_type = self.client.topic_type(topic, type_name)
        subscription = Subscription(self.client, name)
        effects = self.client.graph.subscribe(topic, message_type, subscription)
        self._subscriptions[topic] = subscription
        self.client.unsettled.add(topic)
        return effects, subscription
