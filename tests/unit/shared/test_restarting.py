"""python3 -m laser_bot_battle.restarting: what a battle needs is restarted after its end."""

import subprocess
import sys
import threading
from collections.abc import Sequence

import pytest
from werkzeug.serving import make_server

from laser_bot_battle.restarting import SILENT, asking, wait
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.linked import add_linked_robot
from tests.support.ports import free_port
from tests.support.programs import ROOT
from tests.support.site import whole_site


def waited(answers: Sequence[float | None]) -> tuple[int, list[str]]:
    """How often the server is asked if it answers so (the last time and ever after), and what is said."""
    now, asked = 0.0, 0
    told: list[str] = []

    def ask() -> float | None:
        nonlocal asked
        asked += 1
        return answers[min(asked, len(answers)) - 1]

    def rest(seconds: float) -> None:
        nonlocal now
        now += seconds

    wait(ask, told.append, lambda: now, rest)
    return asked, told


def test_without_a_battle_it_ends_at_once() -> None:
    assert waited([0]) == (1, [])


def test_it_asks_again_until_the_battle_is_over_and_says_so_once() -> None:
    assert waited([120, 119, None, 117, 0]) == (5, ["waits for the end of the battle, 120 s at most"])


def test_a_server_that_does_not_answer_has_no_battle() -> None:
    asked, told = waited([120, None])
    assert asked == 2 + SILENT - 1
    assert "does not answer" in told[-1]


@pytest.mark.parametrize("url", ["http://localhost:1", "http://$MASTER_SERVICE_HOST:$PORT", "http://[:1"])
def test_an_address_without_a_server_is_no_answer(url: str) -> None:
    assert asking(url, "")() is None


def test_the_program_asks_the_game() -> None:
    now = 0.0
    game = GameLoop(Referee(Rules(countdown=0.1)), clock=lambda: now)
    for robot, name in enumerate(("al", "bo")):
        add_linked_robot(game, f"/id_service_client_{name}")
        game.sign_up(name, name, 0)
        assert game.snapshot().robots[-1] == robot
        game.set_ready(name, True, name)
    now = 0.2
    port = free_port()
    server = make_server("127.0.0.1", port, whole_site(game, Settings.from_env({})))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    words = [sys.executable, "-m", "laser_bot_battle.restarting", f"http://localhost:{port}"]
    env = {"PYTHONPATH": str(ROOT / "build/python")}
    try:
        assert asking(f"http://localhost:{port}", "")() == 300
        with subprocess.Popen([*words, "--robot", "al"], env=env, stdout=subprocess.PIPE, text=True) as fighter:
            assert fighter.stdout is not None
            assert "waits for the end of the battle" in fighter.stdout.readline()
            assert subprocess.run([*words, "--robot", "another"], env=env, check=False).returncode == 0
            fighter.terminate()
            assert fighter.wait(10) == 0
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
