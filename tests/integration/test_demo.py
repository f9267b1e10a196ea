"""`ci/demo` as a user meets it: what it says, what it refuses, and that nothing is left behind."""

import contextlib
import json
import math
import os
import re
import signal
import socket

import pytest
import requests
from websockets.exceptions import WebSocketException
from websockets.sync.connection import Connection

from tests.support.battle import PORTS, Battle
from tests.support.demo import Demo
from tests.support.play import hunt_down, obeys, start
from tests.support.player import Eyes, Player, players_and_free_robots
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.processes import command_line, descendants
from tests.support.programs import ROOT, Program
from tests.support.sockets import connect


def run_demo(*words: str, **variables: str) -> Program:
    return Program([str(ROOT / "ci" / "demo"), *words], variables)


def refusal(program: Program) -> str:
    """What a demo that will not start says; it must end by itself with an error."""
    until(lambda: not program.running, 20, "the demo gives up")
    assert program.process.returncode not in (0, None)
    assert "Traceback" not in program.output
    return program.output


def become_operator(bridge: Connection, battle: Battle, token: str) -> None:
    bearer = {"Authorization": f"Bearer {token}"}
    drive = requests.get(f"{battle.web}/operator/api/drive", headers=bearer, timeout=LATEST).json()
    assert drive["port"] == battle.rosbridge_port
    bridge.send(json.dumps({"op": "auth", "client": "operator", "mac": drive["ticket"]}))


@pytest.mark.parametrize("sig", [signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.slow)])
def test_a_signal_stops_everything_and_leaves_no_process(sig: signal.Signals) -> None:
    battle = Battle(robots=2, bots=1)
    try:
        battle.wait_until_ready()
        output = battle.program.output
        assert f"http://localhost:{battle.web_port}" in output
        assert f"http://localhost:{battle.arena_port}" in output
        (token,) = re.findall(rf"localhost:{battle.web_port}/operator .* token (\S+)\n", output)
        with connect(battle.bridge) as bridge:  # rosbridge has the same token
            become_operator(bridge, battle, token)
            bridge.send(json.dumps({"op": "call_service", "service": "/rosapi/get_time"}))
            assert json.loads(bridge.recv(timeout=LATEST))["result"] is True
        until(lambda: players_and_free_robots(battle) == ([("Bot1", 1)], 1), 10, "one robot is a person's")
        below = descendants(battle.program.process.pid)
        assert len(below) > 8
    finally:
        code = battle.program.stop(sig, seconds=30)
    assert code == 0, battle.program.output
    assert battle.program.output.endswith("Stopped.\n")
    assert [part for part in below if command_line(part)] == []
    for port in battle.ports.values():
        with socket.socket() as probe:
            assert probe.connect_ex(("127.0.0.1", port)) != 0


def test_make_demo_starts_and_ctrl_c_ends_it() -> None:
    ports = {variable: str(free_port()) for variable in PORTS}
    program = Program(["make", "-C", str(ROOT), "demo", "ROBOTS=4", "BOTS=2"], ports)
    try:
        output = program.wait_for("Ctrl-C stops everything", 90)
        below = descendants(program.process.pid)
    finally:
        os.killpg(program.process.pid, signal.SIGINT)  # as a terminal does
        program.exit_code(30)
    assert "ready: 4 virtual robots" in output
    assert "ready: 2 bots" in output
    assert "2 people can play" in output
    assert [part for part in below if command_line(part)] == []


@pytest.mark.slow
def test_a_killed_demo_takes_its_processes_with_it() -> None:
    battle = Battle(robots=1, bots=0)
    try:
        battle.wait_until_ready()
        below = descendants(battle.program.process.pid)
    finally:
        battle.program.process.kill()
        battle.program.process.wait()
    until(
        lambda: not [part for part in below if command_line(part)],
        30,
        "all processes of the killed demo are gone",
    )


@pytest.mark.slow
def test_everybody_finds_the_way_back_after_the_ros_master_is_killed_in_a_battle() -> None:
    with Battle(robots=3, bots=1, LASERBOT_COUNTDOWN="1") as battle:
        first_master = battle.pid("server.ros.master")
        with Player(battle, "Ann") as ann, Player(battle, "Ben") as ben, Eyes(battle) as eyes:
            start(ann, ben)
            os.kill(first_master, signal.SIGKILL)
            until(lambda: battle.log.count("serving the game") == 2, 60, "the game server has the new master")
            until(lambda: fights_again(ann, ben, eyes), 90, "the same players fight again")
        assert battle.pid("server.ros.master") != first_master
        assert battle.program.output.count("The ROS master has ended: starting it again.") == 1
        below = descendants(battle.program.process.pid)
    assert [part for part in below if command_line(part)] == []


def fights_again(player: Player, other: Player, eyes: Eyes) -> bool:
    """Whether the player's robot obeys; both get ready if there is no battle any more."""
    with contextlib.suppress(AssertionError, OSError, WebSocketException):
        player.bridge.close()
        player.connect()
        player.ready()
        other.ready()
        obeys(player, eyes, 5)
        return True
    return False


@pytest.mark.parametrize("light", ["coded", "plain"])
def test_robots_can_be_hit_by_the_light_of_either_rule(demo: Demo, light: str) -> None:
    demo.play_by(countdown=1, light=light)
    with Player(demo, "Ann") as ann, Player(demo, "Ben") as ben, Eyes(demo) as eyes:
        start(ann, ben)
        hunt_down(ann, ben, eyes, life=90)


@pytest.mark.slow
def test_with_a_camera_above_robots_have_the_places_that_it_sees_and_a_bot_drives_by_them() -> None:
    options = ("--overhead", "--overhead-tilt=10", "--overhead-lens=-0.2", "--overhead-height=3")
    with (
        Battle(2, 1, *options, LASERBOT_OPERATOR_TOKEN="the hall is open", LASERBOT_COUNTDOWN="1") as battle,
        Eyes(battle) as eyes,
        connect(battle.bridge) as bridge,
    ):
        become_operator(bridge, battle, "the hall is open")
        bridge.send(json.dumps({"op": "subscribe", "topic": "/positions", "type": "laser_bot_battle/Positions"}))

        def places() -> dict[int, tuple[float, float]]:
            robots = json.loads(bridge.recv(timeout=LATEST))["msg"]["robots"]
            return {robot["robot"]: (robot["x"], robot["y"]) for robot in robots}

        until(lambda: len(places()) == 2, 30, "both robots have places")
        found = places()
        for number, robot in eyes.robots().items():
            assert math.dist(found[number], (robot["x"], robot["y"])) < 0.015
        commands = [command_line(part) for part in descendants(battle.program.process.pid)]
        assert not any("sim.positions" in command for command in commands)
        with Player(battle, "Ann") as ann:
            (bots,) = set(found) - {ann.robot}
            ann.ready()
            until(lambda: math.dist(places().get(bots, found[bots]), found[bots]) > 0.2, 30, "the bot has driven on")


def test_a_port_in_use_is_one_clear_line() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        output = refusal(run_demo(LASERBOT_WEB_PORT=str(port), LASERBOT_ROSBRIDGE_PORT=str(port + 1)))
    line = output.strip().splitlines()[-1]
    assert f"port {port} (the game)" in line
    assert "perhaps another demo is running" in line
    advised = re.search(r"LASERBOT_WEB_PORT=(\d+) make demo", line)
    assert advised
    assert int(advised[1]) > port + 1, "which is another part's"


@pytest.mark.parametrize(
    ("words", "variables", "complaint"),
    [
        (["--robots", "two"], {}, "make demo: --robots: 'two' is not a whole number from 1 to 8 (ci/demo --help"),
        (["--robots", "0", "--bots", "0"], {}, "'0' is not a whole number from 1 to 8"),
        (["--robots", "9"], {}, "'9' is not a whole number from 1 to 8"),
        (["--robots", "1", "--bots", "2"], {}, "2 bots cannot play with 1 robot: start more robots"),
        ([], {"LASERBOT_BIND": "192.0.2.2"}, "choose 127.0.0.1 (this machine only) or 0.0.0.0 (the network too)"),
        ([], {"LASERBOT_HIT_DAMAGE": "abc"}, "LASERBOT_HIT_DAMAGE=abc: must be a whole number from 1 to 100"),
        ([], {"LASERBOT_WEB_PORT": "http"}, "LASERBOT_WEB_PORT=http: must be a whole number from 1 to 65535"),
        ([], {"LASERBOT_ROSBRIDGE_PORT": "0"}, "LASERBOT_ROSBRIDGE_PORT=0: must be a whole number from 1 to 65535"),
        ([], {"LASERBOT_WEB_PORT": "7001", "LASERBOT_ARENA_PORT": "7001"}, "are both 7001"),
    ],
)
def test_bad_input_is_refused_in_plain_words(words: list[str], variables: dict[str, str], complaint: str) -> None:
    assert complaint in refusal(run_demo(*words, **variables))
