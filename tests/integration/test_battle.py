"""The whole chain on one machine: real ROS master, rosbridge, referee, robot software, firmware and arena."""

import contextlib
import json
import math
import socket
import time
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest
import requests

from laser_bot_battle.master import Master
from laser_bot_battle.names import command_topic
from tests.support.demo import TOKEN, Demo
from tests.support.play import PLAYING, hunt_down, obeys, reconnect, shoot_to_the_end, stands_still, start
from tests.support.player import Eyes, Player
from tests.support.polling import until
from tests.support.sockets import connect


@pytest.fixture
def battle(demo: Demo) -> Demo:
    """A battle with short rules: a hit takes 40 of 100, the countdown 1 s."""
    demo.play_by(hit_damage=40, countdown=1)
    return demo


@pytest.fixture
def players(battle: Demo) -> Iterator[tuple[Player, Player]]:
    """Ann and Bob, signed in, each with a robot."""
    with Player(battle, "Ann") as ann, Player(battle, "Bob") as bob:
        yield ann, bob


def test_a_command_turns_the_wheels_and_silence_stops_them(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    with Eyes(battle) as eyes:
        start(ann, bob)
        before = eyes.robots()[ann.robot]
        other_before = eyes.robots()[bob.robot]

        def turned() -> bool:
            ann.drive(angular=1)
            return abs(math.remainder(eyes.robots()[ann.robot]["heading"] - before["heading"], math.tau)) > 0.3

        until(turned, 10, "Ann's robot turns right")
        assert math.remainder(eyes.robots()[ann.robot]["heading"] - before["heading"], math.tau) < 0, (
            "right is clockwise"
        )
        stands_still(ann, eyes)  # no more commands: the dead-man stops the wheels
        assert eyes.robots()[bob.robot]["heading"] == other_before["heading"], "nobody drove Bob's robot"


def test_at_the_fence_the_wheels_stop_until_the_robot_drives_back(battle: Demo, players: tuple[Player, Player]) -> None:
    """By where it is seen to be, through referee and rosbridge to the command that it gets."""
    battle.play_by(fence=True)
    ann, bob = players
    with Eyes(battle) as eyes, connect(battle.bridge, max_queue=None) as operator:
        operator.send(json.dumps({"op": "auth", "client": "operator", "mac": TOKEN}))
        operator.send(json.dumps({"op": "subscribe", "topic": command_topic(ann.robot)}))
        start(ann, bob)
        got: list[int] = []  # linear_x

        def gets(linear: int, times: int) -> bool:
            """Whether the robot's last commands were these, while she drives backwards."""
            ann.drive(linear=-1)  # all begin with their faces to the middle
            with contextlib.suppress(TimeoutError):
                while (message := json.loads(operator.recv(timeout=0)))["op"] == "publish":
                    got.append(message["msg"]["linear_x"])
            return got[-times:] == [linear] * times

        until(lambda: gets(-1, 1), 20, "her robot is told to drive backwards")
        until(lambda: gets(0, 50), 30, "it is told so no longer, though she goes on")
        stood = eyes.robots()[ann.robot]
        until(lambda: gets(0, 100), 20, "it is told nothing else")
        assert position(eyes.robots()[ann.robot]) == position(stood)

        def has_left() -> bool:
            ann.drive(linear=1)
            return math.dist(position(eyes.robots()[ann.robot]), position(stood)) > 0.02

        until(has_left, 10, "it drives back to the middle")


@pytest.mark.parametrize("address", ["127.0.0.1", "::1"])
def test_all_that_listens_is_at_either_address_of_localhost(battle: Demo, address: str) -> None:
    """A client may try only the first that the name has."""
    for port in battle.ports.values():
        with socket.create_connection((address, port), 5):
            pass
    master = Master(f"http://127.0.0.1:{battle.ports['LASERBOT_ROS_PORT']}", "test")
    nodes = {node for kind in master.call("getSystemState") for _, names in kind for node in names}
    assert {"/robots_server", "/rosbridge_websocket", "/Robot0"} <= nodes
    places = [master.call("lookupNode", node) for node in nodes if "id_service_client" not in node]
    places += [master.call("lookupService", service) for service in ("/add_new_robot", "/rosapi/topics")]
    for place in places:
        with socket.create_connection((address, urlsplit(place).port), 5):
            pass


def test_shots_lower_the_life_on_every_page_and_end_the_battle(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    with Eyes(battle) as eyes:
        start(ann, bob)
        assert shoot_to_the_end(ann, bob, eyes) == [100, 60, 20, 0]
        for player in players:
            result = [
                (entry["place"], entry["name"], entry["life"]) for entry in until(lambda p=player: p.look()["result"])
            ]
            assert result == [(1, "Ann", 100), (2, "Bob", 0)]
        until(lambda: eyes.robots()[bob.robot]["hits"] >= 3, 5, "the arena counts the light pulses")


def test_the_replay_has_where_the_robots_were(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    with Eyes(battle) as eyes, requests.Session() as http:
        start(ann, bob)
        before = eyes.robots()

        def moved() -> bool:
            ann.drive(linear=-1)  # all begin with their faces to the middle
            return math.dist(position(eyes.robots()[ann.robot]), position(before[ann.robot])) > 0.1

        until(moved, 20, "Ann drives back")
        stands_still(ann, eyes)
        after = eyes.robots()
        ann.post("signOutUser", data="Ann")
        newest = until(lambda: http.get(f"{battle.web}/results.json").json()["battles"][0]["id"])
        track = until(lambda: http.get(f"{battle.web}/results/{newest}.json").json()["track"], 5, "the track")
        assert [track["floor"]["width"], track["floor"]["height"]] == [eyes.floor["width"], eyes.floor["height"]]
        assert track["floor"]["walls"] == [[pytest.approx(end) for end in wall] for wall in eyes.floor["walls"]]
    for player in players:
        seen = [pose for pose in track["robots"][str(player.robot)] if pose]
        for pose, robot in ((seen[0], before[player.robot]), (seen[-1], after[player.robot])):
            assert pose[:2] == pytest.approx(position(robot), abs=0.03)
            assert math.cos(math.radians(pose[2]) - robot["heading"]) > 0.99
    assert track["times"] == sorted(track["times"])
    assert 0 <= track["times"][0] < 1


def position(robot: dict[str, float]) -> list[float]:
    return [robot["x"], robot["y"]]


def test_nobody_drives_another_ones_robot_or_before_the_start(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    with Eyes(battle) as eyes:
        before = eyes.robots()
        ann.drive(linear=1)  # no battle yet
        ann.bridge.close()
        ann.robot, own = bob.robot, ann.robot
        ann.connect()
        start(ann, bob)
        ann.drive(linear=1)  # not hers
        ann.robot = own

        def bob_turned() -> bool:
            bob.drive(angular=1)
            return abs(eyes.robots()[bob.robot]["heading"] - before[bob.robot]["heading"]) > 0.3

        until(bob_turned, 10, "the chain works for the one who may")
        after = eyes.robots()
        assert (after[ann.robot]["x"], after[ann.robot]["y"]) == (before[ann.robot]["x"], before[ann.robot]["y"])
        assert (after[bob.robot]["x"], after[bob.robot]["y"]) == pytest.approx(
            (before[bob.robot]["x"], before[bob.robot]["y"]), abs=1e-3
        )


def test_a_robot_whose_arduino_comes_back_at_once_stays_in_the_battle(
    battle: Demo, players: tuple[Player, Player]
) -> None:
    ann, bob = players
    start(ann, bob)
    battle.kill(rf"avr_robot .*--name virtual{bob.robot} ")
    until(lambda: "Connection to Arduino lost" in battle.log, 10, "the robot has noticed")
    with Eyes(battle) as eyes:
        until(lambda: bob.robot in eyes.robots(), 10, "it is on the floor again")
        obeys(bob, eyes)
    assert ann.look()["game"] == PLAYING
    assert bob.user("Bob")["ready"]


def test_after_a_restart_of_the_server_everybody_goes_on(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    until(lambda: {"Ann", "Bob"} == {user["name"] for user in ann.look()["users"]}, 10, "both are told of")
    told = ann.look()
    until(lambda: ann.look() is not told, 10, "something else is told: what came before is to be written")
    battle.wait_until_written()
    battle.kill(r"python3 -m server\.main")

    def back() -> bool:
        with contextlib.suppress(requests.ConnectionError):
            return ann.ready() == "OK"
        return False

    until(back, 30, "the server is back")
    with Eyes(battle) as eyes:
        start(ann, bob)
        for player in (ann, bob):
            obeys(player, eyes, 15)


@pytest.mark.slow  # it stands still for seconds
def test_a_server_that_stood_still_takes_nobody_for_gone(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    start(ann, bob)
    number = ann.look()["battle"]
    resume = time.monotonic() + 6
    with battle.pause(r"python3 -m server\.main"):
        until(lambda: time.monotonic() > resume, 10)
        last = ann.look()
    until(lambda: ann.look() is not last, 10, "the server is back")
    assert ann.look()["game"] == PLAYING
    assert ann.look()["battle"] == number
    assert {user["name"] for user in ann.look()["users"]} == {"Ann", "Bob"}


@pytest.mark.slow  # it stands still for seconds
def test_a_ros_master_that_hangs_is_not_noticed_in_a_battle(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    with Eyes(battle) as eyes:
        obeyed_until = time.monotonic() + 10
        with battle.pause(r"server\.ros\.master"):
            start(ann, bob)
            before = ann.look()
            hunt_down(ann, bob, eyes, 60)
            while time.monotonic() < obeyed_until:
                obeys(ann, eyes)
        until(lambda: ann.look()["time_left"] < before["time_left"] - 9, 5, "the battle's clock goes on")
        assert (ann.look()["game"], ann.look()["battle"]) == (PLAYING, before["battle"])
        assert ann.user("Ann")["life"] == 100
        assert 0 < ann.user("Bob")["life"] <= 60  # the last light may have hit more than once
        obeys(bob, eyes)


def test_rosbridge_restarts_and_the_players_go_on(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    start(ann, bob)
    battle.kill(r"python3 -m server\.rosbridge")

    reconnect(ann)
    ann.wait_for_game(PLAYING)
    with Eyes(battle) as eyes:
        obeys(ann, eyes, 10)


def test_a_closed_socket_stops_the_robot(battle: Demo, players: tuple[Player, Player]) -> None:
    ann, bob = players
    with Eyes(battle) as eyes:
        start(ann, bob)
        heading = eyes.robots()[ann.robot]["heading"]

        def turning() -> bool:
            ann.drive(angular=1)
            return eyes.robots()[ann.robot]["heading"] != heading

        until(turning, 10)
        ann.bridge.close()
        stands_still(ann, eyes, 3)
