"""A running arena, and robots' hardware without robots: sockets that speak the arena's link."""

import json
import math
import socket
import struct
from types import TracebackType
from typing import Any, Self

from laser_bot_battle.geometry import METRES_PER_HALF_STEP, TRACK
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.sockets import connect

HOST = "127.0.0.1"
CHUNK = 4000  # half-steps in one report


class Arena:
    """`python3 -m sim.arena` on free ports."""

    def __init__(self, *options: str) -> None:
        self._options = options
        self.view_port, self.link_port = free_port(), free_port()
        self.env = {
            "LASERBOT_BIND": HOST,
            "LASERBOT_ARENA_PORT": str(self.view_port),
            "LASERBOT_ARENA_LINK_PORT": str(self.link_port),
        }
        self.start()

    def start(self) -> None:
        self.program = Program.python("sim.arena", *self._options, env=self.env)
        self.program.wait_for("robots connect to port")

    @property
    def view_url(self) -> str:
        return f"ws://{HOST}:{self.view_port}/view"

    @property
    def page(self) -> str:
        return f"http://{HOST}:{self.view_port}/"

    def look(self) -> dict[str, dict[str, Any]]:
        """The robots now on the floor, by name, as a new viewer sees them."""
        with connect(self.view_url) as view:
            assert json.loads(view.recv(timeout=LATEST))["type"] == "arena"
            state = json.loads(view.recv(timeout=LATEST))
        assert state["type"] == "state"
        return {robot["name"]: robot for robot in state["robots"]}


class Hardware:
    """One robot's hardware. Use it in a `with`."""

    def __init__(self, arena: Arena, name: str | None, wheels: tuple[int, int] = (0, 0)) -> None:
        """Say hello as `name`; say nothing if it is None."""
        self._socket = socket.create_connection((HOST, arena.link_port), timeout=LATEST)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._lines = self._socket.makefile("rb")
        self.left, self.right = wheels
        self._arena = arena
        self._name = name
        if name:
            self.send(f"robot {name}", f"wheels {self.left} {self.right}", "beam 0")

    def send(self, *lines: str) -> None:
        self.send_raw("".join(f"{line}\n" for line in lines).encode())

    def send_raw(self, data: bytes) -> None:
        self._socket.sendall(data)

    def line(self) -> str:
        """The next line from the arena, within 5 s; "" at the end of the connection."""
        try:
            return self._lines.readline().decode().rstrip("\n")
        except ConnectionResetError:
            return ""

    def turn_wheels(self, left: float, right: float) -> None:
        """Roll the wheels `left` and `right` m forward, in the reports of a robot, and wait for the arena to follow."""
        left_steps, right_steps = round(left / METRES_PER_HALF_STEP), round(right / METRES_PER_HALF_STEP)
        parts = max(1, math.ceil(max(abs(left_steps), abs(right_steps)) / CHUNK))
        start = (self.left, self.right)
        for part in range(1, parts + 1):
            self.left, self.right = start[0] - left_steps * part // parts, start[1] + right_steps * part // parts
            self.send(f"wheels {self.left} {self.right}")

    def look(self) -> dict[str, Any]:
        assert self._name
        return self._arena.look()[self._name]

    def face(self, heading: float) -> None:
        """Turn in place until looking at `heading` (rad)."""
        turn = math.remainder(heading - self.look()["heading"], math.tau)
        self.turn_wheels(-turn * TRACK / 2, turn * TRACK / 2)
        until(lambda: abs(math.remainder(self.look()["heading"] - heading, math.tau)) < 0.01, 5, "turned")

    def drive_to(self, x: float, y: float) -> None:
        """Straight to a point that nothing is in front of."""
        me = self.look()
        distance = math.dist((me["x"], me["y"]), (x, y))
        self.face(math.atan2(y - me["y"], x - me["x"]))
        self.turn_wheels(distance, distance)
        until(lambda: math.dist((self.look()["x"], self.look()["y"]), (x, y)) < 0.01, 5, f"at {x}, {y}")

    def wait_longer(self, seconds: float) -> None:
        """Let line() wait so long."""
        self._socket.settimeout(seconds)

    def reset(self) -> None:
        """End the connection as a crashed host does, by RST."""
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.close()

    def close(self) -> None:
        self._lines.close()
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
