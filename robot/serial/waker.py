"""How other threads reach the one that waits for the serial line."""

import contextlib
import os


class Waker:
    """Something that select can wait for, and the reason to end. Takes no lock: signal handlers call it."""

    def __init__(self) -> None:
        self._end: str | None = None
        self.is_final = False  # nobody may begin anew
        self._news = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)

    def fileno(self) -> int:
        """Readable once somebody has called, until `clear`."""
        return self._news

    def wake(self) -> None:
        """The waiting thread is to look again at what is due."""
        os.eventfd_write(self._news, 1)

    def clear(self) -> None:
        """What was called for until now is being done."""
        with contextlib.suppress(BlockingIOError):
            os.eventfd_read(self._news)

    def end(self, reason: str, is_final: bool = False) -> None:
        """Ask the waiting thread to end; the first reason counts."""
        self.is_final |= is_final
        if self._end is None:
            self._end = reason
        self.wake()

    @property
    def ended(self) -> str | None:
        """Why to end, None while there is no reason."""
        return self._end
