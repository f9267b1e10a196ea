"""Frames that wait for a slow client: bounded, so that it costs nobody else time or memory."""

from collections import OrderedDict, deque
from itertools import count

# Of messages of topics. A burst of large ones waits for a client that reads.
MAX_MESSAGES = 16 * 2**20  # bytes
# Each frame counts for so much more: it is kept in several objects.
OVERHEAD = 256  # bytes


class Outbox:
    """First in, first out. Of topics' messages the oldest give way; replies are never dropped."""

    __slots__ = ("_frames", "_message_bytes", "_numbers", "_replies", "_reply_bytes", "_topics")

    def __init__(self) -> None:
        self._numbers = count()
        self._frames: OrderedDict[int, tuple[str, bytes]] = OrderedDict()  # with the topic, or "" for a reply
        self._topics: dict[str, deque[int]] = {}  # numbers of the messages of each topic
        self._replies = self._reply_bytes = self._message_bytes = 0

    def __bool__(self) -> bool:
        return bool(self._frames)

    def exceeds(self, reply_bytes: int) -> bool:
        """Replies of more than so many bytes wait; a single one may have any length."""
        return self._reply_bytes > reply_bytes and self._replies > 1

    def reply(self, frames: bytes) -> None:
        """One answer."""
        self._frames[next(self._numbers)] = "", frames
        self._replies += 1
        self._reply_bytes += len(frames) + OVERHEAD

    def message(self, topic: str, frames: bytes, queue_length: int) -> None:
        """A message of `topic`, of which the newest `queue_length` wait, 0: as many as the bytes allow; the newest one
        always does."""
        waiting = self._topics.setdefault(topic, deque())
        number = next(self._numbers)
        waiting.append(number)
        self._frames[number] = topic, frames
        self._message_bytes += len(frames) + OVERHEAD
        while len(waiting) > 1 and (len(waiting) > queue_length > 0 or self._message_bytes > MAX_MESSAGES):
            _, dropped = self._frames.pop(waiting.popleft())
            self._message_bytes -= len(dropped) + OVERHEAD

    def next(self) -> bytes:
        """Remove and return the oldest; KeyError when empty."""
        _, (topic, frames) = self._frames.popitem(last=False)
        if not topic:
            self._replies -= 1
            self._reply_bytes -= len(frames) + OVERHEAD
            return frames
        waiting = self._topics[topic]
        waiting.popleft()
        if not waiting:
            del self._topics[topic]
        self._message_bytes -= len(frames) + OVERHEAD
        return frames
