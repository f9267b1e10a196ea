"""Somebody who looks: which camera's newest picture is next, and how many are on their way. Pure."""

from server.access.identity import Claim, Identity
from server.camera.budget import Meter
from server.camera.picture import Picture
from server.websocket.requests import dumps

CREDITS = 2  # pictures that may be on their way to a viewer


class Viewer:
    """One WebSocket. A slow viewer's next picture gives way to a newer one. Time is a monotonic clock in s."""

    def __init__(self, identity: Identity, address: str) -> None:
        self.identity, self.address = identity, address
        self.claim: Claim | None = None  # to be somebody else
        self.wish: int | None = None  # the robot to look through, or ABOVE
        self.robot: int | None = None  # the one that may be looked through
        self._next: Picture | None = None
        self._unseen = 0
        self._told = ""
        self._rate = Meter(0.0)  # of the pictures taken
        self._missed = 0.0  # when a picture gave way last

    def watch(self, robot: int | None) -> None:
        """A new wish: nobody waits for words about the pictures before."""
        self.wish, self._unseen, self._told = robot, 0, ""

    def turn(self, robot: int | None, newest: Picture | None, now: float) -> None:
        """Look through that camera from now on."""
        self.robot, self._next = robot, newest
        self._rate, self._missed = Meter(now), now

    def offer(self, picture: Picture, now: float) -> None:
        """There is a newer picture of the camera."""
        if self._next is not None:
            self._missed = now
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
        self._rate.add(1)
        return picture

    def mark(self, now: float) -> None:
        """To be called now and then: the rate is measured."""
        self._rate.mark(now)

    def rate(self, now: float) -> float:
        """The pictures/s that it takes."""
        return self._rate.rate(now)

    def complete(self, now: float) -> float:
        """The s for which it has missed no picture."""
        return now - self._missed

    def news(self, state: str, reason: str = "") -> str:
        """What to tell of the wish; empty when that has been told."""
        text = dumps({"op": "camera", "robot": self.wish, "state": state, "reason": reason})
        if text == self._told:
            return ""
        self._told = text
        return text
