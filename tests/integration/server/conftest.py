"""The server as a child process at a real ROS master, with robots and listeners that are ROS nodes."""

import json
import re
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
import requests

from server.game.robot import HIT_INTERVAL
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import HOST, RosMaster, own_master, ros_master

__all__ = ["own_master", "ros_master"]

PEERS = "tests.integration.server.peers"


class GameServer:
    """`python -m server.main`; it and its peers end with the test."""

    def __init__(self, master: RosMaster, data: Path, within: Sequence[str], **variables: str) -> None:
        self._within = within
        self.port = free_port()
        self.url = f"http://{HOST}:{self.port}"
        self._peers_env = master.env
        self._env = {
            **master.env,
            "LASERBOT_BIND": HOST,
            "LASERBOT_WEB_PORT": str(self.port),
            "LASERBOT_DATA": str(data),
            "LASERBOT_PROTECTION": "0",
            # these players give no sign of life, however long a busy machine takes for what is tested
            "LASERBOT_PLAYER_TIMEOUT": "600",
            "LASERBOT_SEAT_TIMEOUT": "600",
            **variables,
        }
        self._started: list[Program] = []
        self.program = self.launch()

    def launch(self) -> Program:
        """Start (again) without waiting for anything."""
        self.program = self._keep(Program([*self._within, sys.executable, "-m", "server.main"], env=self._env))
        return self.program

    def wait_until_serving(self) -> None:
        self.program.wait_for("serving the game")

    def peer(self, *words: str) -> Program:
        return self._keep(Program.python(PEERS, *words, env=self._peers_env))

    def robot(self, name: str) -> "RobotPeer":
        """A robot that registers, and can be driven soon."""
        robot = RobotPeer(self.peer("robot", name, self.url))
        if name != "-":
            until(lambda: self.is_linked(robot.id), 10, f"the server has seen robot {robot.id} on its topics")
        return robot

    def is_linked(self, robot_id: int) -> bool:
        """Whether the server says that the robot can be driven."""
        said = re.findall(rf"robot {robot_id} is (on its|not on its|gone)", self.program.output)
        return bool(said) and said[-1] == "on its"

    def listener(self) -> "StatusPeer":
        return StatusPeer(self.peer("status"))

    def player(self, name: str) -> "Page":
        """A page on which `name` has signed up."""
        page = Page(self)
        assert page.post("signUpUser", data=name)["status"] == "OK"
        page.name = name
        return page

    def post(self, route: str, **fields: object) -> dict[str, Any]:
        return Page(self).post(route, **fields)

    def end(self) -> None:
        for program in reversed(self._started):
            if program.running:
                program.kill()

    def _keep(self, program: Program) -> Program:
        self._started.append(program)
        return program


class Page:
    """A browser's cookies and calls."""

    def __init__(self, server: GameServer) -> None:
        self._url = server.url
        self._http = requests.Session()
        self.name = ""

    def post(self, route: str, **fields: object) -> dict[str, Any]:
        with self._http.post(f"{self._url}/{route}", data=fields, timeout=LATEST) as response:
            content: dict[str, Any] = response.json()
        return content

    def ready(self) -> None:
        assert self.post("playerReady", user=self.name, ready=1)["status"] == "OK"

    def close(self) -> None:
        self._http.close()


class RobotPeer:
    """A registered robot that pings."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.wait_for_registration(1)

    def wait_for_registration(self, times: int) -> None:
        until(lambda: len(self.ids) >= times, 15, f"registration {times}")

    @property
    def ids(self) -> list[int]:
        """The IDs that it was given, oldest first."""
        return [int(robot_id) for robot_id in re.findall(r"registered (\d+)", self.program.output)]

    @property
    def id(self) -> int:
        return self.ids[-1]

    def hit(self) -> None:
        """Not sooner than the firmware reports it after one that the server has heard of only now."""
        due = time.monotonic() + HIT_INTERVAL
        until(lambda: time.monotonic() >= due)
        self.program.process.send_signal(signal.SIGUSR1)

    def vanish(self) -> None:
        self.program.kill()


class StatusPeer:
    """What a subscriber of /game_status has heard."""

    def __init__(self, program: Program) -> None:
        self.program = program
        until(lambda: self.heard, 10, "a first /game_status")

    @property
    def heard(self) -> list[dict[str, Any]]:
        complete, _, _ = self.program.output.rpartition("\n")
        return [json.loads(line) for line in complete.splitlines() if line.startswith("{")]

    @property
    def latest(self) -> dict[str, Any]:
        return self.heard[-1]

    def wait_for(self, condition: Callable[[dict[str, Any]], bool], seconds: float = 10.0) -> dict[str, Any]:
        """The latest status, as soon as it meets the condition."""
        return until(lambda: (latest := self.latest) and condition(latest) and latest, seconds, "a /game_status")

    def wait_for_life(self, name: str, life: int) -> None:
        self.wait_for(lambda status: any(u["name"] == name and u["life"] == life for u in status["users"]))


@pytest.fixture
def launch(ros_master: RosMaster, tmp_path: Path) -> Iterator[Callable[..., GameServer]]:
    """Start servers with these LASERBOT_ variables at the module's master, or at `master`; `within` is the beginning of
    the command, such as nsenter and its options."""
    servers: list[GameServer] = []

    def start(master: RosMaster = ros_master, within: Sequence[str] = (), **variables: str) -> GameServer:
        servers.append(GameServer(master, tmp_path / "data", within, **variables))
        return servers[-1]

    yield start
    for server in servers:
        server.end()


@pytest.fixture
def server(launch: Callable[..., GameServer]) -> GameServer:
    """A server that serves, with short rules: countdown 1 s, damage 40."""
    server = launch(LASERBOT_COUNTDOWN="1", LASERBOT_HIT_DAMAGE="40")
    server.wait_until_serving()
    return server
