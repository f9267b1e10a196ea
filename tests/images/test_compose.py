"""The demo of compose.yaml: a whole battle in containers, one robot on arm/v7, and each container killed in turn."""

import contextlib
from collections.abc import Iterator

import pytest
import requests
from websockets.exceptions import WebSocketException

from tests.support.compose import ComposeBattle
from tests.support.containers import engine
from tests.support.play import PLAYING, STOPPED, obeys, reconnect, shoot_to_the_end, start
from tests.support.player import Eyes, Player
from tests.support.polling import AGAIN, LATEST, until

TOKEN = "of the test in containers"


@pytest.fixture(scope="module")
def battle(version: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ComposeBattle]:
    """Two robots, the second one's software for arm/v7, short rules: a hit takes 40 of 100, the countdown 1 s."""
    with ComposeBattle(
        tmp_path_factory.mktemp("compose"),
        platforms={"robot1": "linux/arm/v7"},
        LASERBOT_VERSION=version,
        LASERBOT_HIT_DAMAGE="40",
        LASERBOT_COUNTDOWN="1",
        LASERBOT_FLOOR="duel",
        LASERBOT_OPERATOR_TOKEN=TOKEN,
    ) as running:
        yield running


@pytest.fixture
def players(battle: ComposeBattle) -> Iterator[tuple[Player, Player]]:
    """Ann on robot 0 and Bob on robot 1, in a battle that has just begun."""
    until(lambda: available(battle) == 2, 60, "two free robots")
    with Player(battle, "Ann") as ann, Player(battle, "Bob") as bob:
        assert (ann.robot, bob.robot) == (0, 1)
        start(ann, bob)
        yield ann, bob


def available(battle: ComposeBattle) -> int:
    with contextlib.suppress(requests.RequestException):
        return int(requests.post(f"{battle.web}/getAvailableRobots", timeout=AGAIN).json()["availableR"])
    return 0


def wait_until_it_drives(battle: ComposeBattle, player: Player, seconds: float = 20.0) -> None:
    """Turn the player's robot until the arena shows it, which may have to come up again first."""
    views: list[Eyes] = []

    def seen() -> bool:
        with contextlib.suppress(OSError, WebSocketException):
            views.append(Eyes(battle))
        return bool(views)

    until(seen, seconds, "the arena is to be seen")
    with views[0] as eyes:
        until(lambda: player.robot in eyes.robots(), seconds, f"robot {player.robot} stands in the arena")
        obeys(player, eyes, seconds)


def test_a_battle_is_played_to_its_end(battle: ComposeBattle, players: tuple[Player, Player]) -> None:
    ann, bob = players
    page = ann.http.get(f"{battle.web}/home", timeout=LATEST).text
    assert f'name="rosbridge-port" content="{battle.rosbridge_port}"' in page
    with Eyes(battle) as eyes:
        shoot_to_the_end(bob, ann, eyes)  # from the emulated robot
    result = [(entry["place"], entry["name"], entry["life"]) for entry in bob.look()["result"]]
    assert result == [(1, "Bob", 100), (2, "Ann", 0)]


def test_no_container_has_more_rights_than_it_needs(battle: ComposeBattle) -> None:
    assert len(battle.services) == 12
    for service in battle.services:
        host = engine().containers.get(battle.container(service)).attrs["HostConfig"]
        assert host["ReadonlyRootfs"], service
        assert host["CapDrop"] == ["ALL"], service
        assert not host["CapAdd"], service
        assert not host["Privileged"], service
        assert host["SecurityOpt"] == ["no-new-privileges:true"], service
        assert host["NetworkMode"] != "host", service
        assert host["Memory"] == (512 if service.endswith("rosbridge") else 256) * 2**20, service
        assert host["PidsLimit"] == 200, service
        assert host["RestartPolicy"]["Name"] == "unless-stopped", service


@pytest.mark.slow
@pytest.mark.parametrize("service", ["demo-rosbridge", "arena", "demo-web", "arduino1"])
def test_the_battle_goes_on_when_it_crashes(
    battle: ComposeBattle, players: tuple[Player, Player], service: str
) -> None:
    ann, _ = players
    number = ann.look()["battle"]
    battle.crash(service)
    battle.wait_until_healthy()
    for player in players:
        if service == "demo-rosbridge":
            reconnect(player)
        player.wait_for_game(PLAYING, 20)
        wait_until_it_drives(battle, player)
    assert ann.look()["battle"] == number
    assert {user["name"] for user in ann.look()["users"]} == {"Ann", "Bob"}


@pytest.mark.slow
@pytest.mark.parametrize("service", ["arduino1", "robot1"])
def test_who_loses_the_robot_is_out_by_the_rules_and_the_robot_comes_back(
    battle: ComposeBattle, players: tuple[Player, Player], service: str
) -> None:
    ann, bob = players
    battle.compose("stop", service)
    ann.wait_for_game(STOPPED, 20)
    result = [(entry["place"], entry["name"], entry["left"]) for entry in ann.look()["result"]]
    assert result == [(1, "Ann", False), (2, "Bob", True)]
    battle.compose("start", service)
    battle.wait_until_healthy(120)
    bob.post("signOutUser", data="Bob")  # who keeps the seat of a robot that is back soon
    until(lambda: available(battle) == 1, 60, "Bob's robot is free")
    with Player(battle, "Cy") as cy:
        assert cy.robot == 1
        start(ann, cy)
        wait_until_it_drives(battle, cy)


@pytest.mark.slow
def test_after_a_crash_of_ros_everybody_finds_the_way_back(
    battle: ComposeBattle, players: tuple[Player, Player]
) -> None:
    battle.crash("demo-ros-master")
    battle.wait_until_healthy(120)

    def drives(player: Player) -> bool:
        with contextlib.suppress(WebSocketException):  # rosbridge begins anew when it has noticed
            reconnect(player, 60)
            wait_until_it_drives(battle, player, 60)
            return True
        return False

    for player in players:
        until(lambda player=player: drives(player), 60, f"{player.name} drives again")


@pytest.mark.slow
def test_a_bot_that_crashes_plays_again(version: str, battle: ComposeBattle) -> None:
    until(lambda: available(battle) == 2, 60, "two free robots")

    def give_to_bot(level: str | None) -> None:
        desk = f"{battle.web}/operator/api/robots/1"
        assert requests.post(desk, json={"bot": level}, headers={"Authorization": f"Bearer {TOKEN}"}, timeout=LATEST).ok

    give_to_bot("easy")
    with Player(battle, "Fay") as fay:
        until(lambda: fay.user("Bot1"), 20, "the bot has signed in")
        battle.crash("demo-bots")
        battle.wait_until_healthy()
        assert fay.ready() == "OK"
        fay.wait_for_game(PLAYING, 60)
    give_to_bot(None)
