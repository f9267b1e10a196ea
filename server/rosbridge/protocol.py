"""One client of rosbridge, by the rosbridge v2 protocol: requests in, effects out. No ROS, no socket, no clock.

Bad requests are answered by a status of level error, and change nothing.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial

from server.rosbridge.capabilities import CAPABILITIES
from server.rosbridge.capabilities.service_offers import ServiceOffers
from server.rosbridge.context import Context, TypeWantedError, UnsettledError
from server.rosbridge.effects import Effect, FindType, GoOn, Later, OpenSubscription, Read, Replay, Unpack
from server.rosbridge.large_requests import LARGE_TEXT
from server.rosbridge.stream import Found, RequestStream
from server.websocket.connection import MAX_MESSAGE, MAX_MESSAGE_OF_OTHERS
from server.websocket.requests import Request, RequestError, brief

# Requests of one client that wait for the types of their topics, or for its subscriptions.
MAX_WAITING = 1000
# What is not exactly one request is looked through bracket by bracket: so many characters of it in the event loop.
LONG_LOOK = 4 * 2**10
AT_ONCE = 16  # requests of one message that are carried out before others get their turn


@dataclass(eq=False)
class Client(Context):
    """One connected client."""

    def __post_init__(self) -> None:
        self._capabilities = [capability(self) for capability in CAPABILITIES]
        self._offers = next(each for each in self._capabilities if isinstance(each, ServiceOffers))
        self.handlers = {op: handler for each in self._capabilities for op, handler in each.handlers().items()}
        self._waiting: dict[str, list[Request]] = {}  # by topic, in order
        self._held: set[str] = set()  # the topics of those that wait for subscriptions
        self._gone = False
        self.stream = RequestStream(MAX_MESSAGE_OF_OTHERS, LARGE_TEXT)
        self._backlog: deque[Found] = deque()  # in the stream, to be carried out

    def receive(self, data: str | bytes, now: float) -> list[Effect]:
        """A WebSocket message has come from the client. Not while an earlier one's effect is Unpack, Read or GoOn."""
        whole = self.stream.whole(data)
        if whole is not None:
            return self._carry_out(whole, now)
        self.stream.limit = MAX_MESSAGE if self.identity.operator else MAX_MESSAGE_OF_OTHERS
        if len(data) > LONG_LOOK:
            return [Read(data)]
        self._backlog.extend(self.stream.feed(data))
        return self.go_on(now)

    def take(self, found: Iterable[Found], stream: RequestStream) -> None:
        """What was found in a message that took long, for `go_on`."""
        self._backlog.extend(found)
        self.stream = stream

    def go_on(self, now: float) -> list[Effect]:
        """Carry out what has been found, up to a long request, and not too many at once."""
        effects: list[Effect] = []
        for _ in range(min(AT_ONCE, len(self._backlog))):
            effects += self._carry_out(self._backlog.popleft(), now)
            if any(isinstance(effect, Unpack) for effect in effects):
                return effects
        return [*effects, GoOn()] if self._backlog else effects

    def _carry_out(self, found: Found, now: float) -> list[Effect]:
        try:
            if isinstance(found, str):
                return [Unpack(found)]
            if isinstance(found, RequestError):
                raise found
            request = Request(found)
        except RequestError as error:
            return self.report("error", str(error), now)
        return self.handle(request, now)

    def owed(self) -> dict[str, str]:
        """The types of the responses that the client is to give, by the id of the call."""
        return self._offers.owed()

    def asked(self, call: int, service: str, request: bytes, now: float) -> list[Effect]:
        """ROS calls a service that the client offers; the answer is the effect Answer with the same `call`."""
        return self._offers.asked(call, service, request, now)

    def forget_call(self, call: int, service: str) -> None:
        """Nobody waits for the answer to that call any more."""
        self._offers.forget(call, service)

    def updated(self, now: float) -> list[Effect]:
        """The battle has changed, or some time has passed."""
        return [effect for capability in self._capabilities for effect in capability.updated(now)]

    def closed(self) -> list[Effect]:
        """The client is gone: stop what it drove, close what it had open, once its last words are carried out."""
        self._gone = True
        if self._waiting:
            return [*self.drivers.stop(self)]
        return [effect for capability in self._capabilities for effect in capability.closed()]

    def handle(self, request: Request, now: float) -> list[Effect]:
        """Carry out one request."""
        try:
            if self._waiting and type(request.fields.get("topic")) is str:
                before = self._waiting.get(request.ros_name("topic"))
                if before is not None:
                    return self._wait(before, request)
            op = request.text("op")
            handler = self.handlers.get(op)
            if handler is None:
                raise RequestError(f"the operation {brief(op)} is unknown here")
            return handler(request, now)
        except RequestError as error:
            return self.report("error", str(error), now, request.id)
        except TypeWantedError as wanted:
            self._waiting[wanted.topic] = [request]
            if op == "subscribe":
                self.unsettled.add(wanted.topic)
            return [FindType(wanted.topic, partial(self._found, wanted.topic))]
        except UnsettledError as early:
            self._waiting[early.topic] = [request]
            self._held.add(early.topic)
            return [Later(partial(self._release, early.topic))]

    def settled(self, topic: str, now: float) -> list[Effect]:
        """The publishers of `topic` have its subscriber, or the client is not subscribed: now for what has waited."""
        self.unsettled.discard(topic)
        return [] if self.unsettled else [effect for held in tuple(self._held) for effect in self._release(held, now)]

    def _release(self, topic: str, now: float) -> list[Effect]:
        """What waits for subscriptions has waited long enough."""
        if topic not in self._held:
            return []
        self._held.remove(topic)
        others, self.unsettled = self.unsettled, set()
        effects = self._resume(topic, now)
        self.unsettled |= others
        return effects

    def _wait(self, before: list[Request], request: Request) -> list[Effect]:
        if len(before) >= MAX_WAITING:
            raise RequestError("too many requests about this topic wait already")
        before.append(request)
        return []

    def _found(self, topic: str, type_name: str | None, now: float) -> list[Effect]:
        """ROS has told the type of `topic`, or knows none: now for what has waited."""
        self.found[topic] = type_name
        effects = self._resume(topic, now)
        del self.found[topic]
        if topic in self.unsettled and not any(isinstance(effect, OpenSubscription | Replay) for effect in effects):
            effects += self.settled(topic, now)
        return effects

    def _resume(self, topic: str, now: float) -> list[Effect]:
        effects = [effect for request in self._waiting.pop(topic) for effect in self.handle(request, now)]
        return [*effects, *self.closed()] if self._gone else effects
