"""What the operations of one client work with."""

import logging
from abc import ABC, abstractmethod
from dataclasses import dataclass, field

from laser_bot_battle.names import GAME_STATUS
from server.access.identity import Claim, Identity
from server.messages.types import MessageType, Types
from server.rosbridge.drivers import COMMAND_TOPICS, Drivers
from server.rosbridge.effects import Effect, Log, Send
from server.rosbridge.gate import COMMAND_TYPE, STATUS_TYPE, Gate
from server.rosbridge.graph import Graph
from server.websocket.requests import Id, Request, RequestError, status
from tcpros.clock import Clock

SEVERITY = {"error": 1, "warning": 2, "info": 3, "none": 0}
LOG_LEVELS = {"error": logging.WARNING, "warning": logging.INFO, "info": logging.INFO}
# A client that sends nonsense must not fill the operator's log.
MAX_LOG_LINES = 5  # a second
# The game's own topics are driven by without a word with the ROS master.
OWN_TYPES = {GAME_STATUS: STATUS_TYPE, **dict.fromkeys(COMMAND_TOPICS, COMMAND_TYPE)}


class TypeWantedError(Exception):
    """The request cannot go on before ROS has been asked for the type of a topic."""

    def __init__(self, topic: str) -> None:
        super().__init__(topic)
        self.topic = topic


class UnsettledError(Exception):
    """The request must wait for the client's earlier subscriptions: it could bring messages that they would miss."""

    def __init__(self, topic: str) -> None:
        super().__init__(topic)
        self.topic = topic


@dataclass(eq=False)
class Context(ABC):
    """A client as its operations see it. Time is a monotonic clock in s."""

    gate: Gate
    drivers: Drivers
    graph: Graph
    types: Types
    clock: Clock
    identity: Identity
    address: str = "nobody"  # of the client's machine
    claim: Claim | None = field(default=None, init=False)  # to be somebody else
    status_level: str = field(default="error", init=False)  # the client wants to hear this and worse
    found: dict[str, str | None] = field(default_factory=dict, init=False)  # what ROS says of topics' types
    unsettled: set[str] = field(default_factory=set, init=False)  # topics whose publishers have no subscriber yet
    _lines: int = field(default=0, init=False)
    _lines_since: float = field(default=float("-inf"), init=False)

    def is_newcomer(self) -> bool:
        """Whether the news of this client's signing up may be on its way."""
        return self.claim is not None or (bool(self.identity.session) and self.gate.player(self.identity) is None)

    def topic_type(self, topic: str, named: str = "") -> MessageType:
        """The type of a topic that the client calls `named`, or leaves open by "" or "*".

        RequestError when it has another type, or none is known; TypeWantedError when ROS has not been asked yet.
        """
        named = "" if named == "*" else named
        opened = self.graph.type_of(topic)
        known = opened.name if opened else OWN_TYPES.get(topic)
        if known is None:
            if topic not in self.found:
                raise TypeWantedError(topic)
            known = self.found[topic]
        if known and named and named != known:
            raise RequestError(f"{topic} is of type {known}, not {named[:80]}")
        if not known and not named:
            raise RequestError(f"the type of {topic} is not known; give it in the field 'type'")
        return opened or self.types.message(known or named)

    @abstractmethod
    def handle(self, request: Request, now: float) -> list[Effect]:
        """Carry out one request."""

    def report(self, level: str, text: str, now: float, request_id: Id = None) -> list[Effect]:
        """Tell client and operator; `level` is error, warning or info."""
        return [*self.log(Log(LOG_LEVELS[level], text), now), *self.tell(level, text, request_id)]

    def tell(self, level: str, text: str, request_id: Id = None) -> list[Effect]:
        """Tell the client, if it wants to hear such things."""
        wanted = SEVERITY[level] <= SEVERITY[self.status_level]
        return [Send(status(level, text, request_id))] if wanted else []

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
