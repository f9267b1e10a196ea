"""Who is served next."""

import threading
import time
from collections.abc import Iterator

import pytest

from server.web.lanes import BURST, RATE, REFUSED, Lane, Lanes
from tests.support.polling import until


class Request:
    """One of `owner`; its thread waits until it is `let_go`."""

    def __init__(self, served: list[str], lane: Lane, owner: str | None, is_held: bool = False) -> None:
        self.served, self.lane, self.owner = served, lane, owner
        self.has_begun, self.let_go, self.is_cancelled = threading.Event(), threading.Event(), False
        if not is_held:
            self.let_go.set()

    def service(self) -> None:
        self.has_begun.set()
        self.let_go.wait(10)
        self.served.append(self.owner or "")

    def cancel(self) -> None:
        self.is_cancelled = True


class Server:
    """Lanes of one thread each."""

    def __init__(self) -> None:
        self.lanes = Lanes(lambda task: (task.lane, task.owner), dict.fromkeys(Lane, 1))  # type: ignore[attr-defined]
        self.served: list[str] = []
        self._held: list[Request] = []

    def ask(self, lane: Lane, owner: str | None) -> Request:
        return self._add(Request(self.served, lane, owner))

    def hold(self, lane: Lane, owner: str) -> Request:
        """A request that takes long has begun."""
        request = self._add(Request(self.served, lane, owner, is_held=True))
        self._held.append(request)
        assert request.has_begun.wait(5)
        return request

    def close(self) -> None:
        for request in self._held:
            request.let_go.set()
        self.lanes.shutdown()

    def _add(self, request: Request) -> Request:
        self.lanes.add_task(request)
        return request


@pytest.fixture
def server() -> Iterator[Server]:
    server = Server()
    yield server
    server.close()


@pytest.mark.parametrize("lane", Lane)
def test_no_lane_waits_for_another(server, lane):
    server.hold(lane, "slow")
    server.ask(lane, "slow")
    for other in set(Lane) - {lane}:
        assert server.ask(other, "quick").has_begun.wait(5)


def test_addresses_take_turns(server):
    held = server.hold(Lane.PAGES, "many")
    for owner in ("many", "many", "many", "few", "one", "few"):
        server.ask(Lane.PAGES, owner)
    held.let_go.set()
    until(lambda: len(server.served) == 7, 5)
    assert server.served == ["many", "many", "few", "one", "many", "few", "many"]


def test_an_address_has_so_many_turns_a_second_and_another_does_not_wait_for_it(server):
    for _ in range(BURST + RATE // 2):
        server.ask(Lane.PLAYERS, "many")
    until(lambda: len(server.served) >= BURST, 5)
    server.ask(Lane.PLAYERS, "other")
    until(lambda: "other" in server.served, 5)
    assert len(server.served) < BURST + RATE // 2
    until(lambda: len(server.served) == BURST + RATE // 2 + 1, 5, "the rest gets its turns, too")


@pytest.mark.parametrize(
    "lane, owner, waits",
    [(Lane.PLAYERS, "guesser", True), (Lane.ROBOTS, "guesser", False), (Lane.PLAYERS, None, False)],
)
def test_a_player_who_is_refused_waits_longer(server, lane, owner, waits):
    for _ in range(BURST // REFUSED):
        assert server.ask(lane, owner).has_begun.wait(5)
        server.lanes.refused(lane, owner)
    began = time.monotonic()
    assert server.ask(lane, owner).has_begun.wait(5)
    assert not waits or time.monotonic() - began > 0.5 / RATE
    server.lanes.refused(lane, owner)
    server.ask(lane, owner)
    assert server.ask(lane, "another").has_begun.wait(5)
    until(lambda: server.served.count(owner or "") == BURST // REFUSED + 2, 5)
    assert not waits or time.monotonic() - began > 0.8 * REFUSED / RATE


def test_this_machine_is_not_slowed_down(server):
    for _ in range(BURST + 10 * RATE):
        server.ask(Lane.PLAYERS, None)
    until(lambda: len(server.served) == BURST + 10 * RATE, 5)


def test_what_waits_at_the_end_is_cancelled(server):
    held = server.hold(Lane.PAGES, "first")
    waiting = server.ask(Lane.PAGES, "second")
    assert server.lanes.shutdown()
    held.let_go.set()
    assert waiting.is_cancelled
    assert not waiting.has_begun.is_set()


def test_a_request_that_fails_costs_no_thread(server, caplog):
    def fail() -> None:
        raise ZeroDivisionError

    request = Request(server.served, Lane.PAGES, "one")
    request.service = fail  # type: ignore[method-assign]
    server.lanes.add_task(request)
    assert server.ask(Lane.PAGES, "two").has_begun.wait(5)
    assert "ZeroDivisionError" in caplog.text
