"""Brings a robot to the version of the game that its master runs, between two battles.

    python3 -m cards.follow

Asked about once a minute. The master is one from a card: no other serves versions. A version that has not run here is
not tried again.
"""

import socket
import subprocess
import sys
import urllib.request
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from http.client import HTTPException
from pathlib import Path
from typing import Any

from cards.archive import LONGEST, MANIFEST, Manifest, check_descriptions, copy, parse
from cards.containers import containers
from cards.engine import Engine, EngineError, Socket
from cards.files import MASTER_HOST, STATE
from cards.laserbot_txt import Card
from cards.run import ENGINE, HERE, UNIT, is_deployed_to, load
from cards.start import read
from cards.store import Store
from cards.versions import Step, next_step, tried
from laser_bot_battle.names import WEB_PORT
from laser_bot_battle.restarting import asking

PORT = 5011  # of what the master serves (laserbot-served.service)
TIMEOUT = 10.0  # s without a byte


def main() -> int:
    card, _ = read(Path("/boot/firmware"), "robot")

    def restart() -> None:
        subprocess.run(["systemctl", "restart", "--no-block", UNIT], check=True)

    follow(
        Store(STATE, HERE),
        card,
        socket.gethostname(),
        Socket(ENGINE),
        served_at=f"http://{MASTER_HOST}.local:{PORT}",
        game_at=f"http://{MASTER_HOST}.local:{WEB_PORT}",
        restart=restart,
    )
    return 0


def follow(
    store: Store, card: Card, host: str, engine: Engine, *, served_at: str, game_at: str, restart: Callable[[], None]
) -> None:
    """`served_at` and `game_at`: the master's http://HOST:PORT."""
    if is_deployed_to(engine, containers(card, host, store.described(store.own))):
        return
    try:
        with _get(f"{served_at}/{MANIFEST}") as answer:
            served = parse(answer.read(LONGEST)).of("robot")
    except (OSError, HTTPException, ValueError):  # no master, or none from a card
        return
    if card.arena and card.arena.casefold() != served.arena.casefold():
        return
    state = store.state()
    step = next_step(state, served.version, bool(served.files), store.stored(), store.own)
    if step is Step.STAY or _is_battle(game_at):
        return
    # a battle that has begun meanwhile could be disturbed by the work that comes now
    if step is Step.FETCH and (not _stored(store, served_at, served) or _is_battle(game_at)):
        return
    # while the robot can still play; a version that cannot be loaded is dealt with at the restart
    with suppress(EngineError, ValueError):
        load(engine, store, served.version, {one["Image"] for one in store.described(served.version).values()})
    # asked in its own name at last: then no countdown begins before it has restarted
    if _is_battle(game_at) or _is_battle(game_at, host):
        return
    store.remember(tried(state, served.version))
    restart()


def _stored(store: Store, served_at: str, served: Manifest) -> bool:
    """Whether the version that the master serves has come whole."""
    print(f"getting version {served.version}", file=sys.stderr)
    try:
        store.add(served, partial(_fetch, served_at, served))
    except (OSError, HTTPException, ValueError) as error:
        print(f"version {served.version}: {error}", file=sys.stderr)
        return False
    return True


def _fetch(url: str, manifest: Manifest, folder: Path) -> None:
    for name, expected in manifest.files.items():
        with _get(f"{url}/{name}") as answer:
            copy(answer, folder / name, expected)
    check_descriptions(folder)


def _is_battle(url: str, robot: str = "") -> bool:
    """Whether one runs or begins; also when the game's server does not say."""
    return asking(url, robot)() != 0


def _get(url: str) -> Any:
    # it is in the LAN: no proxy
    return urllib.request.build_opener(urllib.request.ProxyHandler({})).open(url, timeout=TIMEOUT)


if __name__ == "__main__":
    sys.exit(main())
