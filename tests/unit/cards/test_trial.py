"""Which of a card's containers run well."""

from collections.abc import Callable
from typing import Any

import pytest

from cards.trial import LIMIT, STEADY, steady

Look = dict[str, Any]


def look(health: str = "healthy", started: float = 1, running: bool = True) -> Look:
    return {"State": {"Running": running, "StartedAt": started, "Health": {"Status": health}}}


def tried(at: Callable[[float], Look | None], to_be_healthy: bool = True) -> tuple[bool, float]:
    """Whether it runs, and after how many s that is known. `at`: what the engine says then of its container."""
    now = 0.0

    class Engine:
        def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
            found = at(now)
            return (200, found) if found else (404, {})

    def rest(seconds: float) -> None:
        nonlocal now
        now += seconds

    found = steady(Engine(), ["robot"], ["robot"] if to_be_healthy else [], lambda: now, rest)
    assert found <= {"robot"}
    return bool(found), now


@pytest.mark.parametrize(
    "at, runs",
    [
        (lambda now: look(), True),
        (lambda now: look("starting" if now < 100 else "healthy"), True),
        (lambda now: look(started=1 if now < 50 else 2), True),
        (lambda now: look("unhealthy"), False),
        (lambda now: look(started=now // 20), False),
        (lambda now: look(running=False), False),
        (lambda now: None, False),
        (lambda now: look() if now < 20 or now > 30 else None, True),
        (lambda now: look("unhealthy" if now % 28 == 0 else "healthy"), False),
    ],
)
def test_it_runs_when_it_was_healthy_for_a_while(at: Callable[[float], Look | None], runs: bool) -> None:
    found, after = tried(at)
    assert found is runs
    assert after >= STEADY if runs else LIMIT <= after < LIMIT + 10


def test_what_was_not_healthy_before_has_only_to_stay_up() -> None:
    assert tried(lambda now: look("unhealthy"), to_be_healthy=False)[0]
    assert not tried(lambda now: look("unhealthy", started=now // 20), to_be_healthy=False)[0]


def test_one_without_a_health_check_is_never_healthy() -> None:
    at = {"State": {"Running": True, "StartedAt": 1}}
    assert tried(lambda now: at, to_be_healthy=False)[0]
    assert not tried(lambda now: at)[0]


def test_those_that_run_well_are_told_from_the_others() -> None:
    now = 0.0

    class Engine:
        def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
            return 200, look("unhealthy" if "bots" in path else "healthy", started=now if "web" in path else 1)

    def rest(seconds: float) -> None:
        nonlocal now
        now += seconds

    names = {"web", "bots", "front"}
    assert steady(Engine(), names, names, lambda: now, rest) == {"front"}
    assert steady(Engine(), names, {"web"}, lambda: now, rest) == {"bots", "front"}
