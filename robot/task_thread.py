"""What waits for other programs, such as the ROS master: done in order by a thread that may hang, as they may."""

import logging
import queue
import threading
from collections.abc import Callable

_log = logging.getLogger(__name__)


class TaskThread:
    """A thread that does one after the other, for as long as this process lives."""

    def __init__(self, name: str, room: int) -> None:
        """`room`: how many may wait; 0: any number."""
        self._waiting: queue.Queue[Callable[[], None]] = queue.Queue(room)
        threading.Thread(target=self._run, name=name, daemon=True).start()

    def do(self, task: Callable[[], None]) -> bool:
        """Returns at once; False when too many wait already, and this one is not done."""
        try:
            self._waiting.put_nowait(task)
        except queue.Full:
            return False
        return True

    def _run(self) -> None:
        while True:
            task = self._waiting.get()
            try:
                task()
            except Exception:  # the next one has a right to be done
                _log.exception("failed unexpectedly")
