"""One client's conversation by the rosbridge v2 protocol: requests in, effects out. No ROS, no socket, no clock.

Bad requests are answered by a status of level error, and change nothing.
"""

import logging

from server.rosbridge.capabilities import FAMILIES
from server.rosbridge.conversion import Types
from server.rosbridge.drivers import Drivers
from server.rosbridge.effects import Effect, Log, Publish, Send
from server.rosbridge.gate import COMMAND_TYPE, Claim, Gate, Identity
from server.rosbridge.graph import Graph
from server.rosbridge.wire import Id, Request, RequestError, brief, parse, status

SEVERITY = {"none": 0, "error": 1, "warning": 2, "info": 3}
LOG_LEVELS = {"error": logging.WARNING, "warning": logging.INFO, "info": logging.INFO}
# A client that sends nonsense must not fill the operator's log.
MOST_LINES = 5  # a second


class Session:
    """One connected client. Time is a monotonic clock in s."""

    def __init__(self, gate: Gate, drivers: Drivers, graph: Graph, types: Types, identity: Identity) -> None:
        self.gate = gate
        self.drivers = drivers
        self.graph = graph
        self.types = types
        self.identity = identity
        self.claim: Claim | None = None  # to be somebody else; under examination
        self.level = "error"  # the client wants to hear this and worse
        self._lines, self._lines_since = 0, float("-inf")
        self._families = [family(self) for family in FAMILIES]
        self._handlers = {op: handler for family in self._families for op, handler in family.handlers().items()}

    def receive(self, text: str | bytes, now: float) -> list[Effect]:
        """A WebSocket message has come from the client."""
        request_id: Id = None
        try:
            request = Request(parse(text))
            request_id = request.id
            op = request.text("op")
            handler = self._handlers.get(op)
            if handler is None:
                raise RequestError(f"the operation {brief(op)} is unknown here")
            return handler(request, now)
        except RequestError as error:
            return self.report("error", str(error), now, request_id)

    def updated(self, now: float) -> list[Effect]:
        """The battle has changed, or some time has passed."""
        return [effect for family in self._families for effect in family.updated(now)]

    def closed(self) -> list[Effect]:
        """The client is gone: stop what it drove, close what it had open."""
        return [effect for family in self._families for effect in family.closed()]

    def is_newcomer(self) -> bool:
        """Whether the news of this client's signing up may be on its way."""
        return self.claim is not None or (bool(self.identity.session) and self.gate.player(self.identity) is None)

    def report(self, level: str, text: str, now: float, request_id: Id = None) -> list[Effect]:
        """Tell client and operator; `level` is error, warning or info."""
        wanted = SEVERITY[level] <= SEVERITY[self.level]
        told: list[Effect] = [Send(status(level, text, request_id))] if wanted else []
        return [*self.log(Log(LOG_LEVELS[level], text), now), *told]

    def log(self, line: Log, now: float) -> list[Effect]:
        """That line for the operator, unless this client has caused too many of late."""
        if now - self._lines_since >= 1:
            self._lines, self._lines_since = 0, now
        self._lines += 1
        if self._lines < MOST_LINES:
            return [line]
        if self._lines == MOST_LINES:
            return [line, Log(line.level, "further lines about this client are left out for a second")]
        return []

    def neutral(self, topic: str) -> Publish:
        """The command that stops the robot of this command topic."""
        return neutral(topic, self.types)


def neutral(topic: str, types: Types) -> Publish:
    """The command that stops the robot of this command topic: neither moving nor shooting."""
    return Publish(topic, types.message(COMMAND_TYPE).message_class(0, 0, False))
