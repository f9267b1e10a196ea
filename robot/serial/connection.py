"""A board's connection by TCP, which another program has accepted and this one has inherited.

It stands where a serial port's device does, as `tcp://192.168.4.20:50312#7`: the board's address, and the number of the
open file.
"""

import contextlib
import fcntl
import os
import select
import socket
import struct
import termios
import time
from collections.abc import Sequence

from laser_bot_battle.listening import Listener, bind

BAUDRATE = 2_000_000  # at which a board is written to
SLOWEST = 100_000  # at which half a frame may go on; what is lost by radio is sent again
MAX_RATE = 250_000  # bytes/s that are read from one; what comes faster waits on the board
MAX_UNDER_WAY = 256  # bytes that the board has not confirmed; what was sent cannot be replaced by what is newer
BACKLOG = 32
LOOK_AGAIN = 0.01  # s
WRITE_TIMEOUT = 1.0  # s

# a connection whose board is gone is noticed by one of these, or by the silence
_KEEP_ALIVE = {socket.TCP_KEEPIDLE: 1, socket.TCP_KEEPINTVL: 1, socket.TCP_KEEPCNT: 15}  # s, s, times
_SCHEME = "tcp://"
_LISTEN = "tcp-listen://"


def listening_address(devices: Sequence[str]) -> tuple[str, int] | None:
    """Where boards are to connect, if these are no devices but `tcp-listen://address:port`."""
    if not devices[0].startswith(_LISTEN):
        return None
    host, _, port = devices[0].removeprefix(_LISTEN).rpartition(":")
    return host.strip("[]"), int(port)


def listen(host: str, port: int) -> Listener:
    """At `host`, everywhere if it is empty, by IPv4 and by IPv6. Does not block; OSError."""
    listener = bind(host or "0.0.0.0", port)
    # those that are accepted inherit it
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in _KEEP_ALIVE.items():
        listener.setsockopt(socket.IPPROTO_TCP, option, value)
    listener.listen(BACKLOG)
    listener.setblocking(False)
    return listener


def inherited(peer: socket.socket) -> str:
    """How a program is told of the connection, whose file it must inherit."""
    host, port = peer.getpeername()[:2]
    return f"{_SCHEME}{f'[{host}]' if ':' in host else host}:{port}#{peer.fileno()}"


def is_inherited(device: str) -> bool:
    return device.startswith(_SCHEME)


def file_number(device: str) -> int:
    """ValueError if there is none."""
    return int(device.rpartition("#")[2])


def is_open(device: str) -> bool:
    """Whether the board has not ended the connection."""
    try:
        with socket.socket(fileno=os.dup(file_number(device))) as same:
            return same.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT) != b""
    except BlockingIOError:
        return True
    except (OSError, ValueError):
        return False


class Connection:
    """As a port of pyserial; OSError when the board is gone."""

    def __init__(self, device: str) -> None:
        """OSError or ValueError if it is not open."""
        self._socket = socket.socket(fileno=os.dup(file_number(device)))
        self._read_again_at = 0.0

    def fileno(self) -> int:
        return self._socket.fileno()

    def close(self) -> None:
        """Other programs may still have it open."""
        self._socket.close()

    def read(self, size: int) -> bytes:
        """What has come, perhaps nothing."""
        time.sleep(max(0.0, self._read_again_at - time.monotonic()))
        try:
            data = self._socket.recv(size, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return b""
        if not data:
            raise ConnectionError("the board has closed its connection")
        self._read_again_at = time.monotonic() + len(data) / MAX_RATE
        return data

    def write(self, data: bytes) -> None:
        """TimeoutError if the connection takes nothing for 1 s."""
        while data:
            if not select.select([], [self._socket], [], WRITE_TIMEOUT)[1]:
                raise TimeoutError(f"the connection takes nothing for {WRITE_TIMEOUT:g} s")
            with contextlib.suppress(BlockingIOError):
                data = data[self._socket.send(data, socket.MSG_DONTWAIT) :]

    def is_clear(self) -> bool:
        """Whether the board has confirmed nearly all that was written."""
        try:
            (under_way,) = struct.unpack("i", fcntl.ioctl(self._socket, termios.TIOCOUTQ, bytes(4)))
        except OSError:
            return True  # reading or writing says why
        return int(under_way) <= MAX_UNDER_WAY
