"""The arena's public view on real sockets, and the arena as a program."""

import gzip
import json
import signal
import socket
import time
from itertools import pairwise

import pytest
import requests
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from tests.integration.sim.arena import HOST, Arena, Hardware
from tests.support.ports import free_port
from tests.support.programs import Program


def test_a_viewer_gets_the_arena_and_then_its_states(arena: Arena) -> None:
    with connect(arena.view_url) as view:
        first = json.loads(view.recv(timeout=5))
        assert (first["type"], first["width"], first["height"]) == ("arena", 1.6, 1.2)
        states = [json.loads(view.recv(timeout=5)) for _ in range(50)]
    assert {state["type"] for state in states} == {"state"}
    assert all(later["time"] > sooner["time"] for sooner, later in pairwise(states))


def test_a_viewer_that_wants_a_sub_protocol_is_content(arena: Arena) -> None:
    with connect(arena.view_url, subprotocols=[Subprotocol("arena"), Subprotocol("other")]) as view:
        assert (json.loads(view.recv(timeout=5))["type"], view.subprotocol) == ("arena", "arena")


@pytest.mark.parametrize(("source", "named"), [("127.0.0.1", "arena.example"), ("127.0.0.2", "127.0.0.1")])
def test_a_page_finds_the_game_where_a_believed_proxy_says_that_the_visitor_is(
    arena: Arena, source: str, named: str
) -> None:
    asked = "GET / HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nX-Forwarded-Host: arena.example\r\nConnection: close\r\n\r\n"
    with socket.create_connection((HOST, arena.view_port), 5, (source, 0)) as visitor:
        visitor.sendall(asked.encode())
        head = visitor.makefile("rb").read().partition(b"\r\n\r\n")[0].decode()
    assert f" ws://{named}:{arena.env['LASERBOT_ROSBRIDGE_PORT']} " in head


@pytest.mark.slow
def test_the_view_has_25_states_a_second(arena: Arena) -> None:
    with connect(arena.view_url) as view:
        view.recv(timeout=5)
        start = time.monotonic()
        for _ in range(50):
            view.recv(timeout=5)
        assert 15 < 50 / (time.monotonic() - start) < 30


def test_a_viewer_sees_robots_come_drive_and_go(arena: Arena) -> None:
    assert arena.look() == {}
    with Hardware(arena, "virtual1") as robot:
        assert robot.line() == "light 0"
        start = arena.look()["virtual1"]
        assert (start["id"], start["beam"], start["lit"], start["hits"]) == (1, False, False, 0)
        robot.drive_to(0.5, 0.2)
        assert (arena.look()["virtual1"]["x"], arena.look()["virtual1"]["y"]) == pytest.approx((0.5, 0.2), abs=0.01)
    with connect(arena.view_url) as view:
        while json.loads(view.recv(timeout=5)).get("robots") != []:
            pass


def test_a_viewer_that_does_not_read_holds_up_nobody(arena: Arena) -> None:
    with connect(arena.view_url, max_queue=1, close_timeout=0.1) as slow:
        slow.recv(timeout=5)  # and never again
        with Hardware(arena, "virtual0") as robot, connect(arena.view_url) as view:
            robot.drive_to(0.5, 0.2)
            for _ in range(60):
                view.recv(timeout=5)


@pytest.mark.parametrize("junk", ["hello", b"\0\1\2", "x" * 5000], ids=["text", "binary", "long"])
def test_what_a_viewer_says_does_not_matter(arena: Arena, junk: str | bytes) -> None:
    with connect(arena.view_url) as talker:
        talker.send(junk)
    assert arena.look() == {}


@pytest.mark.parametrize("file", ["", "arena.js", "arena.css"])
def test_files_are_compressed_for_browsers_that_can_read_that(arena: Arena, file: str) -> None:
    address = arena.files + file if file else arena.page
    plain = requests.get(address, headers={"Accept-Encoding": "identity"}, timeout=5)
    small = requests.get(address, headers={"Accept-Encoding": "gzip"}, timeout=5, stream=True)
    assert "Content-Encoding" not in plain.headers
    assert small.headers["Content-Encoding"] == "gzip"
    wire = small.raw.read(decode_content=False)
    assert len(wire) < len(plain.content) * 0.6
    assert gzip.decompress(wire) == plain.content


def test_browsers_keep_files_until_an_update_gives_them_another_address(arena: Arena) -> None:
    assert requests.get(arena.page, timeout=5).headers["Cache-Control"] == "no-cache"
    kept = requests.get(arena.files + "arena.js", timeout=5).headers["Cache-Control"]
    assert "immutable" in kept
    older = arena.files.replace(arena.files[-9:], "00000000/")
    assert requests.get(older + "arena.js", timeout=5).status_code == 404


def test_the_page_and_all_its_files_are_served(arena: Arena) -> None:
    page = requests.get(arena.page, timeout=5)
    assert page.headers["Content-Type"].startswith("text/html")
    assert "No robot on the floor yet" in page.text
    for file in ("arena.css", "arena.js", "icon.svg", "scene.js", "players.js"):
        assert requests.get(arena.files + file, timeout=5).status_code == 200
    assert requests.get(f"{arena.files}../arena/__main__.py", timeout=5).status_code == 404
    assert requests.get(f"{arena.page}nowhere", timeout=5).status_code == 404


@pytest.mark.parametrize("signum", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_arena_cleanly(signum: signal.Signals) -> None:
    arena = Arena()
    with Hardware(arena, "virtual0") as robot, connect(arena.view_url) as view:
        assert robot.line() == "light 0"
        view.recv(timeout=5)
        assert arena.program.stop(signum, seconds=5) == 0
    assert "Traceback" not in arena.program.output


@pytest.mark.parametrize("variable", ["LASERBOT_ARENA_PORT", "LASERBOT_ARENA_LINK_PORT"])
def test_a_port_in_use_is_one_clear_line(arena: Arena, variable: str) -> None:
    with socket.socket() as other:
        other.bind((HOST, 0))
        other.listen()
        port = other.getsockname()[1]
        program = Program.python("sim.arena", env={**free_of(arena), variable: str(port)})
        assert program.process.wait(10) == 1
    (line,) = program.output.splitlines()
    assert line.startswith("arena: cannot listen") and str(port) in line


def test_an_impossible_setting_is_one_clear_line() -> None:
    program = Program.python("sim.arena", env={"LASERBOT_ARENA_PORT": "eighty"})
    assert program.process.wait(10) == 2
    assert program.output == "arena: LASERBOT_ARENA_PORT=eighty: must be a whole number from 1 to 65535\n"


def test_help_lists_the_variables() -> None:
    program = Program.python("sim.arena", "--help")
    assert program.process.wait(10) == 0
    assert "LASERBOT_ARENA_LINK_PORT" in program.output


def free_of(arena: Arena) -> dict[str, str]:
    """Settings that do not clash with a running arena."""
    return {**arena.env, "LASERBOT_ARENA_PORT": str(free_port()), "LASERBOT_ARENA_LINK_PORT": str(free_port())}
