"""What the server has decided outlives it, in a file and in PostgreSQL."""

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import requests
from sqlalchemy import URL

from server.game.events import BattleEnded, Hit
from server.game.replay import replay
from tests.integration.server.conftest import GameServer, RobotPeer, StatusPeer
from tests.support.databases import events
from tests.support.polling import LATEST, until
from tests.support.postgres import Postgres, postgres

__all__ = ["postgres"]

PLAYING = 2
TOKEN = "the operators' token"


@pytest.fixture(params=["SQLite", "PostgreSQL"])
def url(request: pytest.FixtureRequest, tmp_path: Path, postgres: Postgres) -> URL:
    """Of an empty database."""
    if request.param == "SQLite":
        return URL.create("sqlite", database=str(tmp_path / "game.db"))
    return postgres.new_database()


@pytest.mark.slow
@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGTERM])
def test_a_server_that_ends_in_a_battle_goes_on_with_it(
    launch: Callable[..., GameServer], url: URL, by: signal.Signals
) -> None:
    address = url.render_as_string(hide_password=False)
    server = launch(
        LASERBOT_COUNTDOWN="1", LASERBOT_HIT_DAMAGE="40", LASERBOT_DATABASE=address, LASERBOT_OPERATOR_TOKEN=TOKEN
    )
    server.wait_until_serving()
    one, two = server.robot("one"), server.robot("two")
    ann, bob = server.player("ann"), server.player("bob")
    desk(server, "POST", "tournament", action="open", names=["ann", "cy", "dee", "bob"])
    desk(server, "POST", "tournament", action="call")
    ann.ready()
    bob.ready()
    listener = server.listener()
    before = listener.wait_for(lambda status: status["game"] == PLAYING)
    two.hit()
    listener.wait_for_life("bob", 60)
    until(lambda: any(isinstance(each.event, Hit) for each in events(url)), 5, "the hit is kept")

    tournament = desk(server, "GET", "state")["tournament"]
    assert tournament["matches"][0]["robots"] == [0, 1]

    server.program.process.send_signal(by)
    until(lambda: not server.program.running, 20, "its end")
    server.launch()
    server.wait_until_serving()

    after = listener.wait_for(
        lambda status: status["game"] == PLAYING and status["time_left"] < before["time_left"] - 0.5
    )
    assert {user["name"]: user["life"] for user in after["users"]} == {"ann": 100, "bob": 60}
    assert after["battle"] == before["battle"]
    assert desk(server, "GET", "state")["tournament"] == tournament
    for page in (ann, bob):
        assert page.post("playerReady", user=page.name, ready=1)["status"] == "STARTED"
    until(lambda: hit_counts(two, listener), 20, "the robot's hits are heard again")
    assert (one.id, two.id) == (0, 1)

    ended = listener.wait_for(lambda status: status["game"] == 0 and status["result"])
    until(lambda: any(isinstance(each.event, BattleEnded) for each in events(url)), 5, "the end is kept")
    played_again = [(placing.name, placing.life) for placing in replay(events(url))]
    assert played_again == [(user["name"], user["life"]) for user in ended["result"]]
    assert desk(server, "GET", "state")["tournament"]["matches"][0]["winner"] == "ann"
    for page in (ann, bob):
        page.close()


def desk(server: GameServer, method: str, path: str, **body: object) -> dict[str, Any]:
    """What the operator's interface answers."""
    url, bearer = f"{server.url}/operator/api/{path}", {"Authorization": f"Bearer {TOKEN}"}
    answer = requests.request(method, url, headers=bearer, json=body if method == "POST" else None, timeout=LATEST)
    answer.raise_for_status()
    return dict(answer.json())


def hit_counts(robot: RobotPeer, listener: StatusPeer) -> bool:
    """Shoot until the battle is over."""
    robot.hit()
    return bool(listener.latest["game"] == 0)
