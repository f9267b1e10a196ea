"""Texts that wait for a slow client: bounded, so that it costs nobody else time or memory."""

from collections import deque

MAX_REPLIES = 200
MAX_BYTES = 4 * 2**20


class Outbox:
    """First in, first out; of each topic only the newest messages are kept. Replies are never dropped."""

    def __init__(self) -> None:
        self._order: deque[str] = deque()  # topic, or "" for a reply
        self._texts: dict[str, deque[str]] = {"": deque()}
        self._bytes = 0

    def __bool__(self) -> bool:
        return bool(self._order)

    @property
    def is_full(self) -> bool:
        """More waits than a client that still reads would ever leave."""
        return len(self._texts[""]) > MAX_REPLIES or self._bytes > MAX_BYTES

    def reply(self, text: str) -> None:
        self._put("", text)

    def message(self, topic: str, text: str, queue_length: int) -> None:
        """A message of `topic`; when `queue_length` of them wait already, the oldest gives way."""
        waiting = self._texts.get(topic, ())
        if len(waiting) >= queue_length:
            self._order.remove(topic)
            self._take(topic)
        self._put(topic, text)

    def next(self) -> str:
        """Remove and return the oldest text; IndexError when empty."""
        return self._take(self._order.popleft())

    def _put(self, topic: str, text: str) -> None:
        self._order.append(topic)
        self._texts.setdefault(topic, deque()).append(text)
        self._bytes += len(text)

    def _take(self, topic: str) -> str:
        waiting = self._texts[topic]
        text = waiting.popleft()
        if topic and not waiting:
            del self._texts[topic]
        self._bytes -= len(text)
        return text
