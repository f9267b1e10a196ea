import contextlib
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import waitress
from waitress import wasyncore
from waitress.server import BaseWSGIServer

from laser_bot_battle import alive
from server.web.pulse import Pulse
from tests.support.polling import until

WORKERS = 2


@pytest.fixture
def alive_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    file = tmp_path / "alive"
    monkeypatch.setenv("LASERBOT_ALIVE_FILE", str(file))
    monkeypatch.setattr(alive, "PERIOD", 0.0)
    return file


@pytest.fixture
def held() -> Iterator[threading.Event]:
    """Pages are served when it is set."""
    event = threading.Event()
    yield event
    event.set()


@pytest.fixture
def asked() -> list[str]:
    """The paths that workers have begun to serve."""
    return []


@pytest.fixture
def web(held: threading.Event, asked: list[str]) -> Iterator[BaseWSGIServer]:
    """A web server for a few connections whose loop is not started yet."""

    def page(environ: dict[str, str], start_response: Callable[..., object]) -> list[bytes]:
        asked.append(environ["PATH_INFO"])
        held.wait()
        start_response("200 OK", [])
        return [b""]

    channels: dict[int, wasyncore.dispatcher] = {}
    server = waitress.create_server(page, map=channels, listen="127.0.0.1:0", threads=WORKERS, connection_limit=5)
    yield server
    held.set()
    server.task_dispatcher.shutdown()
    wasyncore.close_all(channels)


@pytest.fixture
def serve(web: BaseWSGIServer) -> Iterator[Callable[[], None]]:
    """Starts the loop of `web`."""
    thread = threading.Thread(target=web.run)
    yield thread.start
    with contextlib.suppress(OSError):  # the loop was awake, and has closed the trigger before it was pulled
        web.trigger.pull_trigger(lambda: wasyncore.close_all(web._map))
    thread.join()


def ask(web: BaseWSGIServer) -> socket.socket:
    client = socket.create_connection(web.socket.getsockname())
    client.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
    return client


def test_a_sign_of_life_needs_the_game_and_the_web_servers_loop(
    web: BaseWSGIServer, serve: Callable[[], None], held: threading.Event, alive_file: Path
) -> None:
    held.set()
    pulse = Pulse(web)
    pulse.follow(None)
    assert not alive_file.exists(), "the loop does not turn"
    serve()
    until(alive_file.exists)
    alive_file.unlink()
    with ask(web) as client:
        client.recv(100)
    assert not alive_file.exists(), "the game has not gone on since"


def test_workers_that_are_stuck_give_none(
    web: BaseWSGIServer, serve: Callable[[], None], held: threading.Event, asked: list[str], alive_file: Path
) -> None:
    serve()
    with contextlib.ExitStack() as clients:
        for _ in range(WORKERS):
            clients.enter_context(ask(web))
        until(lambda: len(asked) == WORKERS)
        Pulse(web).follow(None)
        until(lambda: web.task_dispatcher.queue)
        assert not alive_file.exists()
        held.set()
        until(alive_file.exists)


def test_a_web_server_without_a_free_connection_is_alive(
    web: BaseWSGIServer, serve: Callable[[], None], alive_file: Path
) -> None:
    serve()
    with contextlib.ExitStack() as clients:
        for _ in range(8):
            clients.enter_context(socket.create_connection(web.socket.getsockname()))
        until(lambda: len(web._map) >= 5)
        Pulse(web).follow(None)
        until(alive_file.exists)
