"""A WebSocket client on a bare socket: cheap enough to load a server with, and it can send what no library would."""

import base64
import json
import os
import socket
import struct
from collections.abc import Mapping
from types import TracebackType
from typing import Any, Self

from websockets.utils import apply_mask

CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0x0, 0x1, 0x2, 0x8, 0x9, 0xA


def frame(payload: bytes | str, opcode: int = TEXT, *, fin: bool = True) -> bytes:
    """A client's frame, masked (RFC 6455 5.2)."""
    data = payload.encode() if isinstance(payload, str) else payload
    first = opcode | (0x80 if fin else 0)
    if len(data) < 126:
        head = struct.pack("!BB", first, 0x80 | len(data))
    elif len(data) < 1 << 16:
        head = struct.pack("!BBH", first, 0x80 | 126, len(data))
    else:
        head = struct.pack("!BBQ", first, 0x80 | 127, len(data))
    key = os.urandom(4)
    return head + key + apply_mask(data, key)


def text_of(op: str, **fields: Any) -> bytes:
    """The frame of a rosbridge operation."""
    return frame(json.dumps({"op": op, **fields}))


class BareClient:
    """Connects and shakes hands at once. Nothing is answered by itself, no ping either.

    `receive_buffer` is the size of the kernel's (bytes): a small one is full soon when nobody reads. `source` is the
    address that it comes from.
    """

    def __init__(
        self,
        port: int,
        headers: Mapping[str, str] | None = None,
        *,
        host: str = "127.0.0.1",
        receive_buffer: int = 0,
        source: str = "",
    ) -> None:
        self.socket = socket.socket()
        try:
            if receive_buffer:
                self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.socket.settimeout(10)
            if source:
                self.socket.bind((source, 0))
            self.socket.connect((host, port))
            self._received = bytearray()
            self._shake_hands(f"{host}:{port}", headers or {})
        except BaseException:
            self.socket.close()
            raise

    def send(self, data: bytes) -> None:
        """Bytes as they are: frames, parts of them, or none."""
        self.socket.sendall(data)

    def say(self, op: str, **fields: Any) -> None:
        """A rosbridge operation."""
        self.send(text_of(op, **fields))

    def hear_frame(self) -> tuple[int, bytes]:
        """The next frame's opcode and payload. TimeoutError after 10 s, ConnectionError at the end."""
        length = self._need(2)[1] & 0x7F
        start = 2
        if length == 126:
            start, length = 4, struct.unpack("!H", self._need(4)[2:4])[0]
        elif length == 127:
            start, length = 10, struct.unpack("!Q", self._need(10)[2:10])[0]
        received = self._need(start + length)
        opcode, payload = received[0] & 0x0F, bytes(received[start : start + length])
        del received[: start + length]
        return opcode, payload

    def hear(self) -> dict[str, Any]:
        """The next rosbridge operation; pings are answered on the way."""
        while True:
            opcode, payload = self.hear_frame()
            if opcode == PING:
                self.send(frame(payload, PONG))
            elif opcode == CLOSE:
                raise ConnectionError(f"closed: {payload!r}")
            elif opcode == TEXT:
                return dict(json.loads(payload))

    def close(self) -> None:
        self.socket.close()

    def _need(self, count: int) -> bytearray:
        while len(self._received) < count:
            data = self.socket.recv(65536)
            if not data:
                raise ConnectionError("the server has ended the connection")
            self._received += data
        return self._received

    def _shake_hands(self, host: str, headers: Mapping[str, str]) -> None:
        request = {
            "Host": host,
            "Upgrade": "websocket",
            "Connection": "Upgrade",
            "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(),
            "Sec-WebSocket-Version": "13",
            **headers,
        }
        lines = ["GET / HTTP/1.1", *(f"{name}: {value}" for name, value in request.items()), "", ""]
        self.send("\r\n".join(lines).encode())
        while b"\r\n\r\n" not in self._received:
            self._need(len(self._received) + 1)
        answer, _, rest = bytes(self._received).partition(b"\r\n\r\n")
        self._received[:] = rest
        status = answer.partition(b"\r\n")[0].decode()
        if " 101 " not in f"{status} ":
            raise ConnectionError(status)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
