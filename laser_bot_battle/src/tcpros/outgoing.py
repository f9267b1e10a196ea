"""One subscriber's connection to a publisher of ours: written at once, and what it does not read waits, bounded."""

import asyncio
import itertools
import socket
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence

from tcpros.sockets import describe

# What waits for a subscriber that does not read; the oldest gives way.
MAX_WAITING = 1000  # messages
MAX_WAITING_BYTES = 4 * 2**20
# What waits is sent in pieces of about this size.
PIECE = 2**18  # bytes

_numbers = itertools.count()


class Backlog:
    """Messages in order, bounded in number and bytes; the newest is always kept."""

    def __init__(self) -> None:
        self._frames: deque[bytes] = deque()
        self._bytes = 0

    def __len__(self) -> int:
        return len(self._frames)

    def add(self, frames: Iterable[bytes]) -> None:
        for frame in frames:
            self._frames.append(frame)
            self._bytes += len(frame)
        self._bound()

    def put_back(self, frames: Sequence[bytes]) -> None:
        """They are older than the others."""
        self._frames.extendleft(reversed(frames))
        self._bytes += sum(map(len, frames))
        self._bound()

    def take(self, size: int) -> list[bytes]:
        """The oldest: about `size` bytes of them, and at least one, if there is one."""
        taken: list[bytes] = []
        while self._frames and size > 0:
            frame = self._frames.popleft()
            self._bytes -= len(frame)
            size -= len(frame)
            taken.append(frame)
        return taken

    def all(self) -> list[bytes]:
        return list(self._frames)

    def _bound(self) -> None:
        while len(self._frames) > MAX_WAITING or (self._bytes > MAX_WAITING_BYTES and len(self._frames) > 1):
            self._bytes -= len(self._frames.popleft())


class Outgoing:
    """Calls `ended(self)` once when the connection is closed."""

    def __init__(
        self, connected: socket.socket, header: Mapping[str, str], ended: Callable[["Outgoing"], None], queue: bool
    ) -> None:
        """`queue`: what cannot be sent now waits; otherwise it is dropped."""
        self.number = next(_numbers)
        self.callerid = header["callerid"]
        self.info = describe(connected)
        self.sent_bytes = 0
        self.sent_messages = 0
        self._socket = connected
        self._ended = ended
        self._queue = queue
        self._rest = b""  # of a message that was sent in part
        self._waiting = Backlog()
        self._full = False  # the event loop tells when more can be sent
        self._loop = asyncio.get_running_loop()
        self._loop.add_reader(connected, self._readable)

    def send(self, frames: Sequence[bytes], joined: bytes) -> None:
        """Messages with their lengths, and the same in one piece."""
        if not self._full:
            self._send(frames, joined)
        elif self._queue:
            self._waiting.add(frames)

    def close(self) -> None:
        if self._socket.fileno() < 0:
            return
        self._loop.remove_reader(self._socket)
        if self._full:
            self._loop.remove_writer(self._socket)
        self._socket.close()
        self._ended(self)

    def _send(self, frames: Sequence[bytes], joined: bytes) -> None:
        sent = self._write(joined)
        if sent == len(joined):
            self.sent_messages += len(frames)
            return
        begun = 0
        while begun < len(frames) and sent >= len(frames[begun]):
            sent -= len(frames[begun])
            begun += 1
        if sent:  # the rest of this one must follow, whatever becomes of those after it
            self._rest = frames[begun][sent:]
            begun += 1
        self.sent_messages += begun
        if self._queue:
            self._waiting.put_back(frames[begun:])
        if (self._rest or self._waiting) and not self._full and self._socket.fileno() >= 0:
            self._full = True
            self._loop.add_writer(self._socket, self._writable)

    def _write(self, data: bytes) -> int:
        """The number of bytes that were sent."""
        try:
            sent = self._socket.send(data)
        except (BlockingIOError, InterruptedError):
            return 0
        except OSError:
            self.close()
            return 0
        self.sent_bytes += sent
        return sent

    def _writable(self) -> None:
        if self._rest:
            self._rest = self._rest[self._write(self._rest) :]
        elif self._waiting:
            frames = self._waiting.take(PIECE)
            self._send(frames, b"".join(frames))
        if not self._rest and not self._waiting and self._socket.fileno() >= 0:
            self._full = False
            self._loop.remove_writer(self._socket)

    def _readable(self) -> None:
        """A subscriber says nothing after its header: it is its end, or nothing to us."""
        try:
            if self._socket.recv(4096):
                return
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            pass
        self.close()
