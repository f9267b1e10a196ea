"""Wishes and what the master is asked because of them."""

import asyncio
import logging
from collections.abc import Callable
from typing import Any

import pytest

from laser_bot_battle.master import MasterError
from tcpros import registrations
from tcpros.registrations import Registration, Registrations

URI = "http://node/"


class Asked:
    """Stands in for the way to the master, which is asked in its own time."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, ...]] = []
        self.errors: list[Exception] = []
        self.open = asyncio.Event()
        self.open.set()

    async def __call__(self, *call: Any) -> Any:
        self.calls.append(call)
        await self.open.wait()
        await asyncio.sleep(0)
        if self.errors:
            raise self.errors.pop(0)
        return ["http://publisher/"]


async def settled(condition: Callable[[], object]) -> None:
    async with asyncio.timeout(10):
        while not condition():
            await asyncio.sleep(0.001)


def topic(name: str, what: str = "a/B", **options: Any) -> Registration:
    return Registration("Publisher", name, what, URI, **options)


def test_thousands_of_changes_become_a_handful_of_calls_and_others_wait_for_few() -> None:
    async def scenario() -> None:
        asked = Asked()
        made = Registrations(asked)
        made.start()
        asked.open.clear()
        for number in range(4000):
            made.want(topic("/often", f"a/B{number}"))
            made.drop(("Publisher", "/often"))
            if number == 2000:
                made.want(topic("/other"))
            await asyncio.sleep(0)
        asked.open.set()
        await settled(lambda: ("registerPublisher", "/other", "a/B", URI) in asked.calls)
        assert len(asked.calls) <= 3
        await made.close(1)
        assert len(asked.calls) <= 5
        assert asked.calls[-1][0] == "unregisterPublisher"

    asyncio.run(scenario())


def test_a_topic_that_is_left_and_taken_again_is_registered_again() -> None:
    """Its subscribers lost their connections and are told by it to connect."""

    async def scenario() -> None:
        asked = Asked()
        answers: list[Any] = []

        async def answered(answer: Any) -> None:
            answers.append(answer)

        made = Registrations(asked)
        made.start()
        made.want(topic("/t", answered=answered))
        await settled(lambda: answers == [["http://publisher/"]])
        made.drop(("Publisher", "/t"))
        made.want(topic("/t", answered=answered))
        await settled(lambda: len(answers) == 2)
        assert asked.calls == [("registerPublisher", "/t", "a/B", URI)] * 2
        await made.close(1)
        assert asked.calls[2:] == [("unregisterPublisher", "/t", URI)]

    asyncio.run(scenario())


def test_a_master_that_does_not_answer_is_asked_again_and_it_is_logged_once(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(registrations, "FIRST_PAUSE", 0.01)

    async def scenario() -> None:
        asked = Asked()
        asked.errors += [OSError("no route")] * 3
        made = Registrations(asked)
        made.start()
        made.want(Registration("Service", "/s", "rosrpc://host:1", URI))
        await settled(lambda: len(asked.calls) == 4)
        assert len(set(asked.calls)) == 1
        await made.close(1)
        assert asked.calls[-1] == ("unregisterService", "/s", "rosrpc://host:1")

    with caplog.at_level(logging.WARNING):
        asyncio.run(scenario())
    assert [record.getMessage() for record in caplog.records] == [
        "the ROS master does not answer (no route): Service /s waits"
    ]


def test_what_may_have_been_registered_is_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """The call timed out, and the master carries it out later."""
    monkeypatch.setattr(registrations, "FIRST_PAUSE", 0.01)

    async def scenario() -> None:
        asked = Asked()
        asked.errors.append(TimeoutError())
        made = Registrations(asked)
        made.start()
        made.want(topic("/t"))
        await settled(lambda: not asked.errors)
        made.drop(("Publisher", "/t"))
        await settled(lambda: ("unregisterPublisher", "/t", URI) in asked.calls)
        await made.close(1)
        assert len(set(asked.calls)) == 2

    asyncio.run(scenario())


def test_what_the_master_refuses_is_not_asked_again(caplog: pytest.LogCaptureFixture) -> None:
    async def scenario() -> None:
        asked = Asked()
        asked.errors.append(MasterError("bad name"))
        made = Registrations(asked)
        made.start()
        made.want(topic("bad"))
        made.want(topic("/good"))
        await settled(lambda: len(asked.calls) == 2)
        await made.close(1)

    asyncio.run(scenario())
    assert "refuses Publisher bad: bad name" in caplog.text


def test_the_end_waits_no_longer_than_it_is_told() -> None:
    async def scenario() -> None:
        asked = Asked()
        made = Registrations(asked)
        made.start()
        made.want(topic("/t"))
        await settled(lambda: asked.calls)
        asked.open.clear()
        async with asyncio.timeout(5):
            await made.close(0.05)
        assert len(asyncio.all_tasks()) == 1

    asyncio.run(scenario())
