"""Both ends of a rosbridge under test: ROS on one, WebSockets on the other."""

import contextlib
import hashlib
import itertools
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from types import TracebackType
from typing import Any, Self

import cbor2
from websockets.sync.client import ClientConnection

from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.sockets import connect

FORWARD = {"linear_x": 1, "angular_z": 0, "shoot": False}
NEUTRAL = {"linear_x": 0, "angular_z": 0, "shoot": False}
COMMAND_TYPE = "laser_bot_battle/Robot_msg"
STATUS_TYPE = "laser_bot_battle/GameStatus"


class RosSide:
    """The process of ros_side.py: referee, robots and services."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.integration.rosbridge.ros_side"],
            env={**os.environ, **environment}, cwd=ROOT, text=True, bufsize=1,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip
        self._lines: list[dict[str, Any]] = []
        self._listening: set[str] = set()
        self._reader = threading.Thread(target=self._read)
        self._reader.start()
        try:
            until(lambda: self._lines, what="the ROS side")
        except AssertionError:
            self.close()
            raise

    def status(self, game: int, *users: dict[str, Any], **fields: Any) -> None:
        """The referee's word: `users` as made by `player`, and further fields of a GameStatus."""
        self._say(status={"game": game, "users": list(users), **fields})

    def publish(self, topic: str, kind: str, **fields: Any) -> None:
        self._say(publish=[topic, kind, fields])

    def listen(self, topic: str, kind: str = COMMAND_TYPE) -> None:
        """Hear a topic from now on. It waits: rospy misses a publisher that appears in the moment of subscribing."""
        if topic not in self._listening:
            self._listening.add(topic)
            self._say(listen=[topic, kind])
            until(lambda: {"listens": topic} in self._lines, what=f"the ROS side listens to {topic}")

    def heard(self, topic: str) -> list[dict[str, Any]]:
        """All messages of a topic that is listened to, so far."""
        return [line["heard"][1] for line in self._lines if line.get("heard", [None])[0] == topic]

    def freeze(self, frozen: bool) -> None:
        """Stand still, as behind a cut network; or go on."""
        self._process.send_signal(signal.SIGSTOP if frozen else signal.SIGCONT)

    def close(self) -> None:
        assert self._process.stdin and self._process.stdout
        try:
            self._process.stdin.close()
            self._process.wait(5)
        except (BrokenPipeError, subprocess.TimeoutExpired):
            self._process.kill()
            self._process.wait()
        self._reader.join()
        self._process.stdout.close()

    def _say(self, **line: Any) -> None:
        assert self._process.stdin
        self._process.stdin.write(json.dumps(line) + "\n")

    def _read(self) -> None:
        assert self._process.stdout
        for line in self._process.stdout:
            self._lines.append(json.loads(line))


class Client:
    """A WebSocket client that speaks bare JSON."""

    def __init__(self, port: int, token: str = "", **headers: str) -> None:
        if token:
            headers["Cookie"] = f"theme=dark; laserbot_session={token}"
        self.socket: ClientConnection = connect(
            f"ws://127.0.0.1:{port}", additional_headers=headers, max_queue=None, max_size=None
        )

    def say(self, op: str, **fields: Any) -> None:
        self.socket.send(json.dumps({"op": op, **fields}))

    def hear(self, seconds: float = 5.0) -> dict[str, Any]:
        """The next message; TimeoutError when none comes."""
        return dict(json.loads(self.socket.recv(timeout=seconds)))

    def hear_cbor(self, seconds: float = 10.0) -> dict[str, Any]:
        """The next message, which is a binary one."""
        message = self.socket.recv(timeout=seconds)
        assert isinstance(message, bytes), message
        return dict(cbor2.loads(message))

    def hear_error(self) -> str:
        """The text of the next message, which is a status of level error."""
        message = self.hear()
        assert (message["op"], message["level"]) == ("status", "error"), message
        return str(message["msg"])

    def hears_nothing(self, seconds: float = 0.3) -> bool:
        """AssertionError when something comes."""
        try:
            message = self.hear(seconds)
        except TimeoutError:
            return True
        raise AssertionError(f"heard {message}")

    def hears_nothing_for_now(self, seconds: float = 0.3) -> bool:
        """Drop what comes within that time; true when nothing did."""
        try:
            self.hear(seconds)
        except TimeoutError:
            return True
        return False

    def operate(self, token: str = "the operators' token") -> Self:
        self.say("auth", client="operator", mac=token)
        return self

    def advertise(self, robot: int) -> None:
        self.say("advertise", topic=f"/Robot{robot}/command", type=COMMAND_TYPE)

    def drive(self, robot: int, command: Mapping[str, Any] = FORWARD) -> None:
        self.say("publish", topic=f"/Robot{robot}/command", msg=command)

    def watch(self) -> None:
        self.say("subscribe", topic="/game_status", type=STATUS_TYPE)

    def hear_status(self, game: int) -> dict[str, Any]:
        """Wait until /game_status says this state of the battle."""
        deadline = time.monotonic() + 5
        while time.monotonic() < deadline:
            message = self.hear()
            if message["op"] == "publish" and message["msg"]["game"] == game:
                return dict(message["msg"])
        raise AssertionError(f"no game {game}")

    def close(self) -> None:
        self.socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def join(publish: Callable[[Any], object], listener: Client, data: Callable[[int], Any] = str) -> Any:
    """Publish `data` of 0, 1, ... until the listener hears the newest: all before it have come, or never will.

    Returns the newest.
    """
    numbers = itertools.count()
    newest: Any = None

    def heard() -> bool:
        nonlocal newest
        newest = data(next(numbers))
        publish(newest)
        with contextlib.suppress(TimeoutError):
            while listener.hear(0.3)["msg"]["data"] != newest:
                pass
            return True
        return False

    until(heard, 20, "the publisher and the listener have found each other")
    return newest


def player(name: str, token: str, robot: int, life: int = 100, ready: bool = True) -> dict[str, Any]:
    """A UserStatus."""
    session = hashlib.sha256(token.encode()).hexdigest()
    return {"name": name, "session": session, "robot": robot, "life": life, "ready": ready}
