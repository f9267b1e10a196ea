"""The process of the pages: what happens to it is not felt in the game."""

import signal
import time
from collections.abc import Callable

import psutil
import pytest
import requests

from tests.integration.server.conftest import GameServer
from tests.support.polling import LATEST, until


def pages_of(server: GameServer) -> psutil.Process:
    (process,) = psutil.Process(server.program.process.pid).children()
    assert "server.pages" in process.cmdline()
    return process


def status(server: GameServer, path: str) -> int:
    return requests.get(f"{server.url}{path}", timeout=LATEST).status_code


def test_pages_are_made_in_a_process_that_stands_behind_the_game(server: GameServer) -> None:
    assert status(server, "/results") == 200
    game = psutil.Process(server.program.process.pid)
    assert pages_of(server).nice() > game.nice()


def test_a_page_that_the_browser_has_is_not_sent_again(server: GameServer) -> None:
    first = requests.get(f"{server.url}/results", timeout=LATEST)
    assert first.headers["Cache-Control"] == "no-cache"
    again = requests.get(f"{server.url}/results", timeout=LATEST, headers={"If-None-Match": first.headers["ETag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert requests.head(f"{server.url}/results", timeout=LATEST).headers["ETag"] == first.headers["ETag"]


def test_it_is_started_again_when_it_dies(server: GameServer) -> None:
    until(lambda: status(server, "/") == 200, 5)
    first = pages_of(server)
    first.kill()
    assert status(server, "/session") == 200
    until(lambda: status(server, "/") == 200, 5)
    assert pages_of(server).pid != first.pid
    assert "started again" in server.program.output


def test_a_vote_is_open_again_in_one_that_was_started_again(launch: Callable[..., GameServer]) -> None:
    server = launch(LASERBOT_OPERATOR_TOKEN="the operators' token")
    server.wait_until_serving()
    until(lambda: status(server, "/audience") == 200, 5)
    choices = [{"name": name, "own": False} for name in ("children", "beginners")]
    bearer = {"Authorization": "Bearer the operators' token"}
    route = f"{server.url}/operator/api/vote"
    assert requests.post(route, json={"choices": choices}, headers=bearer, timeout=LATEST).status_code == 200
    with requests.Session() as phone:

        def votes() -> list[int] | None:
            """For each choice; None while there is no vote to be seen."""
            answer = phone.get(f"{server.url}/audience", timeout=LATEST)
            vote = answer.json()["vote"] if answer.ok else None
            return vote and [choice["votes"] for choice in vote["choices"]]

        until(lambda: votes() == [0, 0], 5, "the vote is open")
        number = phone.get(f"{server.url}/audience", timeout=LATEST).json()["vote"]["number"]
        for cast in (f"vote?number={number}&choice=1", "cheer?name=ada"):
            assert phone.post(f"{server.url}/audience/{cast}", timeout=LATEST).status_code == 200
        assert phone.post(f"{server.url}/audience/vote?number=1&choice=1", timeout=LATEST).status_code == 410
        until(lambda: votes() == [0, 1], 5, "it is counted")
        pages_of(server).kill()
        until(lambda: votes() == [0, 0], 5, "it is open again")


@pytest.mark.slow  # the time is real
def test_one_that_hangs_holds_up_pages_only_and_is_replaced(server: GameServer) -> None:
    until(lambda: status(server, "/") == 200, 5)
    first = pages_of(server)
    first.send_signal(signal.SIGSTOP)
    requests_waiting = [requests.Session() for _ in range(8)]
    for session in requests_waiting:
        with pytest.raises(requests.ReadTimeout):
            session.get(f"{server.url}/about", timeout=0.2)
    began = time.monotonic()
    assert status(server, "/session") == 200
    assert server.post("incAlive", ID=99)["status"] == "ERROR"
    assert time.monotonic() - began < 2
    until(lambda: status(server, "/") == 200, 20)
    assert pages_of(server).pid != first.pid
    assert server.program.output.count("it is ended") == 1


def test_it_ends_with_the_game_server_however_that_ends(server: GameServer) -> None:
    for end in (signal.SIGKILL, signal.SIGINT):
        until(lambda: status(server, "/") == 200, 5)
        pages = pages_of(server)
        server.program.process.send_signal(end)
        server.program.exit_code()
        pages.wait(5)
        server.launch()
        server.wait_until_serving()
