"""A WebSocket server without ROS: it sends back what it gets."""

import asyncio
import socket
import threading
from collections.abc import Callable, Mapping, Sequence
from types import TracebackType
from typing import Any, Self

from websockets.sync.client import ClientConnection

from laser_bot_battle import listening
from laser_bot_battle.listening import Listener
from laser_bot_battle.proxies import Network
from server.access.identity import GUEST, OPERATOR, Identity
from server.websocket.connection import Connection
from server.websocket.frames import frame
from server.websocket.limits import Limits, SocketOwner, owner_of
from server.websocket.server import WebSocketServer
from tests.support.sockets import connect

LoopFactory = Callable[[], asyncio.AbstractEventLoop]
NOTHING: Mapping[str, str] = {}


class EchoBridge:
    """Does what a message begins with: `fail`, `promote`, `repeat <count> <size>` of a topic; else it is sent back."""

    def __init__(self) -> None:
        self.came: list[str] = []  # names of connections
        self.went: list[str] = []
        self.received_bytes = 0
        self.order: list[str] = []  # the names, a message each
        self.newest: Connection

    def owner(self, identity: Identity, address: str) -> SocketOwner:
        return owner_of(identity, bool(identity.session), address)

    def connected(self, connection: Connection, identity: Identity) -> Connection:
        self.came.append(connection.name)
        self.newest = connection
        return connection

    def received(self, client: Connection, data: str | bytes) -> None:
        self.received_bytes += len(data)
        self.order.append(client.name)
        match str(data).split():
            case ["fail"]:
                raise ZeroDivisionError
            case ["promote"]:
                client.move(owner_of(OPERATOR, False, client.address))
            case ["close", code]:
                client.close(int(code), "as you like")
            case ["repeat", count, size, queue]:
                for number in range(int(count)):
                    client.message("/fat", frame(f"{number} ".ljust(int(size), "x")), int(queue))
                client.reply("done")
            case _:
                client.reply(data)

    def disconnected(self, client: Connection) -> None:
        self.went.append(client.name)


def identify(origin: str | None, host: str | None, cookies: list[str]) -> Identity:
    """`operator` and `player <name>` as cookies; all others are guests."""
    match " ".join(cookies).split():
        case ["operator"]:
            return OPERATOR
        case ["player", name]:
            return Identity(session=name)
    return GUEST


class EchoServer:
    """Runs in a thread while in a `with`."""

    def __init__(
        self,
        loop_factory: LoopFactory,
        limits: Limits | None = None,
        listener: Listener | None = None,
        proxies: Sequence[Network] = (),
    ) -> None:
        self.bridge = EchoBridge()
        self.asked: list[str | None] = []  # for which host, by connection
        self._loop_factory, self._limits = loop_factory, limits
        self._listener, self._proxies = listener or listening.bind("127.0.0.1", 0), proxies
        self.port = int(self._listener.getsockname()[1])
        self._ready, self._end = threading.Event(), asyncio.Event()
        self._loop: asyncio.AbstractEventLoop
        self._thread = threading.Thread(target=self._run, name="echo server")
        self.errors: list[dict[str, Any]] = []

    def client(
        self, cookie: str = "", source: str = "127.0.0.1", headers: Mapping[str, str] = NOTHING, **options: Any
    ) -> ClientConnection:
        headers = {**headers, **({"Cookie": cookie} if cookie else {})}
        return connect(
            f"ws://127.0.0.1:{self.port}",
            additional_headers=headers, source_address=(source, 0), compression=None, max_size=None, **options,
        )  # fmt: skip

    def raw(self, source: str = "127.0.0.1") -> socket.socket:
        return socket.create_connection(("127.0.0.1", self.port), 5, (source, 0))

    def in_loop(self, work: Callable[[], object]) -> None:
        self._loop.call_soon_threadsafe(work)

    def stop(self) -> None:
        if self._thread.is_alive():
            self.in_loop(self._end.set)
            self._thread.join()

    def __enter__(self) -> Self:
        self._thread.start()
        assert self._ready.wait(10)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()
        self._listener.close()
        assert not self.errors

    def _identify(self, origin: str | None, authority: str | None, cookies: list[str]) -> Identity:
        self.asked.append(authority)
        return identify(origin, authority, cookies)

    def _run(self) -> None:
        with asyncio.Runner(loop_factory=self._loop_factory) as runner:
            runner.run(self._serve())

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._loop.set_exception_handler(lambda _, context: self.errors.append(context))
        async with WebSocketServer(self.bridge, self._listener, self._identify, self._limits, self._proxies):
            self._ready.set()
            await self._end.wait()
