"""The serial port of the Arduino: a device path, a pyserial URL such as socket://host:port, or the connection of a
board."""

import contextlib
import logging
import os
import select
import socket
import termios
import time

import serial

from robot.rosserial.events import Lost, Notice, Send
from robot.rosserial.host import Host
from robot.serial import connection
from robot.serial.connection import Connection

BAUDRATE = 57600
WRITE_TIMEOUT = 1.0  # s

_log = logging.getLogger(__name__)


class PortError(Exception):
    """The port cannot be opened, or was lost; the text says why."""


class NoAnswerError(PortError):
    """The device does not say what it is; the text says what has come instead."""


class SerialPort:
    """An open port; a context manager."""

    def __init__(self, device: str, baudrate: int = BAUDRATE) -> None:
        """Opens the port for us alone; PortError says why not."""
        self.device = device
        self.baudrate = self.slowest = baudrate  # the latter: of what is read
        self.is_connection = connection.is_inherited(device)  # of a board elsewhere
        try:
            if self.is_connection:
                self.device = device.partition("#")[0]
                self.baudrate, self.slowest = connection.BAUDRATE, connection.SLOWEST
                self._port = Connection(device)
            else:
                self._port = serial.serial_for_url(
                    device, baudrate=baudrate, timeout=0, write_timeout=WRITE_TIMEOUT, exclusive=True
                )
        except (OSError, ValueError, TypeError) as error:  # pyserial lets all of them out for a bad URL
            raise PortError(f"cannot open {self.device}: {error}") from None
        self._is_terminal = hasattr(self._port, "fd")
        if not self._is_terminal:
            _send_at_once(self._port.fileno())

    def __enter__(self) -> "SerialPort":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        with contextlib.suppress(OSError, termios.error):  # an unplugged device cannot even be closed properly
            self._port.close()

    def fileno(self) -> int:
        """For select."""
        return int(self._port.fileno())

    def read(self) -> bytes:
        """What has come, perhaps nothing; PortError when the port is gone."""
        try:
            return bytes(self._port.read(4096))
        except (OSError, termios.error) as error:
            raise PortError(f"{self.device} is gone: {error}") from None

    def write(self, data: bytes) -> None:
        """PortError when the port is gone or takes nothing for 1 s."""
        try:
            # pyserial would ask select after each write, though a line that is not overloaded takes all at once
            with contextlib.suppress(BlockingIOError):
                data = data[os.write(self.fileno(), data) :]
            if data:
                self._port.write(data)
        except (OSError, termios.error) as error:
            raise PortError(f"cannot write to {self.device}: {error}") from None

    def is_clear(self) -> bool:
        """Whether what was written is on its way: of what waits, the newest counts. A serial line is, at its speed."""
        return not self.is_connection or self._port.is_clear()

    def reset_on_open(self, reset: bool) -> None:
        """Whether closing the port now lets the next opening reset an Arduino.

        Its reset line follows DTR, which the kernel drops at the last close only while HUPCL is set.
        """
        if not self._is_terminal:
            return
        try:
            attributes = termios.tcgetattr(self.fileno())
            attributes[2] = attributes[2] | termios.HUPCL if reset else attributes[2] & ~termios.HUPCL
            termios.tcsetattr(self.fileno(), termios.TCSANOW, attributes)
        except termios.error as error:
            raise PortError(f"{self.device} is gone: {error}") from None


def _send_at_once(fileno: int) -> None:
    """Switch off Nagle's algorithm, which would hold back a command until the last one is acknowledged."""
    with socket.socket(fileno=socket.dup(fileno)) as same:
        same.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def lost(device: str, host: Host, reason: str) -> PortError:
    """The error for the end of a conversation."""
    return (PortError if host.answered else NoAnswerError)(f"{device}: {reason}")


def probe(device: str, answer_within: float) -> None:
    """Return when a rosserial device has answered on the port; PortError says why not, NoAnswerError after
    `answer_within` s.

    An Arduino that has just been reset by the opening needs some seconds. Once it has answered, the next opening
    does not reset it again: a robot that is offered to players can move at once.
    """
    with SerialPort(device) as port:
        port.reset_on_open(True)
        host = Host(time.monotonic(), answer_within=answer_within)
        while not host.answered:
            ready, _, _ = select.select([port], [], [], 0.1)
            data = port.read() if ready else b""
            events = host.receive(data, time.monotonic(), time.time())
            events += host.tick(time.monotonic(), time.time())
            for event in events:
                if isinstance(event, Send):
                    port.write(event.data)
                elif isinstance(event, Notice):
                    _log.warning("%s: %s", device, event.text)
                elif isinstance(event, Lost):
                    raise lost(device, host, event.reason)
        port.reset_on_open(False)
