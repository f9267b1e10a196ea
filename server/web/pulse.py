"""A sign of life for the game server as a whole: the game goes on, and its pages are served."""

import time

from waitress.server import BaseWSGIServer

from laser_bot_battle import alive


class Pulse:
    """Passes through all that must turn: the game, the web server's loop, one of its workers.

    It takes no connection: a web server whose connections are all in use is busy, not stuck.
    """

    def __init__(self, web: BaseWSGIServer) -> None:
        self._web = web
        self._due = time.monotonic()

    def follow(self, _snapshot: object) -> None:
        """A listener of the game: it goes on."""
        now = time.monotonic()
        if now >= self._due:
            self._due = now + alive.PERIOD
            self._web.trigger.pull_trigger(lambda: self._web.task_dispatcher.add_task(self))

    def service(self) -> None:
        """A worker of the web server has come so far."""
        alive.touch()

    def cancel(self) -> None:
        """The web server ends; nobody waits for this task."""
