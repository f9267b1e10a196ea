"""advertise, unadvertise, publish (rosbridge protocol 3.2.1 to 3.2.3)."""

from collections.abc import Mapping
from typing import NamedTuple

from server.access.identity import SIGN_UP_GRACE
from server.messages.types import MessageType
from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.context import Context, TypeWantedError, UnsettledError
from server.rosbridge.drivers import COMMAND_TOPICS
from server.rosbridge.effects import Effect, Publish
from server.rosbridge.large_requests import serialized
from server.websocket.requests import Id, Request, RequestError

MAX_TOPICS = 1000
MAX_WAITING = 100  # topics that a newcomer has advertised too early
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
        self._used: set[str] = set()  # topics on which it has published
        self._waiting: list[Advertisement] = []
        self._refused = ("", float("-inf"))  # reason and time of the last refused publish

    def handlers(self) -> Mapping[str, Handler]:
        return {"advertise": self.advertise, "unadvertise": self.unadvertise, "publish": self.publish}

    def advertise(self, request: Request, now: float) -> list[Effect]:
        topic, type_name = request.ros_name("topic"), request.ros_type()
        # a robot must never act on an old command
        latch = request.flag("latch") and topic not in COMMAND_TOPICS
        wanted = Advertisement(topic, type_name, latch, request.id, now + SIGN_UP_GRACE)
        if self._refusal(wanted) and self.client.is_newcomer() and len(self._waiting) < MAX_WAITING:
            self._waiting.append(wanted)
            return []
        return self._decide(wanted)

    def updated(self, now: float) -> list[Effect]:
        if not self._waiting:
            return []
        is_newcomer = self.client.is_newcomer()
        due = self._waiting if not is_newcomer else [wanted for wanted in self._waiting if now >= wanted.until]
        self._waiting = [wanted for wanted in self._waiting if is_newcomer and now < wanted.until]
        effects: list[Effect] = []
        for wanted in due:
            try:
                effects += self._decide(wanted)
            except RequestError as error:
                effects += self.client.report("error", str(error), now, wanted.id)
            except TypeWantedError:  # an operator by now, who may say it again
                text = f"{wanted.topic} was advertised before you signed in: advertise it again"
                effects += self.client.report("error", text, now, wanted.id)
        return effects

    def unadvertise(self, request: Request, now: float) -> list[Effect]:
        topic = request.ros_name("topic")
        waiting = len(self._waiting)
        self._waiting = [wanted for wanted in self._waiting if wanted.topic != topic]
        if self._advertised.pop(topic, None) is not None:
            self._used.discard(topic)
            return [*self.client.drivers.stop(self.client, topic), *self.client.graph.unadvertise(self.client, topic)]
        if len(self._waiting) < waiting:
            return []
        return self.client.report("warning", f"{topic} is not advertised by this client", now, request.id)

    def publish(self, request: Request, now: float) -> list[Effect]:
        topic, client = request.ros_name("topic"), self.client
        if reason := client.gate.refuses_publishing(client.identity, topic, now):
            return self._refuse(reason, now)
        # an answer to it could come before the client hears it; a stream that runs already must not stop for that
        if client.unsettled and topic not in self._used and topic not in COMMAND_TOPICS:
            raise UnsettledError(topic)
        message_type = self._advertised.get(topic)
        # a client may publish what it has not advertised: it may have been refused that before the gate knew its player
        opened: list[Effect] = []
        shots: list[Publish] = []
        if message_type is None:
            message_type = client.topic_type(topic, request.ros_type(""))
        data = serialized(message_type, request.fields.get("msg", {}), client.clock.now)
        if topic in COMMAND_TOPICS:
            client.gate.check_command(client.identity, data)
            data = client.gate.granted(client.identity, data)
            client.drivers.commanded(client, client.identity, topic, data)
            shots = client.drivers.shots.commanded(topic, data, client.gate.coded, now)
        if topic not in self._advertised:
            opened = self._advertise(topic, message_type, request.flag("latch") and topic not in COMMAND_TOPICS)
        self._used.add(topic)
        return [*opened, Publish(topic, data), *shots]

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
            raise self.client.gate.refusal("advertise", reason)
        return self._advertise(wanted.topic, self.client.topic_type(wanted.topic, wanted.type_name), wanted.latch)

    def _advertise(self, topic: str, message_type: MessageType, latch: bool) -> list[Effect]:
        if topic not in self._advertised and len(self._advertised) >= MAX_TOPICS:
            raise RequestError(f"a client may advertise {MAX_TOPICS} topics")
        effects = self.client.graph.advertise(self.client, topic, message_type, latch)
        self._advertised[topic] = message_type
        return effects

    def _refuse(self, reason: str, now: float) -> list[Effect]:
        refusal = self.client.gate.refusal("publish", reason)
        last, told = self._refused
        if reason == last and now - told < REPEAT_REFUSAL:
            return []
        self._refused = (reason, now)
        raise refusal
