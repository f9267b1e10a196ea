"""advertise, unadvertise, publish (rosbridge protocol 3.2.1 to 3.2.3)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from server.rosbridge.capabilities.capability import Family, Handler
from server.rosbridge.conversion import MessageType
from server.rosbridge.drivers import is_command_topic
from server.rosbridge.effects import Effect, Publish
from server.rosbridge.gate import COMMAND_TYPE, PATIENCE
from server.rosbridge.names import resolve
from server.rosbridge.wire import Id, Request, RequestError

if TYPE_CHECKING:
    from server.rosbridge.protocol import Session

MOST_TOPICS = 100
# A held key publishes at 40 Hz; its owner need not read the same refusal as often.
REPEAT_REFUSAL = 1.0  # s


class Wish(NamedTuple):
    """What a client wants to advertise."""

    topic: str
    type_name: str
    latch: bool
    id: Id
    until: float  # it may wait for the news that the client has signed up; monotonic s


class Publishing(Family):
    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._advertised: dict[str, MessageType] = {}
        self._waiting: list[Wish] = []
        self._refused = ("", float("-inf"))  # reason and time of the last refused publish

    def handlers(self) -> Mapping[str, Handler]:
        return {"advertise": self.advertise, "unadvertise": self.unadvertise, "publish": self.publish}

    def advertise(self, request: Request, now: float) -> list[Effect]:
        topic, type_name = resolve(request.text("topic")), request.text("type")
        wish = Wish(topic, type_name, request.flag("latch"), request.id, now + PATIENCE)
        if self._refusal(wish) and self.session.is_newcomer() and len(self._waiting) < MOST_TOPICS:
            self._waiting.append(wish)
            return []
        return self._fulfil(wish)

    def updated(self, now: float) -> list[Effect]:
        if not self._waiting:
            return []
        is_newcomer = self.session.is_newcomer()
        due = [wish for wish in self._waiting if now >= wish.until or not is_newcomer]
        self._waiting = [wish for wish in self._waiting if wish not in due]
        effects: list[Effect] = []
        for wish in due:
            try:
                effects += self._fulfil(wish)
            except RequestError as error:
                effects += self.session.report("error", str(error), now, wish.id)
        return effects

    def unadvertise(self, request: Request, now: float) -> list[Effect]:
        topic = resolve(request.text("topic"))
        waiting = [wish for wish in self._waiting if wish.topic == topic]
        self._waiting = [wish for wish in self._waiting if wish.topic != topic]
        if self._advertised.pop(topic, None) is None:
            if waiting:
                return []
            return self.session.report("warning", f"{topic} is not advertised by this client", now, request.id)
        stops = [self.session.neutral(stopped) for stopped in self.session.drivers.left(self.session, topic)]
        return [*stops, *self.session.graph.unadvertise(self.session, topic)]

    def publish(self, request: Request, now: float) -> list[Effect]:
        topic = resolve(request.text("topic"))
        session = self.session
        if reason := session.gate.refuses_publishing(session.identity, topic, now):
            return self._refuse(reason, now)
        message_type = self._advertised.get(topic)
        opened: list[Effect] = []
        if message_type is None:
            message_type = self._type_of(topic)
            message = message_type.decode(request.fields.get("msg", {}), "")
            opened = self._advertise(topic, message_type, False)
        else:
            message = message_type.decode(request.fields.get("msg", {}), "")
        if message_type.name == COMMAND_TYPE:
            session.drivers.commanded(session, session.identity, topic, message)
        return [*opened, Publish(topic, message)]

    def closed(self) -> list[Effect]:
        stops = [self.session.neutral(topic) for topic in self.session.drivers.left(self.session)]
        closed = [
            effect for topic in self._advertised for effect in self.session.graph.unadvertise(self.session, topic)
        ]
        self._advertised.clear()
        return [*stops, *closed]

    def _refusal(self, wish: Wish) -> str:
        return self.session.gate.refuses_advertising(self.session.identity, wish.topic, wish.type_name)

    def _fulfil(self, wish: Wish) -> list[Effect]:
        if reason := self._refusal(wish):
            raise RequestError(reason)
        return self._advertise(wish.topic, self.session.types.message(wish.type_name), wish.latch)

    def _advertise(self, topic: str, message_type: MessageType, latch: bool) -> list[Effect]:
        if topic not in self._advertised and len(self._advertised) >= MOST_TOPICS:
            raise RequestError(f"a client may advertise {MOST_TOPICS} topics")
        effects = self.session.graph.advertise(self.session, topic, message_type, latch)
        self._advertised[topic] = message_type
        return effects

    def _type_of(self, topic: str) -> MessageType:
        """The type of a topic that this client has not advertised: it may have been refused that before the battle
        knew its player, and need not know."""
        known = self.session.graph.type_of(topic)
        if known is not None:
            return known
        if is_command_topic(topic):
            return self.session.types.message(COMMAND_TYPE)
        raise RequestError(f"{topic} must be advertised first, so that its type is known")

    def _refuse(self, reason: str, now: float) -> list[Effect]:
        last, told = self._refused
        if reason == last and now - told < REPEAT_REFUSAL:
            return []
        self._refused = (reason, now)
        raise RequestError(reason)
