import socket
import threading
import time
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from laser_bot_battle import alive
from server import pulse
from tests.support.polling import until

PERIOD = 0.02  # s


class Web(HTTPServer):
    """A web server that answers with `status`."""

    status = 200


class Page(BaseHTTPRequestHandler):
    server: Web

    def do_GET(self) -> None:
        self.send_response(self.server.status)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[socket.socket], pulse.Pulse]]:
    """Starts the pulse of a web server; its signs are in tmp_path / "alive"."""
    monkeypatch.setenv("LASERBOT_ALIVE_FILE", str(tmp_path / "alive"))
    monkeypatch.setattr(alive, "PERIOD", PERIOD)
    monkeypatch.setattr(pulse, "_TIMEOUT", PERIOD)
    ending = threading.Event()
    threads = []

    def begin(listener: socket.socket) -> pulse.Pulse:
        beat = pulse.Pulse(listener, ending)
        threads.append(threading.Thread(target=beat.run))
        threads[-1].start()
        return beat

    yield begin
    ending.set()
    for thread in threads:
        thread.join()


@pytest.fixture
def web() -> Iterator[Web]:
    with Web(("127.0.0.1", 0), Page) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def gives_no_sign(file: Path) -> bool:
    deadline = time.monotonic() + 10 * PERIOD
    until(lambda: time.monotonic() > deadline or file.exists())
    return not file.exists()


def test_a_sign_of_life_needs_the_game_and_the_pages(
    web: Web, start: Callable[[socket.socket], pulse.Pulse], tmp_path: Path
) -> None:
    file = tmp_path / "alive"
    beat = start(web.socket)
    assert gives_no_sign(file), "the game has not gone on"
    beat.follow(None)
    until(file.exists)
    file.unlink()
    assert gives_no_sign(file), "the game has not gone on since"
    web.status = 500
    beat.follow(None)
    assert gives_no_sign(file), "the pages fail"
    web.status = 200
    until(file.exists)


def test_a_web_server_that_hangs_gives_none(start: Callable[[socket.socket], pulse.Pulse], tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        start(listener).follow(None)
        assert gives_no_sign(tmp_path / "alive")
