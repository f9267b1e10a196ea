"""What people who only watch may do: cheer, and vote on the rules of the next battles. Nothing of it is kept.

Whoever votes again changes the vote: one for each device. A device is known by a cookie, which anybody can throw away,
so the votes of one address are bounded, too.
"""

import json
import re
import secrets
import threading
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

from flask import Blueprint, Response, make_response, request

from laser_bot_battle.token_bucket import TokenBuckets
from server.game.people import MAX_NAME
from server.web.visitors import VISITOR

PREFIX = "/audience"
COOKIE = "laserbot_device"
PER_ADDRESS = 64  # devices that may vote from one address
MAX_DEVICES = 5000
SHOWN_AFTER = 60.0  # s that a vote is told after its end
CHEERED = 10.0  # s for which a cheer is told
MAX_CHEERS = 2000  # in that time
_AT_ONCE, _PERIOD = 5, 0.5  # cheers of a device, and s between further ones
_HALL_AT_ONCE, _HALL_PERIOD = 100, 0.05  # of an address
_FRESH = 0.25  # s for which an answer is given to everybody
_DEVICE = re.compile(r"[0-9a-f]{32}")


@dataclass(frozen=True, slots=True)
class Ballot:
    """What the operator lets people choose from."""

    number: int  # grows from vote to vote
    choices: tuple[tuple[str, bool], ...]  # presets: the name, and whether it is an operator's own
    ends_at: float  # of this machine's monotonic clock, s


class Audience:
    """Thread-safe. `now` is of this machine's monotonic clock, in s."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._ballot: Ballot | None = None
        self._votes: dict[str, int] = {}  # device -> choice
        self._devices: Counter[str] = Counter()  # of each address
        self._cheers: deque[tuple[float, str]] = deque(maxlen=MAX_CHEERS)
        self._by_device = TokenBuckets(_AT_ONCE, _PERIOD)
        self._by_address = TokenBuckets(_HALL_AT_ONCE, _HALL_PERIOD)

    def open(self, ballot: Ballot) -> None:
        """Let people vote; with the number of a vote that is open, change its end."""
        with self._lock:
            if self._ballot is None or self._ballot.number != ballot.number:
                self._votes.clear()
                self._devices.clear()
            self._ballot = ballot

    def vote(self, device: str, address: str, number: int, choice: int, now: float) -> HTTPStatus:
        with self._lock:
            ballot = self._ballot
            if ballot is None or ballot.number != number or now >= ballot.ends_at:
                return HTTPStatus.GONE
            if not 0 <= choice < len(ballot.choices):
                return HTTPStatus.BAD_REQUEST
            if device not in self._votes:
                if self._devices[address] >= PER_ADDRESS or len(self._votes) >= MAX_DEVICES:
                    return HTTPStatus.TOO_MANY_REQUESTS
                self._devices[address] += 1
            self._votes[device] = choice
            return HTTPStatus.OK

    def cheer(self, device: str, address: str, name: str, now: float) -> HTTPStatus:
        if not 0 < len(name) <= MAX_NAME:
            return HTTPStatus.BAD_REQUEST
        if self._by_device.take(device, now) or self._by_address.take(address, now):
            return HTTPStatus.TOO_MANY_REQUESTS
        with self._lock:
            self._cheers.append((now, name))
        return HTTPStatus.OK

    def told(self, now: float) -> dict[str, Any]:
        """What everybody may know (docs/protocol-browser.md)."""
        with self._lock:
            while self._cheers and self._cheers[0][0] < now - CHEERED:
                self._cheers.popleft()
            return {"vote": self._vote(now), "cheers": dict(Counter(name for _, name in self._cheers).most_common(64))}

    def _vote(self, now: float) -> dict[str, Any] | None:
        if self._ballot is None or now >= self._ballot.ends_at + SHOWN_AFTER:
            return None
        counts = Counter(self._votes.values())
        choices = [
            {"name": name, "own": own, "votes": counts[index]} for index, (name, own) in enumerate(self._ballot.choices)
        ]
        left = max(0.0, self._ballot.ends_at - now)
        return {"number": self._ballot.number, "choices": choices, "seconds_left": round(left, 1)}


def create_audience(audience: Audience, clock: Callable[[], float] = time.monotonic) -> Blueprint:
    """The routes, as a Flask blueprint."""
    routes = Blueprint("audience", __name__, url_prefix=PREFIX)
    lock = threading.Lock()
    made: tuple[float, str] = (-_FRESH, "")

    @routes.get("")
    def told() -> Response:
        nonlocal made
        now = clock()
        with lock:
            if now - made[0] >= _FRESH:
                made = now, json.dumps(audience.told(now), ensure_ascii=False)
            response = make_response(made[1], 200, {"Content-Type": "application/json; charset=utf-8"})
        if not _device():
            response.set_cookie(COOKIE, secrets.token_hex(16), path=PREFIX, httponly=True, samesite="Lax")
        return response

    @routes.post("/vote")
    def vote() -> Response:
        number, choice = request.args.get("number", -1, int), request.args.get("choice", -1, int)
        return _answer(
            audience.vote(_device(), _address(), number, choice, clock()) if _device() else HTTPStatus.FORBIDDEN
        )

    @routes.post("/cheer")
    def cheer() -> Response:
        name = request.args.get("name", "")
        return _answer(audience.cheer(_device(), _address(), name, clock()) if _device() else HTTPStatus.FORBIDDEN)

    return routes


def _device() -> str:
    """What the visitor's cookie says; "" without one, as one has it that has just come."""
    found = request.cookies.get(COOKIE, "")
    return found if _DEVICE.fullmatch(found) else ""


def _address() -> str:
    return request.headers.get(VISITOR, "")


def _answer(status: HTTPStatus) -> Response:
    return make_response("{}", status, {"Content-Type": "application/json"})
