"""advertise, unadvertise, publish (rosbridge protocol 3.2.1 to 3.2.3)."""

from collections.abc import Mapping
from typing import NamedTuple

from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.context import SIGN_UP_GRACE, Context
from server.rosbridge.conversion import MessageType
from server.rosbridge.drivers import COMMAND_TOPICS
from server.rosbridge.effects import Effect, Publish
from server.rosbridge.gate import COMMAND_TYPE
from server.rosbridge.wire import Id, Request, RequestError

MAX_TOPICS = 100
# A held key publishes at 40 Hz; its owner need not read the same refusal as often.
REPEAT_REFUSAL = 1.0  # s


class Advertisement(NamedTuple):
    """What a client wants to advertise."""

    topic: str
    type_name: str
    latch: bool
    id: Id
    until: float  # it may wait for the news that the client has signed up; monotonic s


class Publishing(Capability):
    def __init__(self, client: Context) -> None:
        super().__init__(client)
        self._advertised: dict[str, MessageType] = {}
        self._waiting: list[Advertisement] = []
        self._refused = ("", float("-inf"))  # reason and time of the last refused publish

    def handlers(self) -> Mapping[str, Handler]:
        return {"advertise": self.advertise, "unadvertise": self.unadvertise, "publish": self.publish}

    def advertise(self, request: Request, now: float) -> list[Effect]:
        topic, type_name = request.ros_name("topic"), request.text("type")
        wanted = Advertisement(topic, type_name, request.flag("latch"), request.id, now + SIGN_UP_GRACE)
        if self._refusal(wanted) and self.client.is_newcomer() and len(self._waiting) < MAX_TOPICS:
            self._waiting.append(wanted)
            return []
        return self._decide(wanted)

    def updated(self, now: float) -> list[Effect]:
        if not self._waiting:
            return []
        is_newcomer = self.client.is_newcomer()
        due = [wanted for wanted in self._waiting if now >= wanted.until or not is_newcomer]
        self._waiting = [wanted for wanted in self._waiting if wanted not in due]
        effects: list[Effect] = []
        for wanted in due:
            try:
                effects += self._decide(wanted)
            except RequestError as error:
                effects += self.client.report("error", str(error), now, wanted.id)
        return effects

    def unadvertise(self, request: Request, now: float) -> list[Effect]:
        topic = request.ros_name("topic")
        waiting = len(self._waiting)
        self._waiting = [wanted for wanted in self._waiting if wanted.topic != topic]
        if self._advertised.pop(topic, None) is not None:
            return [*self.client.drivers.stop(self.client, topic), *self.client.graph.unadvertise(self.client, topic)]
        if len(self._waiting) < waiting:
            return []
        return self.client.report("warning", f"{topic} is not advertised by this client", now, request.id)

    def publish(self, request: Request, now: float) -> list[Effect]:
        topic, client = request.ros_name("topic"), self.client
        if reason := client.gate.refuses_publishing(client.identity, topic, now):
            return self._refuse(reason, now)
        message_type = self._advertised.get(topic) or self._type_of(topic)
        message = message_type.decode(request.fields.get("msg", {}), "")
        opened = [] if topic in self._advertised else self._advertise(topic, message_type, False)
        if message_type.name == COMMAND_TYPE:
            client.drivers.commanded(client, client.identity, topic, message)
        return [*opened, Publish(topic, message)]

    def closed(self) -> list[Effect]:
        effects: list[Effect] = [*self.client.drivers.stop(self.client)]
        for topic in self._advertised:
            effects += self.client.graph.unadvertise(self.client, topic)
        self._advertised.clear()
        return effects

    def _refusal(self, wanted: Advertisement) -> str:
        return self.client.gate.refuses_advertising(self.client.identity, wanted.topic, wanted.type_name)

    def _decide(self, wanted: Advertisement) -> list[Effect]:
        if reason := self._refusal(wanted):
            raise RequestError(reason)
        return self._advertise(wanted.topic, self.client.types.message(wanted.type_name), wanted.latch)

    def _advertise(self, topic: str, message_type: MessageType, latch: bool) -> list[Effect]:
        if topic not in self._advertised and len(self._advertised) >= MAX_TOPICS:
            raise RequestError(f"a client may advertise {MAX_TOPICS} topics")
        effects = self.client.graph.advertise(self.client, topic, message_type, latch)
        self._advertised[topic] = message_type
        return effects

    def _type_of(self, topic: str) -> MessageType:
        """The type of a topic that this client has not advertised: it may have been refused that before the gate
        knew its player, and need not know."""
        known = self.client.graph.type_of(topic)
        if known is not None:
            return known
        if topic in COMMAND_TOPICS:
            return self.client.types.message(COMMAND_TYPE)
        raise RequestError(f"{topic} must be advertised first, so that its type is known")

    def _refuse(self, reason: str, now: float) -> list[Effect]:
        last, told = self._refused
        if reason == last and now - told < REPEAT_REFUSAL:
            return []
        self._refused = (reason, now)
        raise RequestError(reason)
