"""One client's subscription to one topic: how often messages are sent, and how many wait (protocol 3.2.4)."""

from collections import deque
from collections.abc import Hashable
from typing import NamedTuple

from server.rosbridge.compression import COMPRESSIONS
from server.rosbridge.delivery import Delivery, Form
from server.websocket.requests import Id


class Terms(NamedTuple):
    """What one request to subscribe asks for."""

    throttle: float = 0.0  # s between messages
    queue_length: int = 0
    compression: str = "none"
    fragment_size: int | None = None  # characters


class Subscription:
    """A client may subscribe to a topic several times with different ids; it then gets each message once, at the
    lowest throttle rate, with the longest queue and the smallest fragments that it asked for."""

    def __init__(self, client: Hashable, topic: str) -> None:
        """`topic` as the client writes it, for that is the name by which it knows the messages."""
        self.client = client
        self.queue_length = 0
        self.form = Form(topic)
        self._topic = topic
        self._throttle = 0.0
        self._terms: dict[Id, Terms] = {}
        self._waiting: deque[Delivery] = deque()
        self._next = float("-inf")  # when the next message may be sent
        self.has_ended = False

    @property
    def requests(self) -> int:
        return len(self._terms)

    def has(self, request_id: Id) -> bool:
        return request_id in self._terms

    def add(self, request_id: Id, terms: Terms) -> None:
        """One more request to subscribe, or other terms for an earlier one."""
        self._terms[request_id] = terms
        self._agree()

    def remove(self, request_id: Id) -> bool:
        """Forget that request; true when none is left."""
        del self._terms[request_id]
        self._agree()
        return not self._terms

    def offer(self, message: Delivery, now: float) -> Delivery | None:
        """A message has come: what to send at once, if anything."""
        if not self._throttle:
            return message
        if now >= self._next and not self._waiting:
            self._next = now + self._throttle
            return message
        if self.queue_length:
            self._waiting.append(message)  # the oldest gives way
        return None

    @property
    def due(self) -> float | None:
        """When to ask for a waiting message."""
        return self._next if self._waiting else None

    def release(self, now: float) -> Delivery | None:
        """The waiting message that is due."""
        if not self._waiting or now < self._next:
            return None
        self._next = now + self._throttle
        return self._waiting.popleft()

    def end(self) -> None:
        """Nothing is due any more."""
        self.has_ended = True
        self._waiting.clear()

    def _agree(self) -> None:
        terms = self._terms.values()
        self._throttle = min((each.throttle for each in terms), default=0.0)
        self.queue_length = max((each.queue_length for each in terms), default=0)
        self._waiting = deque(self._waiting, maxlen=self.queue_length)
        self.form = Form(
            self._topic,
            max((each.compression for each in terms), key=COMPRESSIONS.index, default="none"),  # the shortest asked for
            min((each.fragment_size for each in terms if each.fragment_size is not None), default=None),
        )
