"""Somebody who looks: which camera's newest picture is next, and how many are on their way. Pure."""

from server.access.identity import Claim, Identity
from server.camera.picture import Picture
from server.websocket.requests import dumps

CREDITS = 2  # pictures that may be on their way to a viewer


class Viewer:
    """One WebSocket. A slow viewer's next picture gives way to a newer one."""

    def __init__(self, identity: Identity, address: str) -> None:
        self.identity, self.address = identity, address
        self.claim: Claim | None = None  # to be somebody else
        self.wish: int | None = None  # the robot to look through, or ABOVE
        self.robot: int | None = None  # the one that may be looked through
        self._next: Picture | None = None
        self._unseen = 0
        self._told = ""

    def watch(self, robot: int | None) -> None:
        """A new wish: nobody waits for words about the pictures before."""
        self.wish, self._unseen, self._told = robot, 0, ""

    def turn(self, robot: int | None, newest: Picture | None) -> None:
        """Look through that camera from now on."""
        self.robot, self._next = robot, newest

    def offer(self, picture: Picture) -> None:
        """There is a newer picture of the camera."""
        self._next = picture

    def seen(self) -> None:
        """One of the pictures has been drawn, or was dropped."""
        self._unseen = max(0, self._unseen - 1)

    @property
    def is_hungry(self) -> bool:
        """Whether `take` has a picture."""
        return self._next is not None and self._unseen < CREDITS

    def take(self) -> Picture:
        """The picture to send now."""
        assert self._next is not None
        picture, self._next = self._next, None
        self._unseen += 1
        return picture

    def news(self, state: str, reason: str = "") -> str:
        """What to tell of the wish; empty when that has been told."""
        text = dumps({"op": "camera", "robot": self.wish, "state": state, "reason": reason})
        if text == self._told:
            return ""
        self._told = text
        return text
