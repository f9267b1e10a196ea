"""One demo for all tests that need none of their own: to start one takes seconds of a whole processor."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import requests

from tests.support import leaks
from tests.support.battle import Battle
from tests.support.polling import until
from tests.support.ports import free_port

TOKEN = "the hall is open"
ROBOTS = 2


class Demo(Battle):
    """A demo with a desk, by which each test plays by rules of its own, and finds it as it was after its start."""

    def __init__(self, journal: Path) -> None:
        web = free_port()
        super().__init__(
            ROBOTS,
            LASERBOT_OPERATOR_TOKEN=TOKEN,
            LASERBOT_JOURNAL=str(journal),
            LASERBOT_FLOOR="duel",  # on the other one, a bot drives for 10 s before it can shoot
            LASERBOT_WEB_PORT=str(web),
            LASERBOT_ORIGINS=f"http://127.0.0.1:{web}",  # whatever name a page has for rosbridge and the relay
        )
        self.journal = journal
        self.is_worn = False

    def kill(self, command: str) -> None:
        """For 20 s after its start, a server takes no silent robot for lost: the next test gets another demo."""
        self.is_worn |= "server" in command and "main" in command
        super().kill(command)

    def play_by(self, **rules: object) -> None:
        """Rules as the desk has them, such as countdown=1, until the end of the test."""
        self._operate("PUT", "rules", **rules)

    def give_to_bot(self, robot: int, level: str | None = "hard") -> None:
        """Until the end of the test; None: take it back."""
        self._operate("POST", f"robots/{robot}", bot=level)

    def wait_until_written(self) -> None:
        """Until the database has all that was handed to it."""
        until(lambda: self._state()["database"]["waiting"] == 0, 10, "the database has all")

    def tidy(self) -> None:
        """Nobody plays, waits or is banned, no tournament is open, all robots stand ready, and the rules are those of
        the start."""
        state: dict[str, Any] = until(self._state, 30, "the desk answers")
        if state["game"]["state"] != "stopped":
            self._operate("POST", "battle", action="abort")
        for robot in state["robots"]:
            self.give_to_bot(robot["id"], None)
        for one in [*state["players"], *state["queue"]]:
            self._operate("POST", f"players/{one['name']}/sign_out")
        for name in state["names"]["banned"]:
            self._operate("POST", "names", unban=name)
        for robot in state["robots"]:
            self._operate("POST", f"robots/{robot['id']}", in_service=True)
        self._operate("POST", "message", text="")
        self._operate("POST", "tournament", action="close")
        rules = state["rules"].items()
        self._operate("PUT", "rules", **{name: None for name, rule in rules if rule["value"] != rule["default"]})
        until(self._is_tidy, 30, "all robots are free")

    def _is_tidy(self) -> bool:
        state = self._state()
        return (
            bool(state)
            and state["game"]["state"] == "stopped"
            and not [*state["players"], *state["queue"]]
            and [robot["linked"] for robot in state["robots"]] == [True] * ROBOTS
        )

    def _state(self) -> dict[str, Any]:
        """Empty while the server is away."""
        try:
            return self._operate("GET", "state")
        except requests.ConnectionError:
            return {}

    def _operate(self, method: str, path: str, **body: object) -> dict[str, Any]:
        """What is gone meanwhile, such as a player who has just left, is no error."""
        answer = requests.request(
            method,
            f"{self.web}/operator/api/{path}",
            headers={"Authorization": f"Bearer {TOKEN}"},
            json=body if method != "GET" else None,
            timeout=10,
        )
        assert answer.ok or answer.status_code in (404, 409), answer.text
        return dict(answer.json())


class Demos:
    """Has one running from the first test that wants it; a new one after a test that it did not survive."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.running: Demo | None = None

    def lend(self) -> Iterator[Demo]:
        if self.running is None:
            self.running = Demo(self._folder)
            leaks.lasting.add(self.running.program.process.pid)
            self.running.__enter__()
        yield self.running
        try:
            self.running.tidy()
        except BaseException:
            self.end(is_well=False)
            raise
        if self.running.is_worn:
            self.end()

    def end(self, *, is_well: bool = True) -> None:
        running, self.running = self.running, None
        if running is not None:
            running.end(is_well=is_well)
