"""The ping thread against a real HTTP server."""

import contextlib
import logging
import threading
import time
from collections.abc import Iterator

import pytest

from robot.ping_thread import PingThread
from tests.integration.robot.web_server import WebServer
from tests.support.polling import LATEST, until


@pytest.fixture
def pings(web: WebServer, caplog: pytest.LogCaptureFixture) -> Iterator[PingThread]:
    caplog.set_level(logging.INFO, "robot")
    with PingThread(web.url, 7, "secret") as pings:
        until(lambda: web.pings)
        yield pings
    pings.join(3)


def outages(caplog: pytest.LogCaptureFixture) -> int:
    return caplog.text.count("Connection to webserver lost")


@pytest.mark.slow  # the time is real
def test_a_ping_says_the_id_every_400_ms(web: WebServer, pings: PingThread) -> None:
    until(lambda: len(web.pings) >= 6)
    times, paths, bodies = zip(*web.pings[:6], strict=True)
    assert set(paths) == {"/incAlive"}
    assert set(bodies) == {"ID=7&key=secret"}
    assert 1.9 < times[5] - times[0] < 3.0
    assert not pings.unknown.is_set()


def test_an_unknown_robot_is_reported(web: WebServer, pings: PingThread) -> None:
    web.answer = '{"status": "ERROR"}'
    assert pings.unknown.wait(3)


def test_a_robot_whose_key_the_server_does_not_know_is_to_register_again(web: WebServer, pings: PingThread) -> None:
    web.code, web.answer = 403, '{"error": "only that robot can say that it is alive", "status": "ERROR"}'
    assert pings.unknown.wait(3)


def test_pings_go_on_after_the_server_was_away_and_each_outage_is_logged_once(
    web: WebServer, pings: PingThread, caplog: pytest.LogCaptureFixture
) -> None:
    for outage in (1, 2):
        web.stop()
        until(lambda: outages(caplog) == outage)  # noqa: B023 - called at once
        time_of_outage = time.monotonic()
        until(lambda: time.monotonic() > time_of_outage + 1)  # noqa: B023 - three pings more
        assert outages(caplog) == outage
        before = len(web.pings)
        web.start()
        until(lambda: len(web.pings) > before)  # noqa: B023 - called at once
        until(lambda: caplog.text.count("webserver answers again") == outage)  # noqa: B023 - called at once
    assert not pings.unknown.is_set()


@pytest.mark.parametrize(
    ("code", "answer"),
    [
        (500, "<h1>Error 500</h1>"),
        (404, "<h1>Error 404</h1>"),
        (403, "<h1>Error 403</h1>"),
        (200, "not JSON"),
        (200, "[]"),
        (200, '"OK"'),
        (200, "{}"),
        (200, '{"status": "MAYBE"}'),
        (302, '{"status": "OK"}'),
    ],
)
def test_an_answer_without_sense_is_an_outage_and_no_end(
    web: WebServer, pings: PingThread, caplog: pytest.LogCaptureFixture, code: int, answer: str
) -> None:
    web.code, web.answer = code, answer
    until(lambda: outages(caplog) == 1)
    assert not pings.unknown.is_set()
    web.code, web.answer = 200, '{"status": "ERROR"}'
    assert pings.unknown.wait(3)


def test_a_server_that_hangs_is_not_waited_for_longer_than_a_second(
    web: WebServer, pings: PingThread, caplog: pytest.LogCaptureFixture
) -> None:
    web.delay.set()
    hung = len(web.pings)
    until(lambda: outages(caplog) == 1, 3)
    until(lambda: len(web.pings) > hung + 1, 5)


def test_a_robot_that_is_switched_off_says_goodbye(web: WebServer) -> None:
    with contextlib.suppress(KeyboardInterrupt), PingThread(web.url, 7, "secret"):
        until(lambda: web.pings)
        raise KeyboardInterrupt
    until(lambda: web.pings[-1][2] == "ID=7&key=secret&leaving=1")


def test_a_robot_that_registers_again_does_not(web: WebServer) -> None:
    with contextlib.suppress(OSError), PingThread(web.url, 7, "secret") as pings:
        until(lambda: web.pings)
        raise OSError
    pings.join(LATEST)
    assert {body for _, _, body in web.pings} == {"ID=7&key=secret"}


def test_no_ping_is_sent_after_the_stop(web: WebServer) -> None:
    with PingThread(web.url, 7, "secret") as pings:
        until(lambda: len(web.pings) >= 2)
    pings.join(LATEST)
    assert not pings.is_alive()
    assert "pings" not in [thread.name for thread in threading.enumerate()]
