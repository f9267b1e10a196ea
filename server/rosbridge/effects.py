"""What a client's operations ask for: plain values that the bridge carries out, in order."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from server.messages.types import MessageType, ServiceType


class Send(NamedTuple):
    """Send this to the client: JSON text, or bytes for a binary message; `rest`: more of the same answer."""

    data: str | bytes
    rest: tuple[str | bytes, ...] = ()


class Log(NamedTuple):
    """A line for the operator about this client; `level` as in the logging module."""

    level: int
    text: str


class Unpack(NamedTuple):
    """A request that takes long to read, as JSON; `wrapper`: the operation that it was in, if any. What the client
    has sent after it waits for it."""

    text: str
    wrapper: str = ""


class Read(NamedTuple):
    """What a client has sent, and takes long to read: `Client.take` gets what is found in it. What comes next waits."""

    data: str | bytes


class GoOn(NamedTuple):
    """There is more to be done for the client, after others have had their turn."""


class OpenPublisher(NamedTuple):
    """Nobody advertised this topic before."""

    topic: str
    type: MessageType
    latch: bool


class Unlatch(NamedTuple):
    """The client advertises this topic no longer, others do."""

    topic: str


class ClosePublisher(NamedTuple):
    """Nobody advertises this topic any more."""

    topic: str


class Publish(NamedTuple):
    """`data` is a serialized message of the type that the topic was opened with."""

    topic: str
    data: bytes


class OpenSubscription(NamedTuple):
    """Nobody was subscribed to this topic before."""

    topic: str
    type: MessageType


class CloseSubscription(NamedTuple):
    """Nobody is subscribed to this topic any more."""

    topic: str


class Replay(NamedTuple):
    """The client has subscribed to a topic that is open: offer it the latched messages, if there are any."""

    topic: str


class FindType(NamedTuple):
    """Ask ROS for the type of a topic that is in use there; tell `done` its name, or None."""

    topic: str
    done: Callable[[str | None, float], "list[Effect]"]  # (type or None, time)


class Later(NamedTuple):
    """Call `due` in a second."""

    due: Callable[[float], "list[Effect]"]  # (time)


class Response(NamedTuple):
    """The serialized response of a service, and its type."""

    type: MessageType
    data: bytes


class CallService(NamedTuple):
    """Call the ROS service with `args` (JSON object or list, or Kept), make of its response what the client gets, and
    tell `done` that, or why there is nothing."""

    service: str
    args: Any
    timeout: float  # s, or infinity
    reply: "Reply"
    done: Callable[[Sequence[str | bytes], str, float], "list[Effect]"]  # (messages, reason if there are none, time)


class Reply(NamedTuple):
    """How the client wants the response."""

    operation: dict[str, object]  # all of it but the values
    compression: str
    fragment_size: int | None  # characters


class OpenService(NamedTuple):
    """The client offers a service to ROS."""

    service: str
    type: ServiceType


class CloseService(NamedTuple):
    """The client offers it no longer. Calls of it that are under way fail."""

    service: str


class Ask(NamedTuple):
    """ROS calls a service that the client offers, with a request that takes long to read: send the client `operation`
    with that in it, or answer the call with the reason why not."""

    call: int
    operation: Mapping[str, object]  # all of it but the args
    type: MessageType
    data: bytes


class Answer(NamedTuple):
    """The client answers the call `call` of a service that it offers: the serialized response, or None for a failure
    and its reason."""

    call: int
    data: bytes | None
    reason: str


Effect = (
    Send
    | Unpack
    | Read
    | GoOn
    | Log
    | OpenPublisher
    | Unlatch
    | ClosePublisher
    | Publish
    | OpenSubscription
    | CloseSubscription
    | Replay
    | FindType
    | Later
    | CallService
    | OpenService
    | CloseService
    | Ask
    | Answer
)
