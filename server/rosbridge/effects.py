"""What a client's operations ask for: plain values that the bridge carries out, in order."""

from collections.abc import Callable
from typing import Any, NamedTuple

from server.rosbridge.conversion import MessageType


class Send(NamedTuple):
    """Send this text to the client."""

    text: str


class Log(NamedTuple):
    """A line for the operator about this client; `level` as in the logging module."""

    level: int
    text: str


class OpenPublisher(NamedTuple):
    """Nobody advertised this topic before."""

    topic: str
    type: MessageType
    latch: bool


class ClosePublisher(NamedTuple):
    """Nobody advertises this topic any more."""

    topic: str


class Publish(NamedTuple):
    """`message` is a ROS message of the type that the topic was opened with."""

    topic: str
    message: Any


class OpenSubscription(NamedTuple):
    """Nobody was subscribed to this topic before."""

    topic: str
    type: MessageType


class CloseSubscription(NamedTuple):
    """Nobody is subscribed to this topic any more."""

    topic: str


class Replay(NamedTuple):
    """The client has joined an open subscription: offer it the topic's latched message, if there is one."""

    topic: str


class CallService(NamedTuple):
    """Call the ROS service with `args` (JSON object or list); tell `done` the response, or why there is none."""

    service: str
    args: Any
    timeout: float  # s
    done: Callable[[dict[str, Any] | None, str, float], "list[Effect]"]  # (response or None, reason if None, time)


Effect = (
    Send | Log | OpenPublisher | ClosePublisher | Publish | OpenSubscription | CloseSubscription | Replay | CallService
)
