"""Shots, hits, setups and health over real ROS."""

import json
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import requests

from tests.integration.server.conftest import GameServer
from tests.support.polling import LATEST, until
from tests.support.programs import Program

TOKEN = "the operators' token"


class Duel:
    """ada and bob fight with robots 0 and 1."""

    def __init__(self, server: GameServer) -> None:
        self.server = server
        for name in ("a", "b"):
            server.robot(name)
        self.pages = {name: server.player(name) for name in ("ada", "bob")}
        self.listener = server.listener()

    def begin(self) -> None:
        for page in self.pages.values():
            page.ready()
        self.listener.wait_for(lambda status: status["game"] == 2)

    def light(self, *words: str) -> None:
        """See peers.py."""
        self.server.peer("light", *words).wait_for("done", 20)

    def user(self, name: str) -> dict[str, Any]:
        return next(user for user in self.listener.latest["users"] if user["name"] == name)


@pytest.fixture
def new_duel(launch: Callable[..., GameServer]) -> Iterator[Callable[..., Duel]]:
    duels: list[Duel] = []

    def make(**variables: str) -> Duel:
        server = launch(LASERBOT_COUNTDOWN="1", LASERBOT_HIT_DAMAGE="40", LASERBOT_OPERATOR_TOKEN=TOKEN, **variables)
        server.wait_until_serving()
        duels.append(Duel(server))
        return duels[-1]

    yield make
    for duel in duels:
        for page in duel.pages.values():
            page.close()


def setups(board: Program) -> list[dict[str, int]]:
    complete, _, _ = board.output.rpartition("\n")
    return [json.loads(line) for line in complete.splitlines() if line.startswith("{")]


def test_a_coded_shot_is_known_by_its_shooter_and_told_at_once(new_duel: Callable[..., Duel]) -> None:
    duel = new_duel(LASERBOT_LIGHT="coded")
    duel.begin()
    assert duel.listener.latest["coded"]
    duel.light("hit:1:0", "response:1", "shot:0", "hit:1:0", "hit:1:0", "hit:1:7")
    status = duel.listener.wait_for(lambda status: status["events"])
    assert [(one["name"], one["by"], one["kind"], one["life"]) for one in status["events"]] == [("bob", "ada", 0, 60)]
    duel.light("shot:0", "hit:1:0", "shot:1", "hit:0:1", "shot:0", "hit:1:0")
    status = duel.listener.wait_for(lambda status: status["game"] == 0)
    assert [(one["name"], one["by"], one["kind"], one["number"]) for one in status["events"]] == [
        ("bob", "ada", 0, 1),
        ("bob", "ada", 0, 2),
        ("ada", "bob", 0, 3),
        ("bob", "ada", 1, 4),
    ]
    fields = ("name", "place", "shots", "hits", "kills")
    assert [tuple(one[field] for field in fields) for one in status["result"]] == [
        ("ada", 1, 3, 3, 1),
        ("bob", 2, 1, 1, 0),
    ]


@pytest.mark.slow
def test_plain_light_needs_a_shot_as_soon_as_somebody_tells_of_shots(new_duel: Callable[..., Duel]) -> None:
    duel = new_duel()
    duel.begin()
    duel.light("response:1", "shot:0", "response:1")
    status = duel.listener.wait_for(lambda status: status["events"])
    assert [(one["name"], one["by"], one["life"]) for one in status["events"]] == [("bob", "ada", 60)]


def test_each_robot_is_told_how_to_shoot_and_again_when_that_changes(new_duel: Callable[..., Duel]) -> None:
    duel = new_duel(LASERBOT_TEAMS="3")
    board = duel.server.peer("board", "1", "4900")
    until(lambda: setups(board), 10, "the latched setup")
    assert setups(board) == [{"ID": 1, "team": 0, "mode": 0, "cooldown": 500, "damage": 12}]
    assert duel.pages["bob"].post("chooseTeam", user="bob", team=3)["status"] == "OK"
    until(lambda: setups(board)[-1]["team"] == 2, 10, "the team's number")
    assert duel.listener.wait_for(lambda _: duel.user("bob")["team"] == 3)["teams"] == 3
    operate(duel.server, "put", "rules", {"light": "coded", "hit_damage": 10})
    until(lambda: (setups(board)[-1]["mode"], setups(board)[-1]["damage"]) == (1, 5), 10, "the new rules")
    late = duel.server.peer("board", "0", "4900")
    until(lambda: setups(late), 10, "a robot that starts later is told, too")
    assert setups(late)[-1] == {"ID": 0, "team": 0, "mode": 1, "cooldown": 500, "damage": 5}


def test_health_is_on_the_desk_and_a_weak_robot_is_told_to_its_player(new_duel: Callable[..., Duel]) -> None:
    duel = new_duel()
    for robot, supply in ((0, "4950"), (1, "4200")):
        duel.server.peer("board", str(robot), supply)
    duel.listener.wait_for(lambda status: [user["weak"] for user in status["users"]] == [False, True])

    def health() -> dict[int, dict[str, Any]]:
        return {robot["id"]: robot["health"] for robot in operate(duel.server, "get", "state")["robots"]}

    until(lambda: all(health().values()), 10, "the other robot has told its health, too")
    robots = health()
    assert (robots[0]["warnings"], robots[1]["warnings"]) == ([], ["low_supply"])
    assert (robots[0]["board"]["supply"], robots[0]["wifi"], robots[0]["cpu"]) == (4950, -60, 0.0)
    operate(duel.server, "put", "rules", {"light": "coded"})
    until(lambda: health()[0]["warnings"] == ["wrong_light"], 15, "these boards stay plain")


@pytest.mark.slow
def test_an_operator_asks_a_robot_to_show_itself(new_duel: Callable[..., Duel]) -> None:
    duel = new_duel()
    board = duel.server.peer("board", "1", "4900")
    until(lambda: setups(board), 10)
    until(lambda: "error" not in operate(duel.server, "post", "robots/1/identify", {}), 10, "it can be asked")
    board.wait_for("identify", 10)
    assert "listens" in operate(duel.server, "post", "robots/0/identify", {})["error"]


def operate(server: GameServer, method: str, path: str, body: object = None) -> dict[str, Any]:
    address, headers = f"{server.url}/operator/api/{path}", {"Authorization": f"Bearer {TOKEN}"}
    with requests.request(method, address, json=body, headers=headers, timeout=LATEST) as response:
        content: dict[str, Any] = response.json()
    return content
