"""A viewer at the cameras' relay, on a bare socket: cheap enough for a crowd (docs/protocol-camera.md)."""

import json
import select
import struct
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from tests.support.bare import BINARY, CLOSE, PING, PONG, TEXT, BareClient, frame
from tests.support.fake_camera import Mark, mark_of
from tests.support.polling import Patience

_HEADER = struct.Struct("<B3xIdd")


class Shot(NamedTuple):
    """A picture, as it has come."""

    robot: int
    number: int
    taken: float  # s, Unix time of the relay
    sent: float
    jpeg: bytes

    @property
    def mark(self) -> Mark:
        """Of a FakeCamera's picture."""
        return mark_of(self.jpeg)


class Viewer(BareClient):
    """Draws each picture at once, and says so. `states` are the states that were told, `shots` counts the pictures."""

    def __init__(
        self, port: int, token: str = "", headers: Mapping[str, str] | None = None, *, receive_buffer: int = 0
    ) -> None:
        """`token` is that of the session cookie."""
        cookie = {"Cookie": f"laserbot_session={token}"} if token else {}
        super().__init__(port, {**cookie, **(headers or {})}, receive_buffer=receive_buffer)
        self.states: list[tuple[int, str, str]] = []  # robot, state, reason
        self.shots = 0
        self.draws = True  # says `seen`

    def watch(self, robot: int | None) -> None:
        self.say("watch", robot=robot)

    def operate(self, token: str = "the operators' token") -> "Viewer":
        self.say("auth", mac=token)
        return self

    def metrics(self) -> dict[str, Any]:
        """An operator's; pictures may come before."""
        self.say("figures")
        return self.wait(lambda message: isinstance(message, dict) and message["op"] == "figures")

    def next(self, seconds: float = 10.0) -> dict[str, Any] | Shot:
        """The next message. AssertionError when none has come in time, ConnectionError at the end."""
        patience = Patience(seconds)
        while not patience.is_over:
            opcode, payload = self.hear_frame()
            if opcode == PING:
                self.send(frame(payload, PONG))
            elif opcode == CLOSE:
                raise ConnectionError(f"closed with {int.from_bytes(payload[:2], 'big')}")
            elif opcode == TEXT:
                return self._told(json.loads(payload))
            elif opcode == BINARY:
                return self._shown(payload)
        raise AssertionError(f"nothing within {seconds} s; {self.states=}, {self.shots=}")

    def wait(self, wanted: Callable[[Any], bool], seconds: float = 10.0) -> Any:
        """The next message that is wanted; AssertionError when none has come in time."""
        patience = Patience(seconds)
        while not patience.is_over:
            message = self.next()
            if wanted(message):
                return message
        raise AssertionError(f"not within {seconds} s; {self.states=}, {self.shots=}")

    def picture(self, of: Callable[[Shot], bool] = lambda shot: True) -> Shot:
        """The next picture `of` which it is."""
        shot: Shot = self.wait(lambda message: isinstance(message, Shot) and of(message))
        return shot

    def state(self, state: str, robot: int | None = None) -> str:
        """Wait until the relay tells this state of the camera; its reason."""
        told = self.wait(
            lambda message: (
                isinstance(message, dict)
                and (message["op"], message.get("state")) == ("camera", state)
                and robot in (None, message["robot"])
            )
        )
        return str(told["reason"])

    def waits(self, reason: str) -> bool:
        """Wait until the relay tells that pictures are awaited, and this reason."""
        self.wait(lambda message: isinstance(message, dict) and message.get("reason") == reason)
        return self.states[-1][1] == "waiting"

    def error(self) -> str:
        """Wait until a status of level error comes; its text."""
        message = self.wait(lambda message: isinstance(message, dict) and message["op"] == "status")
        assert message["level"] == "error"
        return str(message["msg"])

    def drain(self) -> list[dict[str, Any] | Shot]:
        """All that has come already."""
        messages = []
        while self._received or select.select([self.socket], [], [], 0)[0]:
            messages.append(self.next())
        return messages

    def sees_nothing_while(self, other: "Viewer", pictures: int = 5) -> bool:
        """AssertionError when a picture comes, while the `other` gets so many."""
        self.drain()
        for _ in range(pictures):
            other.picture()
        shots = [message for message in self.drain() if isinstance(message, Shot)]
        assert not shots, f"{len(shots)} pictures of robot {shots[0].robot}"
        return True

    def _told(self, message: dict[str, Any]) -> dict[str, Any]:
        if message["op"] == "camera":
            self.states.append((message["robot"], message["state"], message["reason"]))
        return message

    def _shown(self, payload: bytes) -> Shot:
        self.shots += 1
        if self.draws:
            self.say("seen")
        robot, number, taken, sent = _HEADER.unpack_from(payload)
        return Shot(robot, number, taken, sent, payload[_HEADER.size :])


def look(viewers: Iterable[Viewer], is_over: Callable[[], bool]) -> None:
    """All of them read whatever comes, until it is over."""
    by_socket = {viewer.socket: viewer for viewer in viewers}
    while not is_over():
        for ready in select.select(list(by_socket), [], [], 1.0)[0]:
            by_socket[ready].drain()
