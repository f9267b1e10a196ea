"""Work whose time grows with a message is done outside rosbridge's event loop, so that no command waits for it.

`python3 -m server.messages.outside` is the process that does it, on a socket that it inherits. A request is a pickled
(function, arguments) and what is long in it, bytes that are sent as they are:

| u32 | u32 each | |
|---|---|---|
| number of parts | their lengths | the parts: the pickle, then the long bytes |

An answer is a u32, what it is (0 bytes, 1 a pickled result, 2 a pickled exception), a u32, its length, and that.
"""

import asyncio
import os
import pickle
import signal
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any, BinaryIO, TypeVar, cast

from laser_bot_battle import priority
from server.messages.layout import ConversionError
from server.websocket.requests import RequestError

T = TypeVar("T")

BYTES, RESULT, ERROR = range(3)
READ = 2**18  # bytes that are taken over at once: others get their turn after that

_NUMBER = struct.Struct("<I")
_ANSWER = struct.Struct("<II")
_NICE = 10


class Outside:
    """The process, which is started when there is something to do. One thing is done after the other."""

    def __init__(self) -> None:
        self._turn = asyncio.Lock()
        self._other: _OtherEnd | None = None

    async def make(self, work: Callable[..., bytes], *arguments: Any) -> bytes:
        """The result of that function, or its RequestError. RuntimeError when the process has died of it."""
        return cast(bytes, await self._ask(work, arguments))

    async def do(self, work: Callable[..., T], *arguments: Any) -> T:
        """The same, for a result that is not long."""
        return cast(T, await self._ask(work, arguments))

    def close(self) -> None:
        """What is under way is not waited for."""
        if self._other is not None:
            self._other.close()

    async def _ask(self, work: Callable[..., object], arguments: tuple[object, ...]) -> object:
        async with self._turn:
            if self._other is None or self._other.has_ended:
                self._other = await _start()
            return await self._other.ask(work, arguments)


async def _start() -> "_OtherEnd":
    loop = asyncio.get_running_loop()
    ours, theirs = socket.socketpair()
    started: asyncio.Future[subprocess.Popen[bytes]] = loop.create_future()

    def start() -> None:
        priority.keep_to_oneself()
        command = [sys.executable, "-m", "server.messages.outside", str(theirs.fileno())]
        try:
            process = subprocess.Popen(command, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL)
        except OSError as error:
            loop.call_soon_threadsafe(started.set_exception, RuntimeError(f"no process can be started: {error}"))
        else:
            loop.call_soon_threadsafe(started.set_result, process)

    # a thread of its own: the process inherits its priority
    threading.Thread(target=start, name="start outside", daemon=True).start()
    try:
        process = await started
    except RuntimeError:
        ours.close()
        raise
    finally:
        theirs.close()
    _, other = await loop.create_unix_connection(lambda: _OtherEnd(process), sock=ours)
    return other


class _OtherEnd(asyncio.BufferedProtocol):
    """The connection to the process."""

    def __init__(self, process: "subprocess.Popen[bytes]") -> None:
        self.has_ended = False
        self._process = process
        self._transport: asyncio.Transport | None = None
        self._answer: asyncio.Future[object] | None = None
        self._head = bytearray(_ANSWER.size)
        self._body: bytearray | None = None
        self._filled = 0  # bytes, of the head or the body

    async def ask(self, work: Callable[..., object], arguments: tuple[object, ...]) -> object:
        assert self._transport is not None
        long: list[pickle.PickleBuffer] = []
        request = pickle.dumps((work, arguments), protocol=5, buffer_callback=long.append)
        parts: list[bytes | memoryview] = [request, *(buffer.raw() for buffer in long)]
        self._answer = asyncio.get_running_loop().create_future()
        self._transport.write(struct.pack(f"<{len(parts) + 1}I", len(parts), *map(len, parts)))
        for part in parts:
            self._transport.write(part)
        try:
            return await self._answer
        except asyncio.CancelledError:
            self.close()  # its answer would be taken for that of the next request
            raise

    def close(self) -> None:
        self.has_ended = True
        self._process.kill()
        self._process.wait()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)

    def get_buffer(self, sizehint: int) -> memoryview:
        target = self._head if self._body is None else self._body
        return memoryview(target)[self._filled : self._filled + READ]

    def buffer_updated(self, count: int) -> None:
        self._filled += count
        if self._body is None and self._filled == len(self._head):
            self._body, self._filled = bytearray(_ANSWER.unpack(self._head)[1]), 0
        if self._body is not None and self._filled == len(self._body):
            body, self._body, self._filled = self._body, None, 0
            self._take(_ANSWER.unpack(self._head)[0], body)

    def connection_lost(self, error: Exception | None) -> None:
        self.close()
        if self._answer is not None and not self._answer.done():
            self._answer.set_exception(RuntimeError("the process for large messages has died; another one is started"))

    def _take(self, kind: int, body: bytearray) -> None:
        if self._answer is None or self._answer.done():  # nobody waits for it any more
            return
        if kind == BYTES:
            self._answer.set_result(body)
        elif kind == RESULT:
            self._answer.set_result(pickle.loads(body))
        else:
            self._answer.set_exception(pickle.loads(body))


def serve(connection: BinaryIO) -> None:
    """Do what is asked, until the end of the connection."""
    while number := connection.read(_NUMBER.size):
        lengths = struct.unpack(f"<{_NUMBER.unpack(number)[0]}I", connection.read(4 * _NUMBER.unpack(number)[0]))
        request, *long = [connection.read(length) for length in lengths]
        work, arguments = pickle.loads(request, buffers=long)
        try:
            result = work(*arguments)
            kind, answer = (BYTES, result) if isinstance(result, bytes) else (RESULT, pickle.dumps(result))
        except (RequestError, ConversionError) as error:
            kind, answer = ERROR, pickle.dumps(error)
        except RecursionError:
            kind, answer = ERROR, pickle.dumps(RequestError("a value is nested too deeply"))
        connection.write(_ANSWER.pack(kind, len(answer)))
        connection.write(answer)
        connection.flush()


def main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # sent to rosbridge too, which ends us
    os.nice(_NICE)
    with socket.socket(fileno=int(sys.argv[1])) as ours, ours.makefile("rwb") as connection:
        serve(cast(BinaryIO, connection))


if __name__ == "__main__":
    main()
