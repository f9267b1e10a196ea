"""A server on which two battles have been played, seen from above: battle 1 until Bob left, battle 2 until he was shot
down. Jörg has won both."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import requests

from tests.integration.server.conftest import GameServer
from tests.support.demo import TOKEN
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.ros import RosMaster

SEEN = 4  # s of the first battle


class Played:
    """Its pages, the folder of its database, and the file of its floor."""

    def __init__(self, url: str, data: Path, floor: Path) -> None:
        self.url, self.data, self.floor = url, data, floor


@contextmanager
def played_server(folder: Path) -> Iterator[Played]:
    master = RosMaster(folder / "ros")
    master.start()
    data, floor = folder / "data", folder / "hall.json"
    shutil.copy(ROOT / "floors" / "hall.json", floor)
    settings = {"LASERBOT_COUNTDOWN": "1", "LASERBOT_HIT_DAMAGE": "40", "LASERBOT_FLOOR": str(floor)}
    server = GameServer(master, data, (), LASERBOT_OPERATOR_TOKEN=TOKEN, **settings)
    try:
        server.wait_until_serving()
        play(server)
        yield Played(server.url, data, floor)
    finally:
        server.end()
        master.stop()


def has_left(seconds: float, status: dict[str, Any]) -> bool:
    return bool(status["time_left"] <= seconds)


def play(server: GameServer) -> None:
    server.peer("positions")
    robots = {name: server.robot(f"robot{place}") for place, name in enumerate(("Jörg", "Bob"))}
    listener = server.listener()
    for seconds, lives in ((SEEN, (60, 20)), (0, (60, 20, 0))):
        pages = {name: server.player(name) for name in robots}
        for page in pages.values():
            page.ready()
        listener.wait_for(lambda status: status["game"] == 2)
        listener.wait_for(partial(has_left, 300 - seconds))
        for life in lives:
            robots["Bob"].hit()
            listener.wait_for_life("Bob", life)
        for name, page in reversed(pages.items()):  # Bob leaves, and Jörg has won
            page.post("signOutUser", data=name)
            page.close()
        listener.wait_for(lambda status: status["game"] == 0 and not status["users"])
    with requests.Session() as http:
        until(lambda: http.get(f"{server.url}/results.json").json()["battles"][0]["seconds"] is not None, 5)
