"""Runs the card's containers as laserbot.txt says, at each start once the engine answers.

    python3 -m cards.run [--boot FOLDER]

The engine starts again by itself what it has. It lacks them at the first start, after the state was made anew, and
when laserbot.txt has changed.
"""

import argparse
import json
import socket
import sys
from collections.abc import Mapping
from http.client import HTTPConnection
from pathlib import Path
from typing import Any, BinaryIO, Protocol

from cards.containers import LABEL, Container, containers
from cards.start import own_role, read

HERE = Path(__file__).resolve().parents[1]
IMAGE = HERE / "image.tar"
DESCRIBED = HERE / "containers"
CAMERA = "laserbot-camera"  # the only one that a robot may do without


class Engine(Protocol):
    """The container engine, by its API."""

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        """The status and what the answer says. `body`: what becomes JSON, or a file."""


class EngineError(Exception):
    pass


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--boot", type=Path, default=Path("/boot/firmware"), help="the card's first partition")
    arguments = parser.parse_args()
    card, _ = read(arguments.boot, own_role())
    described = {path.stem: json.loads(path.read_text()) for path in DESCRIBED.iterdir()}
    arrange(Socket("/run/docker.sock"), containers(card, socket.gethostname(), described), IMAGE)
    return 0


def arrange(engine: Engine, wanted: Mapping[str, Container], image: Path) -> None:
    """Give the engine the containers it lacks; `image` is the archive of the image that they run.

    One that Ansible has deployed stays, and so does one that is as wanted, even if a person has stopped it.
    """
    for name in sorted({*wanted, CAMERA}):
        status, found = engine.ask("GET", f"/containers/{name}/json")
        if status == 200:
            label = (found["Config"]["Labels"] or {}).get(LABEL)
            if label is None:
                continue
            # one that was made and never started was cut off
            if name in wanted and label == wanted[name]["Labels"][LABEL] and found["State"]["Status"] != "created":
                continue
            _do(engine, "DELETE", f"/containers/{name}?force=1")
        if name in wanted:
            _start(engine, name, wanted[name], image)


def _start(engine: Engine, name: str, container: Container, image: Path) -> None:
    if engine.ask("GET", f"/images/{container['Image']}/json")[0] != 200:
        print("loading the image", file=sys.stderr)
        with image.open("rb") as archive:
            _do(engine, "POST", "/images/load?quiet=1", archive)
    _do(engine, "POST", f"/containers/create?name={name}", container)
    _do(engine, "POST", f"/containers/{name}/start")
    print(f"started {name}", file=sys.stderr)


def _do(engine: Engine, method: str, path: str, body: Any = None) -> None:
    status, answer = engine.ask(method, path, body)
    if status >= 300:
        raise EngineError(f"the engine refuses {method} {path}: {status} {answer}")


class Socket:
    """An engine at a socket of this host."""

    def __init__(self, path: str) -> None:
        self._path = path

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        connection = HTTPConnection("engine")
        connection.sock = socket.socket(socket.AF_UNIX)
        try:
            connection.sock.connect(self._path)
            content: bytes | BinaryIO | None = body
            kind = "application/x-tar"
            if isinstance(body, dict):
                content, kind = json.dumps(body).encode(), "application/json"
            connection.request(method, path, content, {"Content-Type": kind} if content else {})
            response = connection.getresponse()
            text = response.read().decode()
        finally:
            connection.close()
        try:
            return response.status, json.loads(text)
        except ValueError:  # nothing, or a line for each part of an image
            return response.status, text


if __name__ == "__main__":
    sys.exit(main())
