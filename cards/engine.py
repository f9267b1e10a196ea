"""The container engine of a card, by its API."""

import json
import socket
from contextlib import closing, suppress
from http.client import HTTPConnection, HTTPException
from typing import Any, BinaryIO, Protocol

PING = "/_ping"
LOAD = "/images/load?quiet=1"
# s without a byte. What a cut has left may hang the engine, and systemd, whose socket it is, accepts questions for it.
_ANSWER = 120.0
_ANSWERS = {PING: 10.0, LOAD: 1800.0}


class Engine(Protocol):
    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        """The status and what the answer says. `body`: what becomes JSON, or a file. OSError if the engine is away,
        EngineError if it gives no whole answer, or the file cannot be read."""


class EngineError(Exception):
    pass


def do(engine: Engine, method: str, path: str, body: Any = None) -> Any:
    """What the engine answers. EngineError if it refuses that."""
    status, answer = engine.ask(method, path, body)
    if status >= 300:
        raise EngineError(f"the engine refuses {method} {path}: {status} {answer}")
    return answer


def inspect(engine: Engine, name: str) -> Any:
    """What the engine says of that container; None if it has none."""
    status, found = engine.ask("GET", f"/containers/{name}/json")
    return found if status == 200 else None


class Socket:
    """An engine at a socket of this host."""

    def __init__(self, path: str) -> None:
        self._path = path

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        connection = HTTPConnection("engine")
        connection.sock = socket.socket(socket.AF_UNIX)
        content: bytes | BinaryIO | None = body
        kind = "application/x-tar"
        if isinstance(body, dict):
            content, kind = json.dumps(body).encode(), "application/json"
        with closing(connection):
            connection.sock.settimeout(_ANSWERS.get(path, _ANSWER))
            try:
                connection.sock.connect(self._path)
            except OSError as error:
                raise ConnectionError(f"the engine does not answer: {error.strerror}") from None
            try:
                # it refuses an image before it has read all of it
                with suppress(BrokenPipeError, ConnectionResetError):
                    connection.request(method, path, content, {"Content-Type": kind} if content else {})
                response = connection.getresponse()
                text = response.read().decode()
            except TimeoutError:
                raise ConnectionError("the engine does not answer: it hangs") from None
            except (OSError, HTTPException) as error:
                raise EngineError(f"{method} {path} breaks off: {error}") from None
        try:
            return response.status, json.loads(text)
        except ValueError:  # nothing, or a line for each part of an image
            return response.status, text
