"""rosbridge's topics in ROS, by rospy.

rospy talks to the master in the calling thread, and calls back from threads of its own. Here one thread beside the
event loop talks to the master, in order, and what comes back is handed to the event loop, so that no client ever waits.
"""

import asyncio
import contextlib
import logging
import queue
import threading
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

import rospy

from server.rosbridge.command_publisher import command_publisher
from server.rosbridge.conversion import MessageType
from server.rosbridge.drivers import COMMAND_TOPICS

T = TypeVar("T")
_log = logging.getLogger(__name__)

# Messages that wait for one slow subscriber, the oldest giving way. rospy sends them from a thread per subscriber.
PUBLISHER_QUEUE = 10
# Messages of one topic that wait for the event loop, the oldest giving way.
SUBSCRIBER_QUEUE = 1000
# A publisher outlives its last client by this, so that the last command (neutral, above all) gets out.
LINGER = 1.0  # s


class Registrar:
    """One thread that does all that may block on the master, one thing after the other."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._jobs: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        # a daemon, since a dead master must not keep the process
        threading.Thread(target=self._run, name="registrar", daemon=True).start()

    def run(self, job: Callable[[], T]) -> asyncio.Future[T]:
        """Do `job` in the thread; its result or exception comes by the future."""
        future: asyncio.Future[T] = self._loop.create_future()

        def done(result: T | None, error: Exception | None) -> None:
            if future.cancelled():
                return
            if error is not None:
                future.set_exception(error)
            else:
                future.set_result(result)  # type: ignore[arg-type]

        def work() -> None:
            result, failure = None, None
            try:
                result = job()
            except Exception as error:  # belongs to whoever awaits it
                failure = error
            call_in_loop(self._loop, lambda: done(result, failure))

        self._jobs.put(work)
        return future

    def _run(self) -> None:
        while True:
            self._jobs.get()()


def call_in_loop(loop: asyncio.AbstractEventLoop, call: Callable[[], None]) -> None:
    """Call `call` in the event loop, from another thread; nothing happens once the loop is closed."""
    with contextlib.suppress(RuntimeError):
        loop.call_soon_threadsafe(call)


class TopicPublisher:
    """One topic's rospy publisher, from before it is registered until after it is unregistered."""

    def __init__(self, registrar: Registrar, topic: str, message_type: MessageType, latch: bool) -> None:
        self.message_class, self.latch = message_type.message_class, latch
        self.closing: asyncio.TimerHandle | None = None
        self._topic = topic
        self._registrar = registrar
        self._has_header = "header" in self.message_class.__slots__
        self._registered: rospy.Publisher | None = None  # the registrar's
        self._publisher: rospy.Publisher | None = None  # the same, once the early messages may follow
        self._early: deque[Any] = deque(maxlen=PUBLISHER_QUEUE)  # until the publisher is there
        registrar.run(self._open).add_done_callback(self._opened)

    def publish(self, message: Any) -> None:
        if self._has_header and not message.header.stamp:
            message.header.stamp = rospy.Time.now()
        if self._publisher is None:
            self._early.append(message)
        else:
            self._publisher.publish(message)

    def unregister(self) -> None:
        self._registrar.run(lambda: self._registered and self._registered.unregister())

    def _open(self) -> None:
        """In the registrar's thread."""
        if self._topic in COMMAND_TOPICS:
            self._registered = command_publisher(self._topic, self.message_class)
        else:
            self._registered = rospy.Publisher(
                self._topic, self.message_class, latch=self.latch, queue_size=PUBLISHER_QUEUE, tcp_nodelay=True
            )

    def _opened(self, future: asyncio.Future[None]) -> None:
        if error := future.exception():
            _log.error("cannot publish on %s: %s", self._topic, error)
            return
        self._publisher = publisher = self._registered
        while publisher and self._early:
            publisher.publish(self._early.popleft())


class TopicSubscriber:
    """One topic's rospy subscriber; hands its messages to `deliver` in the event loop."""

    def __init__(
        self, registrar: Registrar, loop: asyncio.AbstractEventLoop, topic: str, message_type: MessageType,
        deliver: Callable[[str, MessageType, Any], None],
    ) -> None:  # fmt: skip
        self.latched: Any = None  # the newest message of a latched topic
        self._topic, self._type, self._deliver = topic, message_type, deliver
        self._loop, self._registrar = loop, registrar
        self._waiting: deque[Any] = deque(maxlen=SUBSCRIBER_QUEUE)
        self._take_is_due = False
        self._closed = False
        self._subscriber: rospy.Subscriber | None = None
        registrar.run(self._open).add_done_callback(self._opened)

    def unregister(self) -> None:
        self._closed = True
        self._registrar.run(lambda: self._subscriber and self._subscriber.unregister())

    def _open(self) -> None:
        self._subscriber = rospy.Subscriber(self._topic, self._type.message_class, self._received, tcp_nodelay=True)

    def _opened(self, future: asyncio.Future[None]) -> None:
        if error := future.exception():
            _log.error("cannot subscribe to %s: %s", self._topic, error)

    def _received(self, message: Any) -> None:
        """In rospy's thread. One call in the event loop takes all that has come meanwhile."""
        self._waiting.append(message)
        if not self._take_is_due:
            self._take_is_due = True
            call_in_loop(self._loop, self._take)

    def _take(self) -> None:
        self._take_is_due = False
        while self._waiting and not self._closed:
            message = self._waiting.popleft()
            if message._connection_header.get("latching") == "1":
                self.latched = message
            self._deliver(self._topic, self._type, message)


class Ros:
    """All topics that rosbridge has open. Its methods are for the event loop's thread, and never block it."""

    def __init__(self, loop: asyncio.AbstractEventLoop, deliver: Callable[[str, MessageType, Any], None]) -> None:
        """`deliver(topic, type, message)` is called in the event loop for every message received."""
        self.registrar = Registrar(loop)
        self._loop = loop
        self._deliver = deliver
        self._publishers: dict[str, TopicPublisher] = {}
        self._subscribers: dict[str, TopicSubscriber] = {}

    def open_publisher(self, topic: str, message_type: MessageType, latch: bool) -> None:
        lingering = self._publishers.get(topic)
        if lingering is not None and lingering.closing is not None:
            lingering.closing.cancel()
            lingering.closing = None
            if (lingering.message_class, lingering.latch) == (message_type.message_class, latch):
                return
            lingering.unregister()
        self._publishers[topic] = TopicPublisher(self.registrar, topic, message_type, latch)

    def publish(self, topic: str, message: Any) -> None:
        self._publishers[topic].publish(message)

    def close_publisher(self, topic: str) -> None:
        self._publishers[topic].closing = self._loop.call_later(LINGER, self._close_publisher, topic)

    def open_subscription(self, topic: str, message_type: MessageType) -> None:
        self._subscribers[topic] = TopicSubscriber(self.registrar, self._loop, topic, message_type, self._deliver)

    def latched(self, topic: str) -> Any:
        """The newest message of an open, latched topic, or None."""
        return self._subscribers[topic].latched

    def close_subscription(self, topic: str) -> None:
        self._subscribers.pop(topic).unregister()

    def _close_publisher(self, topic: str) -> None:
        self._publishers.pop(topic).unregister()
