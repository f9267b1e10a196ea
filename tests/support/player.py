"""A player without a browser: HTTP and rosbridge as any page uses them, and eyes on the arena."""

import contextlib
import json
import math
import random
import threading
import time
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, Protocol

import requests

from laser_bot_battle.geometry import Pose, bearing, wrap
from server.bots.mind import Mind, Skill
from server.bots.paths import Paths
from tests.support.polling import AGAIN, LATEST, until
from tests.support.sockets import connect

SWEEP = math.radians(30)  # off the prey: the light is on
MERCILESS = Skill(mercy=0, reaction=0, aim_error=0, reload=(0, 0), rest=(0, 0), roam_chance=0)


class Place(Protocol):
    """Where a battle is played, as URLs."""

    @property
    def web(self) -> str: ...

    @property
    def bridge(self) -> str: ...

    @property
    def view(self) -> str: ...


class Front(NamedTuple):
    """A place to play at behind its front, which has one address for everything but an arena's view."""

    host: str
    view: str = ""

    @property
    def web(self) -> str:
        return f"http://{self.host}"

    @property
    def bridge(self) -> str:
        return f"ws://{self.host}/rosbridge"


class Bridge(Protocol):
    """A client of rosbridge that drives one robot and watches /game_status."""

    def publish(self, command: Mapping[str, object]) -> None:
        """A laser_bot_battle/Robot_msg for the robot."""

    def heard(self) -> Iterator[dict[str, Any]]:
        """What /game_status said since the last call."""

    def close(self) -> None: ...


class WebSocketBridge:
    """The protocol, bare."""

    def __init__(self, url: str, robot: int, cookies: str) -> None:
        # no bound on what waits to be read: a close must get through even if a test did not look for a while
        self._socket = connect(url, additional_headers={"Cookie": cookies}, max_queue=None)
        self._topic = f"/Robot{robot}/command"
        self._send("subscribe", topic="/game_status", type="laser_bot_battle/GameStatus")
        self._send("advertise", topic=self._topic, type="laser_bot_battle/Robot_msg")

    def _send(self, op: str, **fields: object) -> None:
        self._socket.send(json.dumps({"op": op, **fields}))

    def publish(self, command: Mapping[str, object]) -> None:
        self._send("publish", topic=self._topic, msg=command)

    def heard(self) -> Iterator[dict[str, Any]]:
        with contextlib.suppress(TimeoutError):
            while True:
                message = json.loads(self._socket.recv(timeout=0))
                if message["op"] == "publish":
                    yield message["msg"]

    def close(self) -> None:
        self._socket.close()


class Player:
    """Signs up at once; use as a context manager to sign out and close the sockets."""

    def __init__(self, battle: Place, name: str) -> None:
        self.battle, self.name = battle, name
        self.http = requests.Session()
        reply = self.sign_up()
        assert reply["status"] == "OK", reply
        self.robot: int = reply["robot"]
        self.connect()
        self._gone = threading.Event()
        self._heart = threading.Thread(target=self._beat)
        self._heart.start()

    def sign_up(self) -> dict[str, Any]:
        """As often as it takes: an address has so many sign-ups in a while."""
        while (
            reply := self.http.post(f"{self.battle.web}/signUpUser", data={"data": self.name}, timeout=LATEST)
        ) is not None:
            if reply.status_code != requests.codes.too_many_requests:
                break
            time.sleep(float(reply.headers["Retry-After"]))
        return dict(json.loads(reply.text))

    def _beat(self) -> None:
        """A page that is open asks for the state now and then; one that is silent for 15 s is signed out."""
        with requests.Session() as http:
            http.cookies.update(self.http.cookies)
            while not self._gone.wait(2.0):
                with contextlib.suppress(requests.ConnectionError, requests.Timeout):
                    http.post(f"{self.battle.web}/updateGameStatus", timeout=AGAIN)

    def connect(self) -> None:
        """Open a connection to rosbridge; forget what an earlier one told."""
        self.bridge = self.connect_bridge()
        self.status: dict[str, Any] = {}

    def connect_bridge(self) -> "Bridge":
        """A new connection to rosbridge, with this player's rights."""
        cookies = "; ".join(f"{cookie.name}={cookie.value}" for cookie in self.http.cookies)
        return WebSocketBridge(self.battle.bridge, self.robot, cookies)

    def post(self, route: str, **fields: object) -> dict[str, Any]:
        reply = self.http.post(f"{self.battle.web}/{route}", data=fields, timeout=LATEST)
        return dict(json.loads(reply.text))

    def ready(self, value: int = 1) -> str:
        return str(self.post("playerReady", user=self.name, ready=value)["status"])

    def drive(self, linear: int = 0, angular: int = 0, shoot: bool = False) -> None:
        self.bridge.publish({"linear_x": linear, "angular_z": angular, "shoot": shoot})

    def look(self) -> dict[str, Any]:
        """The newest /game_status (empty before the first)."""
        for status in self.bridge.heard():
            self.status = status
        return self.status

    def user(self, name: str | None = None) -> Mapping[str, Any]:
        """One signed-in player as everybody sees him, empty when he is not there."""
        for user in self.look().get("users", []):
            if user["name"] == (name or self.name):
                return dict(user)
        return {}

    def wait_for_game(self, game: int, seconds: float = 10.0) -> None:
        until(lambda: self.look().get("game") == game, seconds, f"game {game} for {self.name}")

    def __enter__(self) -> "Player":
        return self

    def __exit__(self, *_: object) -> None:
        self._gone.set()
        self._heart.join()
        self.bridge.close()
        with contextlib.suppress(requests.ConnectionError):  # the battle is over
            self.post("signOutUser", data=self.name)
        self.http.close()


def players_and_free_robots(battle: Place) -> tuple[list[tuple[str, int]], int] | None:
    """Who drives which robot, and how many are left; None while the server is away."""
    try:
        users = requests.post(f"{battle.web}/updateGameStatus", timeout=AGAIN).json()["users"]
        free = requests.post(f"{battle.web}/getAvailableRobots", timeout=AGAIN).json()["availableR"]
    except requests.RequestException:
        return None
    return [(user["name"], user["robot"]) for user in json.loads(users)], free


class Eyes:
    """The arena's public view."""

    def __init__(self, battle: Place) -> None:
        self.view = connect(battle.view, max_queue=None)
        self.floor: dict[str, Any] = json.loads(self.view.recv(timeout=LATEST))
        self._robots: dict[int, dict[str, Any]] = {}

    def robots(self) -> dict[int, dict[str, Any]]:
        """All robots on the floor now, by ID."""
        timeout = 5.0 if not self._robots else 0.0
        while True:
            try:
                state = json.loads(self.view.recv(timeout=timeout))
            except TimeoutError:
                return self._robots
            self._robots = {robot["id"]: robot for robot in state["robots"]}
            timeout = 0.0

    def __enter__(self) -> "Eyes":
        return self

    def __exit__(self, *_: object) -> None:
        self.view.close()


class Hunter:
    """Plays as the bot does, but sees at once, aims well and knows no mercy.

    The light is on while it turns to its prey, too: on a busy machine a turn ends late, and only sweeps across it.
    """

    def __init__(self, floor: Mapping[str, Any]) -> None:
        paths = Paths(floor["width"], floor["height"], floor["walls"])
        self._mind = Mind(paths, random.Random(1), MERCILESS)

    def command(self, robots: Mapping[int, Mapping[str, float]], me: int, prey: int) -> tuple[int, int, bool]:
        """What robot `me` must do now (linear_x, angular_z, shoot) to bring robot `prey` down."""
        pose = Pose(robots[me]["x"], robots[me]["y"], robots[me]["heading"])
        others = {number: (robot["x"], robot["y"]) for number, robot in robots.items() if number != me}
        command = self._mind.decide(time.monotonic(), pose, others, [prey])
        off = wrap(bearing(pose.point, others[prey]) - pose.heading)
        return command.linear_x, command.angular_z, command.shoot or abs(off) < SWEEP
