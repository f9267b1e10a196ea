"""What a robot or the camera above sees, read as programs on the master read it."""

import contextlib
import socket
import time

from server.camera.clock import ClockOffset
from server.camera.multipart import Part, Parts, boundary_of
from server.camera.picture import picture_of
from tests.integration.sim.arena import HOST, Arena

# as the relay asks
REQUEST = "GET /{camera}/stream?extra_headers=1{rate} HTTP/1.0\r\nHost: 127.0.0.1\r\nX-Laserbot-Relay: 1\r\n\r\n"


class Stream:
    """A camera's stream, read as the relay reads it."""

    def __init__(self, arena: Arena, robot: str | None, room: int | None = None, rate: int = 0) -> None:
        """None: of the camera above. `room`: bytes that the kernel may keep for this reader. `rate`: pictures a second
        to ask for, 0 for all."""
        self._socket = socket.socket()
        if room:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, room)
        self._socket.settimeout(20)
        self._socket.connect((HOST, arena.view_port))
        camera = f"eyes/{robot}" if robot else "overhead"
        self._socket.sendall(REQUEST.format(camera=camera, rate=f"&rate={rate}" if rate else "").encode())
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            head += self._socket.recv(1)
        self._parts = Parts(boundary_of(head))
        self._ready: list[Part] = []

    def part(self) -> Part | None:
        """The next picture, None at the stream's end."""
        while not self._ready:
            data = self._socket.recv(65536)
            if not data:
                return None
            self._ready += self._parts.feed(data)
        return self._ready.pop(0)

    def taken(self) -> float:
        """When the next picture was taken (Unix time in s)."""
        part = self.part()
        assert part, "the stream has ended"
        return picture_of(part, 1, 1, ClockOffset(), time.time()).taken

    def end(self) -> None:
        """From another thread: the stream ends for whoever reads it."""
        with contextlib.suppress(OSError):  # it has ended already
            self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        self._socket.close()
