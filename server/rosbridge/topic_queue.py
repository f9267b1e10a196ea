"""The messages of a topic that wait while a large one before them is encoded."""

from collections import deque

from server.rosbridge.delivery import Delivery
from server.rosbridge.subscription import Subscription

MAX_WAITING = 64 * 2**20  # bytes


class TopicQueue:
    """Messages in their order, each for its subscriptions. The oldest give way when they are too long together."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[Delivery, list[Subscription]]] = deque()
        self._size = 0  # bytes

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def put(self, message: Delivery, subscriptions: list[Subscription]) -> None:
        """The newest one always has a place."""
        self._waiting.append((message, subscriptions))
        self._size += len(message)
        while len(self._waiting) > 1 and self._size > MAX_WAITING:
            self.next()

    def next(self) -> tuple[Delivery, list[Subscription]]:
        """Take the oldest."""
        message, subscriptions = self._waiting.popleft()
        self._size -= len(message)
        return message, subscriptions
