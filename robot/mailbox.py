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
        self._news = os.eventfd(0, os.EFD_NONBLOCK)

    def fileno(self) -> int:
        """Readable when there is something new."""
        return self._news

    def put(self, topic_id: int, payload: bytes) -> None:
        """A command from ROS; replaces one that has not been taken."""
        with self._lock:
            self._commands[topic_id] = payload
        os.eventfd_write(self._news, 1)

    def end(self, reason: str) -> None:
        """Ask the owner to end; the first reason counts. Takes no lock: signal handlers call it."""
        if self._end is None:
            self._end = reason
        os.eventfd_write(self._news, 1)

    @property
    def ended(self) -> str | None:
        """Why to end, None while there is no reason."""
        return self._end

    def take(self) -> dict[int, bytes]:
        """The commands since the last call, by topic id."""
        with contextlib.suppress(BlockingIOError):
            os.eventfd_read(self._news)
        with self._lock:
            commands, self._commands = self._commands, {}
        return commands
