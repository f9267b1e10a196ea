"""A battle that was played on a real server is on its result pages; the commands for its database work beside it."""

import subprocess
import sys
from collections.abc import Callable

import pytest
import requests

from tests.support.polling import LATEST, until
from tests.support.programs import ROOT


@pytest.fixture
def get(server) -> Callable[[str], requests.Response]:
    def ask(path: str) -> requests.Response:
        with requests.get(f"{server.url}/{path}", timeout=LATEST) as response:
            return response

    return ask


@pytest.fixture
def command(tmp_path) -> Callable[..., subprocess.CompletedProcess[str]]:
    def run(*words: str) -> subprocess.CompletedProcess[str]:
        environment = {"PYTHONPATH": f"{ROOT}:{ROOT}/build/python", "LASERBOT_DATA": str(tmp_path / "data")}
        words = (sys.executable, "-m", "server.store", *words)
        return subprocess.run(words, env=environment, capture_output=True, text=True, timeout=60, check=False)

    return run


@pytest.fixture
def played(server):
    """Ada has beaten bob, and gone."""
    robots = {name: server.robot(name) for name in ("ada", "bob")}
    pages = {name: server.player(name) for name in robots}
    listener = server.listener()
    for page in pages.values():
        page.ready()
    listener.wait_for(lambda status: status["game"] == 2)
    for life in (60, 20, 0):
        robots["bob"].hit()
        if life:
            listener.wait_for_life("bob", life)
    listener.wait_for(lambda status: status["game"] == 0)
    pages["ada"].post("signOutUser", data="ada")
    yield pages
    for page in pages.values():
        page.close()


def test_the_results_follow_the_battle(played, get):
    until(lambda: get("results.json").json()["battles"][0]["seconds"] is not None, 5, "the end is kept")
    battle = get("results/1.json").json()
    assert [(one["place"], one["name"], one["hits_taken"]) for one in battle["fighters"]] == [
        (1, "ada", 0),
        (2, "bob", 3),
    ]
    assert [(one["name"], one["what"], one["life"]) for one in battle["timeline"]] == [
        ("bob", "hit", 60),
        ("bob", "hit", 20),
        ("bob", "hit", 0),
    ]
    assert [(one["name"], one["wins"]) for one in get("results/leaderboard.json").json()["players"]] == [
        ("ada", 1),
        ("bob", 0),
    ]
    assert "bob was shot down" in get("results/1").text


def test_without_its_database_the_game_goes_on(played, get, server, tmp_path):
    until(lambda: get("results").status_code == 200, 5)
    (tmp_path / "data").rename(tmp_path / "elsewhere")
    (tmp_path / "data").touch()  # so no other database can be begun there
    until(lambda: get("results").status_code == 503, 5)
    assert "database" in get("results.json").json()["error"]
    cy = server.player("cy")
    for page in (played["bob"], cy):
        page.ready()
    until(lambda: cy.post("updateGameStatus")["game"] == 2, 10, "the next battle")
    cy.post("signOutUser", data="cy")
    assert cy.post("updateGameStatus")["game"] == 0
    (tmp_path / "data").unlink()
    (tmp_path / "elsewhere").rename(tmp_path / "data")
    battle = until(lambda: (answer := get("results/2.json")).ok and answer, 5, "the battle is kept").json()
    assert [one["name"] for one in battle["fighters"]] == ["bob", "cy"]
    assert "Traceback" not in server.program.output
    cy.close()


def test_a_running_server_is_saved_and_forgets(played, get, command, server, tmp_path):
    until(lambda: get("results.json").json()["battles"][0]["seconds"] is not None, 5, "the end is kept")
    saved = str(tmp_path / "evening.db")
    done = command("backup", saved)
    assert done.returncode == 0, done.stderr
    done = command("restore", saved)
    assert (done.returncode, "stop the web server first" in done.stderr) == (1, True)
    done = until(lambda: (tried := command("forget", "ada")).returncode == 0 and tried, 10, "her leaving is kept")
    assert "ada is player 1 now" in done.stderr
    server.player("cy").close()  # the server writes again
    assert [one["name"] for one in get("results/leaderboard.json").json()["players"]] == ["player 1", "bob"]
    assert "ada" not in get("results").text
    server.program.stop()
    assert '"ada"' not in (tmp_path / "data" / "laserbot.db").read_bytes().decode(errors="replace")
    assert command("restore", saved).returncode == 0
    server.launch()
    server.wait_until_serving()
    assert "ada" in get("results").text
