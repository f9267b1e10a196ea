"""How rospy's threads reach the one thread that owns the serial line."""

import contextlib
import os
import threading


class Mailbox:
    """The newest command of each topic and the reason to end; something that select can wait for."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._commands: dict[int, bytes] = {}
        self._end: str | None = None
        self._wake_out, self._wake_in = os.pipe()
        os.set_blocking(self._wake_out, False)
        os.set_blocking(self._wake_in, False)

    def fileno(self) -> int:
        """Readable when there is something new."""
        return self._wake_out

    def put(self, topic_id: int, payload: bytes) -> None:
        """A command from ROS; replaces one that has not been taken."""
        with self._lock:
            self._commands[topic_id] = payload
        self._wake()

    def end(self, reason: str) -> None:
        """Ask the owner to end; the first reason counts. Takes no lock: signal handlers call it."""
        if self._end is None:
            self._end = reason
        self._wake()

    @property
    def ended(self) -> str | None:
        """Why to end, None while there is no reason."""
        return self._end

    def take(self) -> dict[int, bytes]:
        """The commands since the last call, by topic id."""
        with contextlib.suppress(BlockingIOError):
            os.read(self._wake_out, 4096)
        with self._lock:
            commands, self._commands = self._commands, {}
        return commands

    def _wake(self) -> None:
        with contextlib.suppress(BlockingIOError):  # already full of calls to wake up
            os.write(self._wake_in, b"!")
