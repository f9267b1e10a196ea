"""roles/fleet/tasks/battle.yml: which hosts a playbook may take out of service now."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from werkzeug.serving import make_server

from laser_bot_battle.names import Game
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.linked import add_linked_robot
from tests.support.local_play import play_role, recap
from tests.support.ports import free_port
from tests.support.site import whole_site

HOSTS = {"laser_bot_master", "raspberrypi1", "raspberrypi2"}


class Hall:
    """A game in which raspberrypi1 fights against a robot of another host, and raspberrypi2 is nobody's."""

    def __init__(self) -> None:
        self.now = 0.0
        self.game = GameLoop(Referee(Rules(countdown=1)), clock=lambda: self.now)
        for name in ("raspberrypi1", "raspberrypi3", "raspberrypi2"):
            add_linked_robot(self.game, f"/id_service_client_{name}")

    def get_ready(self) -> None:
        for name in ("Ann", "Bob"):
            self.game.sign_up(name, name, 0)
            self.game.set_ready(name, True, name)
        assert self.game.snapshot().game is Game.COUNTDOWN

    def begin(self) -> None:
        self.get_ready()
        self.now += 1
        assert self.game.snapshot().game is Game.PLAYING


@contextmanager
def served(game: GameLoop) -> Iterator[int]:
    """Yields the port."""
    port = free_port()
    server = make_server("127.0.0.1", port, whole_site(game, Settings.from_env({})), threaded=True)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield port
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def refused(port: int, folder: Path, *flags: str) -> set[str]:
    """The hosts that are left alone."""
    run = play_role("fleet", "battle", f"fleet_web_port: {port}\nfleet_tries: 1\n", folder, "all", *flags)
    rows = recap(run.stdout)
    assert rows.keys() == HOSTS, run.stdout + run.stderr
    return {host for host, row in rows.items() if row["failed"]}


@pytest.fixture
def hall() -> Hall:
    return Hall()


def test_who_is_in_a_battle_is_left_alone(hall: Hall, tmp_path: Path) -> None:
    hall.begin()
    with served(hall.game) as port:
        assert refused(port, tmp_path) == {"laser_bot_master", "raspberrypi1"}


def test_a_battle_that_has_not_begun_waits(hall: Hall, tmp_path: Path) -> None:
    hall.get_ready()
    with served(hall.game) as port:
        assert refused(port, tmp_path) == set()
    assert hall.game.snapshot().game is Game.STOPPED
    assert "is about to restart" in hall.game.snapshot().notice


def test_a_dry_run_holds_nobody_up(hall: Hall, tmp_path: Path) -> None:
    hall.get_ready()
    with served(hall.game) as port:
        assert refused(port, tmp_path, "--check") == set()
    assert hall.game.snapshot().game is Game.COUNTDOWN


def test_a_fleet_whose_server_does_not_answer_has_no_battle(tmp_path: Path) -> None:
    assert refused(free_port(), tmp_path) == set()
