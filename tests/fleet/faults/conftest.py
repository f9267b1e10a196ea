"""Faults: each test leaves the fleet as it was, and says how long the fleet took to be whole again."""

import time
from collections.abc import Callable, Iterator

import pytest

from tests.support.rehearsal import Rehearsal

times: list[tuple[str, float]] = []


@pytest.fixture(autouse=True)
def whole_before(rehearsal: Rehearsal) -> None:
    rehearsal.wait_until_complete(180)


@pytest.fixture
def measured(request: pytest.FixtureRequest) -> Iterator[Callable[[str], None]]:
    """measured("back") notes the time since the last call or the start."""
    since = time.monotonic()

    def note(what: str) -> None:
        nonlocal since
        now = time.monotonic()
        if what:
            times.append((f"{request.node.name.removeprefix('test_').replace('_', ' ')}: {what}", now - since))
        since = now

    yield note


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if times:
        terminalreporter.section("measured")
        for what, seconds in times:
            terminalreporter.write_line(f"{seconds:7.1f} s  {what}")
