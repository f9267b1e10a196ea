"""The main job: two players play a battle on the deployed fleet to its end, and its cameras are looked through."""

import json
import time
from collections.abc import Iterator

import requests

from fleet import Machine
from tests.support.play import shoot_to_the_end, start
from tests.support.player import Eyes
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal
from tests.support.roslib_player import RoslibPlayer
from tests.support.sockets import connect


def test_two_players_with_roslib_play_a_battle_to_its_end(rehearsal: Rehearsal) -> None:
    rehearsal.wait_until_complete()
    with RoslibPlayer(rehearsal, "Ann") as ann, RoslibPlayer(rehearsal, "Bob") as bob, Eyes(rehearsal) as eyes:
        assert {ann.robot, bob.robot} <= {1, 2, 3}, "a robot's ID is its number"
        assert ann.robot == 1, "the one that finds the master by itself"
        told = rehearsal.machines["raspberrypi1"].container("laserbot-robot")["Config"]["Env"]
        assert not [setting for setting in told if setting.startswith(("LASERBOT_MASTER=", "ROS_MASTER_URI="))]
        start(ann, bob)
        assert shoot_to_the_end(ann, bob, eyes) == [100, 60, 20, 0]
        result = [(entry["place"], entry["name"], entry["life"]) for entry in until(lambda: bob.look()["result"])]
        assert result == [(1, "Ann", 100), (2, "Bob", 0)]


def look(fleet: Rehearsal, token: str, robot: Machine) -> Iterator[str | bytes]:
    """What the relay tells an operator of a robot's camera, and the pictures."""
    with connect(f"ws://{fleet.master.address}:9091") as relay:
        relay.send(json.dumps({"op": "auth", "mac": token}))
        relay.send(json.dumps({"op": "watch", "robot": int(robot.name.removeprefix("raspberrypi"))}))
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            yield relay.recv(timeout=10)


def test_the_operator_looks_through_a_robots_camera(rehearsal: Rehearsal) -> None:
    """It is not plugged in, which its still picture says."""
    rehearsal.wait_until_complete()
    token = rehearsal.master.run("cat /etc/laserbot/operator-token").strip()
    robot, other = sorted(rehearsal.robots, key=lambda robot: not robot.camera)[:2]
    assert any('"none"' in heard for heard in look(rehearsal, token, other) if isinstance(heard, str))
    assert any("the camera is away" in heard for heard in look(rehearsal, token, robot) if isinstance(heard, str))
    assert any(
        heard[24:].startswith(b"\xff\xd8") for heard in look(rehearsal, token, robot) if isinstance(heard, bytes)
    )


def test_the_operators_desk_shows_the_logs_of_all_hosts(rehearsal: Rehearsal) -> None:
    token = rehearsal.master.run("cat /etc/laserbot/operator-token").strip()

    def said(host: str) -> list[str]:
        answer = requests.get(
            f"{rehearsal.web}/operator/api/journal",
            params={"host": host},
            headers={"Authorization": f"Bearer {token}"},
            timeout=10,
        ).json()
        assert answer["hosts"] == sorted(["laser-bot-master", *(robot.name for robot in rehearsal.robots)])
        return [line["program"] for line in answer["lines"]]

    assert "laserbot-web" in said("laser-bot-master")
    for robot in rehearsal.robots:
        assert "laserbot-robot" in said(robot.name)


ASK = """python3 -c 'from http.client import HTTPConnection
camera = HTTPConnection("{address}", 8090, timeout=5)
camera.request("GET", "/snapshot")
print(camera.getresponse().status)'"""


def test_only_the_master_gets_a_robots_pictures(rehearsal: Rehearsal) -> None:
    robot, other = sorted(rehearsal.robots, key=lambda robot: not robot.camera)[:2]
    ask = ASK.format(address=robot.address)
    assert rehearsal.master.run(ask).strip() == "200"
    assert "TimeoutError" in other.host.run(ask).stderr, "the firewall"
    assert robot.run(ask).strip() == "403", "the camera's own door"
