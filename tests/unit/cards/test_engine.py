"""How a card asks its engine."""

import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from cards import engine as engines
from cards.engine import PING, EngineError, Socket, do

REFUSED = b'HTTP/1.1 500 Error\r\nContent-Length: 28\r\n\r\n{"message": "no space left"}'


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[Callable[[bytes], Socket]]:
    """One that reads the beginning of a question, gives that answer, and hangs up."""
    threads = []
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "engine.sock"))
        listening.listen()

        def serve(answer: bytes) -> None:
            connection, _ = listening.accept()
            with connection:
                connection.recv(1000)
                connection.sendall(answer)

        def start(answer: bytes) -> Socket:
            threads.append(threading.Thread(target=serve, args=(answer,)))
            threads[-1].start()
            return Socket(str(tmp_path / "engine.sock"))

        yield start
        for thread in threads:
            thread.join()


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    (tmp_path / "image.tar").write_bytes(bytes(1 << 22))
    return tmp_path / "image.tar"


@pytest.mark.parametrize(
    "answer, told",
    [
        (REFUSED, "the engine refuses POST /images/load: 500 .*no space left"),
        (REFUSED[:60], "POST /images/load breaks off"),
        (b"", "POST /images/load breaks off"),
    ],
)
def test_an_engine_that_hangs_up_before_it_has_read_all_is_understood(
    answer: bytes, told: str, engine: Callable[[bytes], Socket], archive: Path
) -> None:
    with archive.open("rb") as file, pytest.raises(EngineError, match=told):
        do(engine(answer), "POST", "/images/load", file)


def test_an_engine_that_hangs_is_as_good_as_away(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its socket is systemd's, which takes questions for an engine that does not."""
    monkeypatch.setitem(engines._ANSWERS, PING, 0.1)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "engine.sock"))
        listening.listen()
        with pytest.raises(ConnectionError, match="the engine does not answer: it hangs"):
            do(Socket(str(tmp_path / "engine.sock")), "GET", PING)
