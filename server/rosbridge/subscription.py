"""One client's subscription to one topic: how often messages are sent, and how many wait (protocol 3.2.4)."""

from collections import deque
from collections.abc import Hashable

from server.rosbridge.wire import Id, dumps


class Subscription:
    """A client may subscribe to a topic several times with different ids; it then gets each message once, at the
    lowest throttle rate and with the longest queue that it asked for."""

    def __init__(self, client: Hashable, topic: str) -> None:
        """`topic` as the client writes it, for that is the name by which it knows the messages."""
        self.client = client
        self.queue_length = 0
        self._throttle = 0.0  # s between messages
        self._terms: dict[Id, tuple[float, int]] = {}  # throttle and queue length by request
        self._head = f'{{"op":"publish","topic":{dumps(topic)},"msg":'
        self._waiting: deque[str] = deque()
        self._next = float("-inf")  # when the next message may be sent

    @property
    def requests(self) -> int:
        return len(self._terms)

    def has(self, request_id: Id) -> bool:
        return request_id in self._terms

    def add(self, request_id: Id, throttle: float, queue_length: int) -> None:
        """One more request to subscribe, or other terms for an earlier one; `throttle` in s."""
        self._terms[request_id] = (throttle, queue_length)
        self._agree()

    def remove(self, request_id: Id) -> bool:
        """Forget that request; true when none is left."""
        del self._terms[request_id]
        self._agree()
        return not self._terms

    def offer(self, message: str, now: float) -> str | None:
        """A message (JSON text) has come: the text to send at once, if any."""
        if not self._throttle:
            return f"{self._head}{message}}}"
        if now >= self._next and not self._waiting:
            self._next = now + self._throttle
            return f"{self._head}{message}}}"
        if self.queue_length:
            self._waiting.append(message)  # the oldest gives way
        return None

    @property
    def due(self) -> float | None:
        """When to ask for a waiting message."""
        return self._next if self._waiting else None

    def release(self, now: float) -> str | None:
        """The waiting message that is due."""
        if not self._waiting or now < self._next:
            return None
        self._next = now + self._throttle
        return f"{self._head}{self._waiting.popleft()}}}"

    def end(self) -> None:
        """Nothing is due any more."""
        self._waiting.clear()

    def _agree(self) -> None:
        self._throttle = min((throttle for throttle, _ in self._terms.values()), default=0.0)
        self.queue_length = max((length for _, length in self._terms.values()), default=0)
        self._waiting = deque(self._waiting, maxlen=self.queue_length)
