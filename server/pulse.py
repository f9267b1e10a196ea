"""A sign of life for the game server as a whole: the game goes on, and its pages are served."""

import http.client
import socket
import threading

from laser_bot_battle import alive

_TIMEOUT = 5.0  # s for a page


class Pulse:
    """Asks the web server from within, since a health check must not start a program of its own for that."""

    def __init__(self, listener: socket.socket, ending: threading.Event) -> None:
        """`listener` is the web server's."""
        host, self._port, *_ = listener.getsockname()
        self._host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)
        self._ending = ending
        self._played = threading.Event()

    def follow(self, _snapshot: object) -> None:
        """A listener of the game: it goes on."""
        self._played.set()

    def run(self) -> None:
        """Give a sign every second while all works, until the program ends."""
        while not self._ending.wait(alive.PERIOD):
            if self._played.is_set() and self._serves():
                self._played.clear()
                alive.touch()

    def _serves(self) -> bool:
        connection = http.client.HTTPConnection(self._host, self._port, timeout=_TIMEOUT)
        try:
            connection.request("GET", "/")
            return connection.getresponse().status == http.HTTPStatus.OK
        except (OSError, http.client.HTTPException):
            return False
        finally:
            connection.close()
