"""A whole master on a machine of a LAN: the ROS master, the game's server, and what announces them."""

import re
import subprocess
import sys
from pathlib import Path

from tests.support.lan import Machine
from tests.support.polling import until
from tests.support.programs import ROOT, Program

NOTHING_GIVEN = dict.fromkeys(("LASERBOT_MASTER", "ROS_MASTER_URI", "ROS_IP"), "")


class LanMaster:
    """The programs of the master, each started again when it ends. A context manager that ends them."""

    def __init__(self, machine: Machine, arena: str, folder: Path) -> None:
        self.machine = machine
        self.arena = arena
        self._env = {
            **NOTHING_GIVEN,
            "PYTHONPATH": f"{ROOT}:{ROOT / 'build/python'}",
            "LASERBOT_ARENA": arena,
            "LASERBOT_BOT_ROBOTS": "0",  # for tests that have bots
            "LASERBOT_SEAT_TIMEOUT": "5",  # a player's session ends with the address at which it was given
            "LASERBOT_DATA": str(folder / f"data-{arena}"),
            "ROS_MASTER_URI": "http://localhost:11311",
            "ROS_HOME": str(folder / f"ros-{arena}"),
            "ROS_LOG_DIR": str(folder / f"ros-{arena}" / "log"),
        }
        self._others: list[Program] = []

    def __enter__(self) -> "LanMaster":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()

    def start(self) -> None:
        """Return when robots can register."""
        ros = self._run("-m", "server.ros.master", "-p", "11311")
        self.start_server()
        self.announcer = self._run("-m", "server.announcer")
        self._others = [ros, self.announcer]
        self.announcer.wait_for(f"arena {self.arena!r} is announced")

    def start_server(self) -> None:
        self.server = self._run("-m", "server.main")
        self.server.wait_for("serving")

    def kill(self) -> None:
        """As a power cut does."""
        for program in (self.server, *self._others):
            program.kill()

    def robots(self) -> int:
        """How many robots players may choose from now; none while the server is away."""
        ask = self.machine.command("curl", "-s", "-X", "POST", "http://127.0.0.1:5000/getAvailableRobots")
        answer = subprocess.run(ask, capture_output=True, text=True, check=False, timeout=30).stdout
        found = re.search(r'"availableR": *"?([0-9]+)', answer)
        return int(found[1]) if found else 0  # it is being started

    def node(self, name: str) -> str:
        """Where ROS finds that node; "" for nowhere."""
        master = "ServerProxy('http://127.0.0.1:11311')"
        code = f"from xmlrpc.client import *; print({master}.lookupNode('/test', {name!r})[2])"
        return self.machine.run(sys.executable, "-c", code).strip()

    def has_robot(self, seconds: float = 30) -> None:
        until(lambda: self.robots() == 1, seconds, f"a robot in {self.arena}")

    def _run(self, *words: str) -> Program:
        again = 'while true; do "$@"; sleep 0.5; done'  # as compose and roslaunch do
        return self.machine.program("sh", "-c", again, "again", sys.executable, *words, env=self._env)


def announced(machine: Machine, *words: str) -> Program:
    """An announcement of tests.support.announcing, on that machine."""
    program = machine.python("tests.support.announcing", *words)
    program.wait_for("announcing")
    return program
