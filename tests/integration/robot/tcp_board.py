"""A board with Wi-Fi: what a sketch with ros_lib's ArduinoTcpHardware does on the wire, with every byte recorded."""

import contextlib
import select
import socket
import struct
import threading
from collections.abc import Iterator
from typing import Self

from robot.rosserial.frame import Decoder, Frame, encode
from robot.rosserial.topic_info import TopicInfo
from tests.integration.robot.device import COMMAND, RESPONSE


class TcpBoard:
    """Connects, and answers topic requests with its topics while `answers` is true; a context manager that leaves."""

    def __init__(
        self,
        port: int,
        subscribers: tuple[TopicInfo, ...] = (COMMAND,),
        publishers: tuple[TopicInfo, ...] = (RESPONSE,),
        address: str = "127.0.0.1",
        answers: bool = True,
    ) -> None:
        """`address`: its own; it decides by which of IPv4 and IPv6 it connects."""
        self.answers = answers
        self.received = bytearray()
        self.frames: list[Frame] = []
        self.closed = False  # by the other side
        self._topics = [(0, info) for info in publishers] + [(1, info) for info in subscribers]
        family, here = (socket.AF_INET6, "::1") if ":" in address else (socket.AF_INET, "127.0.0.1")
        self._socket = socket.socket(family)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)  # such a board has no more
        self._socket.settimeout(10)
        self._socket.bind((address, 0))
        self._socket.connect((here, port))
        self._reading = threading.Lock()
        self._thread = threading.Thread(target=self._run, name="board")

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(OSError):  # the other side has closed it
            self._socket.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._socket.close()

    def send(self, data: bytes) -> None:
        self._socket.sendall(data)

    def commands(self) -> list[bytes]:
        """The payloads that came for topic 100, in order."""
        return [frame.payload for frame in self.frames if frame.topic_id == COMMAND.topic_id]

    @contextlib.contextmanager
    def busy(self) -> Iterator[None]:
        """The sketch reads nothing."""
        with self._reading:
            yield

    def _receive(self) -> bytes:
        select.select([self._socket], [], [])
        with self._reading:
            return self._socket.recv(4096)

    def _run(self) -> None:
        decoder = Decoder()
        with contextlib.suppress(OSError):  # reset, or it has left
            while data := self._receive():
                self.received += data
                for frame in decoder.feed(data, 0.0):
                    self.frames.append(frame)
                    if frame == Frame(0, b"") and self.answers:
                        self._tell_topics()
        self.closed = True

    def _tell_topics(self) -> None:
        told = [encode(kind, info.encode()) for kind, info in self._topics]
        self.send(encode(10, struct.pack("<II", 0, 0)) + b"".join(told))
