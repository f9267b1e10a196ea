"""A client that says what it wants and then never reads, as behind a cut network or in a frozen browser."""

import json
import socket
from types import TracebackType
from typing import Any, Self

from websockets.client import ClientProtocol
from websockets.protocol import State
from websockets.uri import parse_uri


class MuteClient:
    """Neither reads nor answers pings after the handshake."""

    def __init__(self, port: int, token: str = "") -> None:
        self._protocol = ClientProtocol(parse_uri(f"ws://127.0.0.1:{port}"))
        self._socket = socket.socket()
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self._socket.settimeout(5)
        self._socket.connect(("127.0.0.1", port))
        request = self._protocol.connect()
        if token:
            request.headers["Cookie"] = f"laserbot_session={token}"
        self._protocol.send_request(request)
        self._flush()
        while self._protocol.state is State.CONNECTING:
            self._protocol.receive_data(self._socket.recv(4096))

    def say(self, op: str, **fields: Any) -> None:
        self.send(json.dumps({"op": op, **fields}))

    def send(self, text: str) -> None:
        self._protocol.send_text(text.encode())
        self._flush()

    @property
    def name(self) -> str:
        """As rosbridge calls it."""
        host, port = self._socket.getsockname()
        return f"{host}:{port}"

    @property
    def given_up(self) -> bool:
        """The server has ended the connection."""
        try:
            self._socket.send(b"")
            return self._socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, 1)[0] != TCP_ESTABLISHED
        except OSError:
            return True

    def _flush(self) -> None:
        for data in self._protocol.data_to_send():
            self._socket.sendall(data)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._socket.close()


TCP_ESTABLISHED = 1
