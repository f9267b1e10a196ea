"""The arena's view on real sockets, and the arena as a program."""

import json
import signal
import socket
import time
from contextlib import ExitStack
from itertools import pairwise

import pytest
import requests
from websockets.exceptions import InvalidStatus

from laser_bot_battle.openings import OF_ADDRESS
from laser_bot_battle.proxies import FORWARDED
from sim.arena.view import MAX_VIEWERS
from tests.integration.sim.arena import HOST, Arena, Hardware
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.sockets import connect, connect_unread


def test_a_viewer_gets_the_arena_and_then_its_states(arena: Arena) -> None:
    with connect(arena.view_url) as view:
        first = json.loads(view.recv(timeout=LATEST))
        assert (first["type"], first["width"], first["height"]) == ("arena", 1.6, 1.2)
        states = [json.loads(view.recv(timeout=LATEST)) for _ in range(50)]
    assert {state["type"] for state in states} == {"state"}
    assert all(later["time"] > sooner["time"] for sooner, later in pairwise(states))


@pytest.mark.slow
def test_the_view_has_30_states_a_second(arena: Arena) -> None:
    with connect(arena.view_url) as view:
        view.recv(timeout=LATEST)
        start = time.monotonic()
        for _ in range(50):
            view.recv(timeout=LATEST)
        assert 20 < 50 / (time.monotonic() - start) < 35


def test_a_viewer_sees_robots_come_drive_and_go(arena: Arena) -> None:
    assert arena.look() == {}
    with Hardware(arena, "virtual1") as robot:
        assert robot.line() == "light 0"
        start = arena.look()["virtual1"]
        assert (start["id"], start["beam"], start["lit"], start["hits"]) == (1, False, False, 0)
        robot.drive_to(0.5, 0.2)
        assert (arena.look()["virtual1"]["x"], arena.look()["virtual1"]["y"]) == pytest.approx((0.5, 0.2), abs=0.01)
    with connect(arena.view_url) as view:
        while json.loads(view.recv(timeout=LATEST)).get("robots") != []:
            pass


def test_a_viewer_that_does_not_read_holds_up_nobody(arena: Arena) -> None:
    with connect_unread(arena.view_url, max_queue=1) as slow:
        slow.recv(timeout=LATEST)  # and never again
        with Hardware(arena, "virtual0") as robot, connect(arena.view_url) as view:
            robot.drive_to(0.5, 0.2)
            for _ in range(60):
                view.recv(timeout=LATEST)


@pytest.mark.parametrize("junk", ["hello", b"\0\1\2", "x" * 5000], ids=["text", "binary", "long"])
def test_what_a_viewer_says_does_not_matter(arena: Arena, junk: str | bytes) -> None:
    with connect(arena.view_url) as talker:
        talker.send(junk)
    assert arena.look() == {}


def test_the_page_is_served_with_the_drawing_of_the_players_pages(arena: Arena) -> None:
    page = requests.get(arena.page, timeout=LATEST)
    assert page.headers["Content-Type"].startswith("text/html")
    for file in ("static/arena.css", "static/arena.js", "static/icon.svg", "drawing/picture.js", "drawing/scene.js"):
        assert requests.get(arena.page + file, timeout=LATEST).status_code == 200
    for secret in ("static/../arena/__main__.py", "drawing/../battle/hits.js", "nowhere"):
        asked = requests.Request("GET", arena.page).prepare()
        asked.url = arena.page + secret  # as it is
        with requests.Session() as session:
            assert session.send(asked, timeout=LATEST).status_code == 404


@pytest.mark.parametrize("path", ["", "static/arena.js", "nothing.js"])
def test_every_answer_says_what_a_browser_may_do(arena: Arena, path: str) -> None:
    headers = requests.get(arena.page + path, timeout=LATEST).headers
    assert "default-src 'self'" in headers["Content-Security-Policy"]
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["X-Content-Type-Options"] == "nosniff"


def test_a_state_goes_uncompressed_or_each_viewer_would_cost_its_compression(arena: Arena) -> None:
    with connect(arena.view_url, compression="deflate") as view:
        assert json.loads(view.recv(timeout=LATEST))["type"] == "arena"
        assert view.protocol.extensions == []


def test_one_more_than_the_most_is_turned_away_and_room_is_made_by_leaving(arena: Arena) -> None:
    with ExitStack() as stack:
        here = [{FORWARDED: f"10.0.{number // OF_ADDRESS}.1"} for number in range(MAX_VIEWERS)]
        viewers = [stack.enter_context(connect_unread(arena.view_url, additional_headers=each)) for each in here]
        with pytest.raises(InvalidStatus, match="503"), connect(arena.view_url):
            pass
        viewers[0].close()

        def has_room() -> bool:
            try:
                return arena.look() == {}
            except InvalidStatus:
                return False

        until(has_room, 10, "room")


@pytest.mark.parametrize("signum", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_arena_cleanly(signum: signal.Signals) -> None:
    arena = Arena()
    with Hardware(arena, "virtual0") as robot, connect(arena.view_url) as view:
        assert robot.line() == "light 0"
        view.recv(timeout=LATEST)
        assert arena.program.stop(signum, seconds=5) == 0
    assert "Traceback" not in arena.program.output


@pytest.mark.parametrize("variable", ["LASERBOT_ARENA_PORT", "LASERBOT_ARENA_LINK_PORT"])
def test_a_port_in_use_is_one_clear_line(arena: Arena, variable: str) -> None:
    with socket.socket() as other:
        other.bind((HOST, 0))
        other.listen()
        port = other.getsockname()[1]
        program = Program.python("sim.arena", env={**free_of(arena), variable: str(port)})
        assert program.exit_code() == 1
    (line,) = program.output.splitlines()
    assert line.startswith("arena: cannot listen") and str(port) in line


def test_an_impossible_setting_is_one_clear_line() -> None:
    program = Program.python("sim.arena", env={"LASERBOT_ARENA_PORT": "eighty"})
    assert program.exit_code() == 2
    assert program.output == "arena: LASERBOT_ARENA_PORT=eighty: must be a whole number from 1 to 65535\n"


def test_help_lists_the_variables() -> None:
    program = Program.python("sim.arena", "--help")
    assert program.exit_code() == 0
    assert "LASERBOT_ARENA_LINK_PORT" in program.output


def free_of(arena: Arena) -> dict[str, str]:
    """Settings that do not clash with a running arena."""
    return {**arena.env, "LASERBOT_ARENA_PORT": str(free_port()), "LASERBOT_ARENA_LINK_PORT": str(free_port())}
