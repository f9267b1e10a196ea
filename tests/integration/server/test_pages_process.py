"""The process of the pages: what happens to it is not felt in the game."""

import signal
import time

import psutil
import pytest
import requests

from tests.integration.server.conftest import GameServer
from tests.support.polling import until


def pages_of(server: GameServer) -> psutil.Process:
    (process,) = psutil.Process(server.program.process.pid).children()
    assert "server.pages" in process.cmdline()
    return process


def status(server: GameServer, path: str) -> int:
    return requests.get(f"{server.url}{path}", timeout=20).status_code


def test_pages_are_made_in_a_process_that_stands_behind_the_game(server: GameServer) -> None:
    assert status(server, "/results") == 200
    game = psutil.Process(server.program.process.pid)
    assert pages_of(server).nice() > game.nice()


def test_a_page_that_the_browser_has_is_not_sent_again(server: GameServer) -> None:
    first = requests.get(f"{server.url}/results", timeout=5)
    assert first.headers["Cache-Control"] == "no-cache"
    again = requests.get(f"{server.url}/results", timeout=5, headers={"If-None-Match": first.headers["ETag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert requests.head(f"{server.url}/results", timeout=5).headers["ETag"] == first.headers["ETag"]


def test_it_is_started_again_when_it_dies(server: GameServer) -> None:
    until(lambda: status(server, "/") == 200, 5)
    first = pages_of(server)
    first.kill()
    assert status(server, "/session") == 200
    until(lambda: status(server, "/") == 200, 5)
    assert pages_of(server).pid != first.pid
    assert "started again" in server.program.output


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
        server.program.process.wait(10)
        pages.wait(5)
        server.launch()
        server.wait_until_serving()
