"""What the operations of one client work with."""

import logging
from dataclasses import dataclass, field
from typing import NamedTuple

from server.rosbridge.conversion import Types
from server.rosbridge.drivers import Drivers
from server.rosbridge.effects import Effect, Log, Send
from server.rosbridge.gate import Gate, Identity
from server.rosbridge.graph import Graph
from server.rosbridge.wire import Id, status

SEVERITY = {"error": 1, "warning": 2, "info": 3, "none": 0}
LOG_LEVELS = {"error": logging.WARNING, "warning": logging.INFO, "info": logging.INFO}
# A client that sends nonsense must not fill the operator's log.
MAX_LOG_LINES = 5  # a second
# A client that has just signed up may be quicker here than the news of it on /game_status.
SIGN_UP_GRACE = 2.0  # s


class Claim(NamedTuple):
    """A name with a token that the gate does not know yet."""

    name: str
    identity: Identity
    id: Id  # of the request
    until: float  # monotonic s


@dataclass(eq=False)
class Context:
    """A client as its operations see it. Time is a monotonic clock in s."""

    gate: Gate
    drivers: Drivers
    graph: Graph
    types: Types
    identity: Identity
    claim: Claim | None = field(default=None, init=False)  # to be somebody else
    status_level: str = field(default="error", init=False)  # the client wants to hear this and worse
    _lines: int = field(default=0, init=False)
    _lines_since: float = field(default=float("-inf"), init=False)

    def is_newcomer(self) -> bool:
        """Whether the news of this client's signing up may be on its way."""
        return self.claim is not None or (bool(self.identity.session) and self.gate.player(self.identity) is None)

    def report(self, level: str, text: str, now: float, request_id: Id = None) -> list[Effect]:
        """Tell client and operator; `level` is error, warning or info."""
        wanted = SEVERITY[level] <= SEVERITY[self.status_level]
        told: list[Effect] = [Send(status(level, text, request_id))] if wanted else []
        return [*self.log(Log(LOG_LEVELS[level], text), now), *told]

    def log(self, line: Log, now: float) -> list[Effect]:
        """That line for the operator, unless this client has caused too many of late."""
        if now - self._lines_since >= 1:
            self._lines, self._lines_since = 0, now
        self._lines += 1
        if self._lines < MAX_LOG_LINES:
            return [line]
        if self._lines == MAX_LOG_LINES:
            return [line, Log(line.level, "further lines about this client are left out for a second")]
        return []
