"""What the bots' program (server.bots) hears from the game server, and what the server knows of the program."""

import time
from collections.abc import Callable

from flask import Blueprint, Response, request

from server.game.loop import GameLoop
from server.web.api import reply

SILENT = 5.0  # s after which the program, which asks each second, does not run
BLIND = 5.0  # s without a sight of any robot, in which it may just have begun to look


class BotsProgram:
    """Of one or several programs, which ask alike. A visitor who asks, too, can make nobody drive or stop a robot."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._asked_at = self._saw_at = float("-inf")

    def asks(self, *, sees: bool) -> None:
        """It wants to know which robots are for bots; `sees`: no bot of it looks for robots in vain."""
        now = self._clock()
        if sees or now - self._asked_at > SILENT:
            self._saw_at = now
        self._asked_at = now

    def state(self) -> str:
        """ "absent", "blind" (nothing tells where the robots are) or "ready"."""
        now = self._clock()
        if now - self._asked_at > SILENT:
            return "absent"
        return "blind" if now - self._saw_at > BLIND else "ready"


def create_bots(game: GameLoop, program: BotsProgram) -> Blueprint:
    """The route, as a Flask blueprint."""
    routes = Blueprint("bots", __name__)

    @routes.post("/bots")
    def bots() -> Response:
        program.asks(sees=request.form.get("sees") == "1")
        return reply(status="OK", robots={str(robot): level for robot, level in game.bots().items()})

    return routes
