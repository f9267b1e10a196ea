"""Two arenas, each with its ROS master and its web server, on one PostgreSQL."""

import signal
from collections.abc import Callable
from functools import partial

import requests

from tests.integration.server.conftest import GameServer
from tests.integration.server.test_back_again import hit_counts
from tests.support.polling import LATEST, until
from tests.support.postgres import Postgres, postgres
from tests.support.ros import RosMaster

__all__ = ["postgres"]

PLAYING = 2


def test_two_arenas_have_one_leaderboard_and_each_its_own_battle(
    launch: Callable[..., GameServer], ros_master: RosMaster, own_master: RosMaster, postgres: Postgres
) -> None:
    variables = {
        "LASERBOT_COUNTDOWN": "1",
        "LASERBOT_HIT_DAMAGE": "50",
        "LASERBOT_DATABASE": postgres.new_database().render_as_string(hide_password=False),
    }
    own_master.start()
    red = launch(ros_master, LASERBOT_ARENA="red", **variables)
    blue = launch(own_master, LASERBOT_ARENA="blue", **variables)
    pages, victims = [], []
    for server, names in ((red, ("ann", "bob")), (blue, ("ann", "cyd"))):
        server.wait_until_serving()
        victims.append([server.robot("one"), server.robot("two")][1])
        for name in names:
            pages.append(server.player(name))
            pages[-1].ready()
    heard = [server.listener() for server in (red, blue)]
    for listener in heard:
        listener.wait_for(lambda status: status["game"] == PLAYING)
    victims[0].hit()
    heard[0].wait_for_life("bob", 50)

    red.program.process.send_signal(signal.SIGTERM)
    until(lambda: not red.program.running, 20, "its end")
    victims[1].hit()
    heard[1].wait_for_life("cyd", 50)
    red.launch()
    red.wait_until_serving()
    again = red.listener().wait_for(lambda status: status["game"] == PLAYING)
    assert {user["name"]: user["life"] for user in again["users"]} == {"ann": 100, "bob": 50}

    for victim, listener in zip(victims, heard, strict=True):
        until(partial(hit_counts, victim, listener), 20, "the robot's hits are heard again")
    for server in (red, blue):
        until(partial(has_leaderboard, server, [("ann", 2), ("bob", 0), ("cyd", 0)]), 20, "both battles count")
    for page in pages:
        page.close()


def has_leaderboard(server: GameServer, wins: list[tuple[str, int]]) -> bool:
    players = requests.get(f"{server.url}/results/leaderboard.json", timeout=LATEST).json()["players"]
    return [(player["name"], player["wins"]) for player in players] == wins
