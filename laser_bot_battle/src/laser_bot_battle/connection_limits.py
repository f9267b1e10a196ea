"""How many connections a server of threads may have, and how long each may take."""

import contextlib
import ipaddress
import socket
import threading
import time

from laser_bot_battle.plain_address import plain_address


class ConnectionLimits:
    """`most` connections, `of_one` of them from each other machine; when there are too many, those go that have been
    here for `longest` s. For any thread."""

    def __init__(self, most: int, longest: float, of_one: int) -> None:
        self._most, self._longest, self._of_one = most, longest, of_one
        self._lock = threading.Lock()
        self._taken: dict[socket.socket, tuple[str, float]] = {}

    def take(self, peer: socket.socket, address: str) -> bool:
        """Whether there is a place for it. Who closes the connection leaves its place."""
        address = plain_address(address)
        with self._lock:
            self._taken = {other: taken for other, taken in self._taken.items() if other.fileno() != -1}
            own = sum(machine == address for machine, _ in self._taken.values())
            is_here = ipaddress.ip_address(address).is_loopback
            if len(self._taken) < self._most and (own < self._of_one or is_here):
                self._taken[peer] = (address, time.monotonic())
                return True
        self.cut_overdue()
        return False

    def renew(self, peer: socket.socket) -> None:
        """Its time begins again."""
        with self._lock:
            if peer in self._taken:
                self._taken[peer] = (self._taken[peer][0], time.monotonic())

    def cut_overdue(self) -> None:
        """Whoever waits for such a peer reads its end."""
        end = time.monotonic() - self._longest
        with self._lock:
            for peer, (_, since) in self._taken.items():
                if since < end:
                    with contextlib.suppress(OSError):  # closed meanwhile
                        peer.shutdown(socket.SHUT_RDWR)
