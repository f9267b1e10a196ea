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
from pathlib import Path
from typing import Any

from cards.containers import LABEL, Container, containers
from cards.engine import Engine, Socket, do, inspect
from cards.start import own_role, read

HERE = Path(__file__).resolve().parents[1]
IMAGE = HERE / "image.tar"
DESCRIBED = HERE / "containers"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--boot", type=Path, default=Path("/boot/firmware"), help="the card's first partition")
    arguments = parser.parse_args()
    card, _ = read(arguments.boot, own_role())
    described = {path.stem: json.loads(path.read_text()) for path in DESCRIBED.iterdir()}
    arrange(Socket("/run/docker.sock"), containers(card, socket.gethostname(), described), IMAGE)
    return 0


def arrange(engine: Engine, wanted: Mapping[str, Container], image: Path) -> None:
    """Give the engine the containers it lacks, and take from it the card's others; `image` is the archive of the image
    that they run.

    One that Ansible has deployed stays, and so does one that is as wanted, even if a person has stopped it.
    """
    there = do(engine, "GET", "/containers/json?all=1")
    own = {one["Names"][0].removeprefix("/") for one in there if LABEL in (one["Labels"] or {})}
    for name in sorted({*wanted, *own}):
        found = inspect(engine, name)
        if found:
            label = _label(found)
            if label is None:
                continue
            # one that was made and never started was cut off
            if name in wanted and label == wanted[name]["Labels"][LABEL] and found["State"]["Status"] != "created":
                continue
            do(engine, "DELETE", f"/containers/{name}?force=1")
        if name in wanted:
            _start(engine, name, wanted[name], image)


def _label(found: Any) -> str | None:
    """Of a container that the engine has told of: what it was made from."""
    label: str | None = (found["Config"]["Labels"] or {}).get(LABEL)
    return label


def _start(engine: Engine, name: str, container: Container, image: Path) -> None:
    if engine.ask("GET", f"/images/{container['Image']}/json")[0] != 200:
        print("loading the image", file=sys.stderr)
        with image.open("rb") as archive:
            do(engine, "POST", "/images/load?quiet=1", archive)
    do(engine, "POST", f"/containers/create?name={name}", container)
    do(engine, "POST", f"/containers/{name}/start")
    print(f"started {name}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
