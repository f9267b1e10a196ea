"""A robot's camera for tests: an HTTP server that speaks as ustreamer does, with all that a camera can suffer.

with FakeCamera(rate=20, size=10_000) as camera:
    camera.url, camera.connections, camera.is_online = False, camera.cut(), ...
"""

import contextlib
import select
import socket
import struct
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import NamedTuple, Self

from tests.support.ports import free_port

HOST = "127.0.0.1"
BOUNDARY = b"boundarydonotcross"
HEAD = (
    b"HTTP/1.0 200 OK\r\n"
    b"Cache-Control: no-store, no-cache\r\n"
    b"Set-Cookie: stream_client=0/7f8d1cb8d2bfcb14; path=/; max-age=30\r\n"
    b"Content-Type: multipart/x-mixed-replace;boundary=" + BOUNDARY + b"\r\n\r\n"
    b"--" + BOUNDARY + b"\r\n"
)
_BEGIN, _END = b"\xff\xd8\xff\xe0", b"\xff\xd9"
_MARK = struct.Struct("<Id")


class Mark(NamedTuple):
    """What a fake picture tells about itself."""

    number: int  # of the camera's pictures, from 1 on
    made: float  # when, s of CLOCK_MONOTONIC: the same in all programs of this machine


def fake_jpeg(mark: Mark, size: int) -> bytes:
    """No picture, but it begins and ends as a JPEG does."""
    content = _BEGIN + _MARK.pack(*mark)
    return content.ljust(size - len(_END), b"x") + _END


def mark_of(jpeg: bytes) -> Mark:
    """AssertionError for what is no whole picture of a FakeCamera."""
    assert jpeg.startswith(_BEGIN) and jpeg.endswith(_END), jpeg[:20]
    return Mark(*_MARK.unpack_from(jpeg, len(_BEGIN)))


class FakeCamera:
    """Listens while in a `with`, or from `start` to `stop`; always on the same port."""

    def __init__(self, rate: float = 20.0, size: int = 10_000) -> None:
        """`rate` in pictures/s, `size` of each in bytes. Both, and what follows, may change at any time."""
        self.rate, self.size = rate, size
        self.is_online = True  # false: the camera is pulled out
        self.is_frozen = False  # nothing more comes, and the connection stays
        self.clock = 0.0  # s that the robot's clock is ahead of this machine's
        self.head = HEAD
        self.part: Callable[[FakeCamera, bytes], bytes] = part_of
        self.requests: list[str] = []  # the first line of each
        self.streams = 0  # that are open now
        self.sent = 0  # bytes of streams
        self.port = free_port()
        self.url = f"http://{HOST}:{self.port}"
        self._number = 0
        self._guests: set[socket.socket] = set()
        self._threads: list[threading.Thread] = []
        self._lock = threading.Lock()
        self._listener: socket.socket | None = None

    @property
    def connections(self) -> int:
        """How often somebody has asked, ever."""
        return len(self.requests)

    def start(self) -> None:
        self._listener = socket.create_server((HOST, self.port))
        self._run(self._accept, self._listener)

    def stop(self) -> None:
        """As when the camera's program is killed: nothing listens any more, and all connections end."""
        listener, self._listener = self._listener, None
        if listener is not None:
            listener.shutdown(socket.SHUT_RDWR)
        self.cut()
        while self._threads:
            self._threads.pop().join()
        if listener is not None:
            listener.close()

    def cut(self) -> None:
        """All connections end."""
        with self._lock:
            for guest in self._guests:
                with contextlib.suppress(OSError):
                    guest.shutdown(socket.SHUT_RDWR)

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, value: object, trace: TracebackType | None) -> None:
        self.stop()

    def _run(self, work: Callable[[socket.socket], None], own: socket.socket) -> None:
        thread = threading.Thread(target=work, args=(own,), name="fake camera")
        thread.start()  # first: `stop` joins what is in the list
        self._threads.append(thread)

    def _accept(self, listener: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while True:
                guest, _ = listener.accept()
                with self._lock:
                    self._guests.add(guest)
                if self._listener is None:
                    self.cut()
                self._run(self._serve, guest)

    def _serve(self, guest: socket.socket) -> None:
        try:
            guest.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            request = b""
            while not request.endswith(b"\r\n\r\n"):
                data = guest.recv(4096)
                if not data:
                    return
                request += data
            self.requests.append(request.partition(b"\r\n")[0].decode())
            self.streams += 1
            try:
                self._stream(guest)
            finally:
                self.streams -= 1
        except OSError:  # it has gone
            pass
        finally:
            with self._lock:
                self._guests.remove(guest)
            guest.close()

    def _stream(self, guest: socket.socket) -> None:
        guest.sendall(self.head)
        due = time.monotonic()
        while True:
            due = max(due + 1 / self.rate, time.monotonic() - 1 / self.rate)
            if not self.is_frozen:
                self._number += 1
                jpeg = fake_jpeg(Mark(self._number, time.monotonic()), self.size)
                data = self.part(self, jpeg)
                guest.sendall(data)
                self.sent += len(data)
            # a guest has nothing more to say: what can be read is its end
            if select.select([guest], [], [], max(0.0, due - time.monotonic()))[0]:
                return


def part_of(camera: FakeCamera, jpeg: bytes) -> bytes:
    """As it should be."""
    return with_headers(
        jpeg,
        f"Content-Length: {len(jpeg)}",
        f"X-Timestamp: {time.time() + camera.clock:.6f}",
        f"X-UStreamer-Online: {'true' if camera.is_online else 'false'}",
        "X-UStreamer-Latency: 0.000000",
    )


def with_headers(body: bytes, *headers: str) -> bytes:
    lines = ["Content-Type: image/jpeg", *headers, "", ""]
    return "\r\n".join(lines).encode() + body + b"\r\n--" + BOUNDARY + b"\r\n"
