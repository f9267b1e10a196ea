"""Who loads the rosbridge that bench_rosbridge measures: all its WebSocket clients in one process, ROS in another.

Both are cheap, and both write down times of CLOCK_MONOTONIC, which is the same in all processes. A message carries its
number modulo NUMBERS in two fields of Robot_msg.
"""

import multiprocessing
import re
import selectors
import struct
import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import rospy

from laser_bot_battle.msg import Robot_msg
from tests.support.bare import PONG, BareClient, frame, text_of
from tests.support.polling import until

TYPE = Robot_msg._type
NUMBERS = 90 * 90
QUIET = 1.0  # s without a message: the load is over
SIGN_OF_LIFE = 2.0  # s; a client that never sends is taken for dead
_MESSAGE = re.compile(rb'"linear_x": ?(\d\d), ?"angular_z": ?(\d\d), ?"shoot": ?false\}\}')


class Remote:
    """An object of `kind` in a process of its own."""

    def __init__(self, kind: Callable[..., Any], *arguments: Any) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, kind, arguments), daemon=True)
        self._process.start()
        self.result()

    @property
    def pid(self) -> int:
        assert self._process.pid is not None
        return self._process.pid

    def start(self, method: str, *arguments: Any) -> None:
        """Call `method`; `result` waits for it."""
        self._pipe.send((method, arguments))

    def result(self) -> Any:
        """What the method called last has returned; RuntimeError with its text when it failed."""
        good, value = self._pipe.recv()
        if not good:
            raise RuntimeError(value)
        return value

    def call(self, method: str, *arguments: Any) -> Any:
        """Both."""
        self.start(method, *arguments)
        return self.result()

    def close(self) -> None:
        self._pipe.close()
        self._process.join(10)
        self._process.kill()


def _serve(pipe: Any, kind: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    served = kind(*arguments)
    pipe.send((True, None))
    while True:
        try:
            method, arguments = pipe.recv()
        except EOFError:
            break
        try:
            pipe.send((True, getattr(served, method)(*arguments)))
        except Exception as error:
            pipe.send((False, f"{method}: {type(error).__name__}: {error}"))
    served.close()


class Sockets:
    """The WebSocket clients."""

    def __init__(self, host: str, port: int, token: str) -> None:
        self._host = host
        self._port = port
        self._token = token
        self._clients: list[BareClient] = []

    def connect(self, count: int) -> None:
        """Until there are `count` of them; operators, if there is a token."""
        while len(self._clients) < count:
            client = BareClient(self._port, host=self._host)
            if self._token:
                client.say("auth", client="operator", mac=self._token)
            self._clients.append(client)

    def close(self) -> None:
        for client in self._clients:
            client.close()
        self._clients.clear()

    def advertise(self, topics: list[str]) -> None:
        """Client n advertises topic n."""
        for client, topic in zip(self._clients, topics, strict=True):
            client.say("advertise", topic=topic, type=TYPE)

    def publish(self, topics: list[str], rate: float, seconds: float) -> list[float]:
        """Client n publishes on topic n; `rate` is that of all together (messages/s). Returns when each was sent."""
        per_client = min(NUMBERS, int(rate * seconds) // len(topics) + 1)
        frames = [
            [
                text_of(
                    "publish", topic=topic, msg=dict(zip(Robot_msg.__slots__, (*fields(number), False), strict=True))
                )
                for number in range(per_client)
            ]
            for topic in topics
        ]
        sent = []
        for message in paced(rate, seconds):
            number, client = divmod(message, len(topics))
            sent.append(time.monotonic())
            self._clients[client].send(frames[client][number % NUMBERS])
        return sent

    def subscribe(self, topic: str) -> None:
        for client in self._clients:
            client.say("subscribe", topic=topic, type=TYPE)

    def collect(self) -> list[list[tuple[float, int]]]:
        """Read until it is quiet; for each client when which number came."""
        heard: list[list[tuple[float, bytes]]] = [[] for _ in self._clients]
        with selectors.DefaultSelector() as selector:
            for client, chunks in zip(self._clients, heard, strict=True):
                selector.register(client.socket, selectors.EVENT_READ, chunks)
            last, alive = time.monotonic() + 10, time.monotonic()
            while True:
                ready = selector.select(QUIET)
                now = time.monotonic()
                if now > last + QUIET:
                    break
                if now > alive + SIGN_OF_LIFE:
                    alive = now
                    self._live()
                for key, _ in ready:
                    data = key.fileobj.recv(1 << 18)  # type: ignore[union-attr]
                    if not data:
                        raise ConnectionError("the server has ended a connection")
                    key.data.append((time.monotonic(), data))
                    if len(data) > 2:  # no ping
                        last = now
        return [_messages(chunks) for chunks in heard]

    def _live(self) -> None:
        pong = frame(b"", PONG)
        for client in self._clients:
            client.send(pong)


def _messages(chunks: list[tuple[float, bytes]]) -> list[tuple[float, int]]:
    messages = []
    rest = b""
    for moment, chunk in chunks:
        rest += chunk
        end = 0
        for match in _MESSAGE.finditer(rest):
            messages.append((moment, number_of(int(match[1]), int(match[2]))))
            end = match.end()
        rest = rest[end:]
    return messages


class RosSide:
    """The ROS node at the other end."""

    def __init__(self) -> None:
        rospy.init_node("bench", anonymous=True, disable_signals=True)
        self._subscribers: dict[str, rospy.Subscriber] = {}
        self._arrived: dict[str, list[tuple[float, bytes]]] = {}
        self._publisher: rospy.Publisher | None = None

    def subscribe(self, topics: list[str]) -> None:
        for topic in topics:
            arrived = self._arrived[topic] = []

            def note(message: Any, arrived: list[tuple[float, bytes]] = arrived) -> None:
                arrived.append((time.monotonic(), message._buff))

            self._subscribers[topic] = rospy.Subscriber(topic, rospy.AnyMsg, note, tcp_nodelay=True)

    def wait_for_publishers(self) -> None:
        for topic, subscriber in self._subscribers.items():
            until(subscriber.get_num_connections, what=f"a publisher of {topic}")

    def collect(self) -> list[list[tuple[float, int]]]:
        """Wait until it is quiet; for each topic when which number came. They are forgotten here."""
        until(self._is_quiet, 60, "the end of the load")
        arrived = [
            [(moment, number_of(*struct.unpack("bbx", data))) for moment, data in messages]
            for messages in self._arrived.values()
        ]
        for messages in self._arrived.values():
            messages.clear()
        return arrived

    def unsubscribe(self) -> None:
        for subscriber in self._subscribers.values():
            subscriber.unregister()
        self._subscribers.clear()
        self._arrived.clear()

    def advertise(self, topic: str) -> None:
        with warnings.catch_warnings():  # rospy would rather have a queue
            warnings.simplefilter("ignore", SyntaxWarning)
            self._publisher = rospy.Publisher(topic, Robot_msg, tcp_nodelay=True, queue_size=None)
        until(self._publisher.get_num_connections, what=f"the subscription of {topic}")

    def publish(self, rate: float, seconds: float) -> list[float]:
        """At once, never by a queue: one that does not keep up slows the publisher down. Returns when each was sent."""
        assert self._publisher
        sent = []
        for number in paced(rate, seconds):
            sent.append(time.monotonic())
            self._publisher.publish(*fields(number), False)
        return sent

    def unadvertise(self) -> None:
        assert self._publisher
        self._publisher.unregister()

    def close(self) -> None:
        rospy.signal_shutdown("done")

    def _is_quiet(self) -> bool:
        last = max((messages[-1][0] for messages in self._arrived.values() if messages), default=0.0)
        return time.monotonic() > last + QUIET


def fields(number: int) -> tuple[int, int]:
    """linear_x and angular_z, two digits each."""
    high, low = divmod(number % NUMBERS, 90)
    return 10 + high, 10 + low


def number_of(linear_x: int, angular_z: int) -> int:
    return (linear_x - 10) * 90 + angular_z - 10


def paced(rate: float, seconds: float) -> Iterator[int]:
    """Message numbers, each when its time has come; late ones follow at once, until the time is over."""
    start = time.monotonic()
    for number in range(int(rate * seconds)):
        now = time.monotonic()
        if now > start + seconds:
            break
        if (early := start + number / rate - now) > 0:  # even no time asleep lets other threads go first
            time.sleep(early)
        yield number
