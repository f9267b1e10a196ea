"""What strangers in the network do to the web server: it costs them their own share, and nobody else's."""

import hashlib
import itertools
import json
import resource
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from http.client import HTTPConnection
from typing import Any

import pytest
import requests
from requests.adapters import HTTPAdapter

from server.game.rules import Rules
from server.web.lanes import BURST, RATE, REFUSED
from tests.bench.strangers import ANSWER_WITHIN, ROBOTS, Crowd, feel
from tests.integration.server.conftest import GameServer
from tests.support.polling import LATEST, until

LIMIT = 500  # connections at once
MORE_MEMORY = 100.0  # MiB of each program, with a crowd and after it


@pytest.fixture
def connect(server: GameServer) -> Iterator[Callable[..., socket.socket]]:
    """Raw connections to the web server, from any loopback address."""
    with ExitStack() as stack:
        yield lambda source="127.0.0.1": stack.enter_context(
            closing(socket.create_connection(("127.0.0.1", server.port), 10, (source, 0)))
        )


@pytest.fixture
def many_files() -> Iterator[None]:
    """Room for the sockets of a crowd in this process."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, 4096)), hard))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def answer(connection: socket.socket, request: bytes) -> bytes:
    """The whole answer to a request after which the server closes, or is told to."""
    connection.sendall(request)
    parts = []
    while part := connection.recv(65536):
        parts.append(part)
    return b"".join(parts)


def log_of(server: GameServer) -> str:
    return server.program.output


BAD_HOSTS = [
    b"x" * 64,
    b"a" * 300,
    b"a b",
    b"a:" + b"9" * 5000,
    b"\xc3\xa9",
    b"\xff",
    b"[::1",
    b"[zz]",
    b"a..b",
    b"xn--a",
    b"xn--" + b"9" * 50,
    b"a/b",
    b"a@b",
    b"a:b",
    b"",
]


def test_a_host_that_is_none_is_refused_in_a_short_line(server: GameServer, connect) -> None:
    for path, host in itertools.product((b"/", b"/session"), BAD_HOSTS):
        before = len(log_of(server))
        got = answer(connect(), b"GET %s HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n\r\n" % (path, host))
        assert got.startswith(b"HTTP/1.1 400 "), host
        assert b'"status": "ERROR"' in got
        assert len(log_of(server)) - before < 300, host
    assert "Traceback" not in log_of(server)


def test_honest_hosts_get_the_page_and_http_1_0_needs_none(connect) -> None:
    for host in (b"127.0.0.1:5000", b"laser_bot_master.local:5000", b"[::1]:5000", b"localhost", b"A-b.c."):
        got = answer(connect(), b"GET / HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n\r\n" % host)
        assert got.startswith(b"HTTP/1.1 200 "), host
    assert answer(connect(), b"GET / HTTP/1.0\r\n\r\n").startswith(b"HTTP/1.0 200 ")


NONSENSE = [
    b"GET http://[/ HTTP/1.1\r\n\r\n",
    b"GET //[ HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n",
    b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: " + b"9" * 5000 + b"\r\n\r\n",
    b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: -1\r\n\r\n",
    b"POST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n",
    b"\x00\xff\xfe\r\n\r\n",
    b"POST /signUpUser HTTP/1.1\r\nHost: a\r\nContent-Type: multipart/form-data; boundary=\xff\r\n"
    b"Connection: close\r\nContent-Length: 3\r\n\r\nabc",
    b"GET /none?\x7f HTTP/1.1\r\nHost: a\r\nX-Odd: \xff\r\nConnection: close\r\n\r\n",
    b"GET /%00%ff HTTP/1.1\r\nHost: a\r\nCookie: laserbot_session=\xff\x80\r\nConnection: close\r\n\r\n",
]


def test_no_request_writes_a_traceback(server: GameServer, connect) -> None:
    for request in NONSENSE:
        before = len(log_of(server))
        assert answer(connect(), request)[9:10] == b"4", request
        assert "Traceback" not in log_of(server), request
        assert "python exception" not in log_of(server), request
        assert len(log_of(server)) - before < 300, request


EXPECTING = b"%s / HTTP/1.1\r\nHost: a\r\nExpect: 100-continue\r\nConnection: close\r\n"


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        (EXPECTING % b"GET" + b"\r\n", 200),
        (EXPECTING % b"GET" + b"Content-Length: 0\r\n\r\n", 200),
        (EXPECTING % b"POST" + b"Content-Length: none\r\n\r\n", 400),
        (EXPECTING % b"POST" + b"Content-Length: 9999999\r\n\r\n", 413),
    ],
    ids=["no body", "an empty body", "a length that is none", "a body that is too long"],
)
def test_a_request_that_needs_no_more_is_answered_at_once(connect, request_: bytes, status: int) -> None:
    assert answer(connect(), request_).startswith(b"HTTP/1.1 %d " % status)


def test_a_body_is_asked_for_by_who_waits_to_send_it(server: GameServer, connect) -> None:
    server.robot("r")
    connection, body = connect(), b"data=ada"
    connection.sendall(
        b"POST /signUpUser HTTP/1.1\r\nHost: a\r\nExpect: 100-continue\r\nConnection: close\r\n"
        b"Content-Type: application/x-www-form-urlencoded\r\nContent-Length: %d\r\n\r\n" % len(body)
    )
    assert connection.recv(65536) == b"HTTP/1.1 100 Continue\r\n\r\n"
    got = answer(connection, body)
    assert got.startswith(b"HTTP/1.1 200 ")
    assert b'"status": "OK"' in got


def test_a_flood_of_refusals_is_some_lines_in_the_log(server: GameServer) -> None:
    before = len(log_of(server))
    with requests.Session() as http:
        for _ in range(1295):
            assert http.get(f"{server.url}/", headers={"Host": "x" * 64}, timeout=LATEST).status_code == 400
            assert http.post(f"{server.url}/incAlive", timeout=LATEST).status_code == 400
    assert len(log_of(server)) - before < 20_000

    def is_counted() -> bool:
        requests.post(f"{server.url}/incAlive", timeout=LATEST)
        return "more like this" in log_of(server)

    until(is_counted, 5)


def test_a_path_cannot_write_a_line_of_its_own(server: GameServer, connect) -> None:
    forged = b"2026-01-01%2000:00:00%20ERROR%20server.main:%20forged"
    request = b"POST /signUpUser%%0a%s HTTP/1.1\r\nHost: a\r\nOrigin: http://b\r\nConnection: close\r\n\r\n" % forged
    assert answer(connect(), request).startswith(b"HTTP/1.1 403 ")
    (line,) = [line for line in log_of(server).splitlines() if "forged" in line]
    assert r"/signUpUser\n2026-01-01" in line
    assert "refused" in line


@pytest.mark.slow  # the time is real
@pytest.mark.parametrize("source", ["127.0.0.2", "127.0.0.1"])
def test_silent_sockets_do_not_lock_visitors_out(server: GameServer, connect, many_files, source: str) -> None:
    slow = [connect(source) for _ in range(LIMIT + 20)]
    for number, connection in enumerate(slow):
        if number % 2:
            connection.sendall(b"GET / HTTP/1.1\r\nHost: a\r\n")  # and no end
    begun = time.monotonic()
    for _ in range(10):
        assert requests.get(f"{server.url}/", timeout=LATEST).status_code == 200
    assert time.monotonic() - begun < 2
    slow += [connect(source) for _ in range(LIMIT)]  # as often as they like
    begun = time.monotonic()
    assert requests.get(f"{server.url}/", timeout=LATEST).status_code == 200
    assert time.monotonic() - begun < 2


def test_who_has_few_places_keeps_them(server: GameServer, connect, many_files) -> None:
    with closing(HTTPConnection("127.0.0.1", server.port, timeout=LATEST)) as visitor:
        visitor.auto_open = False
        visitor.connect()
        for _ in range(LIMIT + 50):
            connect("127.0.0.2")
        visitor.request("GET", "/about")
        assert visitor.getresponse().status == 200


def test_visitors_of_a_proxy_lose_no_places_to_others(server: GameServer, connect, many_files) -> None:
    proxied = [connect("127.0.0.1") for _ in range(LIMIT + 50)]
    for number in range(LIMIT + 50):
        connect(f"127.0.0.{2 + number % 6}")
    request = b"GET /about HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n"
    assert answer(proxied[0], request).startswith(b"HTTP/1.1 200")


class Source(HTTPAdapter):
    """Requests from another loopback address."""

    def __init__(self, address: str) -> None:
        self._address = address
        super().__init__()

    def init_poolmanager(self, *arguments: Any, **options: Any) -> None:
        super().init_poolmanager(*arguments, **options, source_address=(self._address, 0))


def post(server: GameServer, source: str, route: str, **fields: object) -> requests.Response:
    """As a new visitor from that address."""
    with requests.Session() as http:
        http.mount("http://", Source(source))
        return http.post(f"{server.url}/{route}", data=fields, timeout=LATEST)


@pytest.mark.slow
def test_one_address_does_not_take_all_robots_at_once(server: GameServer) -> None:
    for number in range(6):
        server.robot(f"r{number}")
    begun = time.monotonic()
    answers = [post(server, "127.0.0.2", "signUpUser", data=f"eve{number}") for number in range(6)]
    assert [answer.status_code for answer in answers[:4]] == [200] * 4
    assert time.monotonic() - begun > 3 or [answer.status_code for answer in answers[4:]] == [429] * 2
    assert post(server, "127.0.0.3", "signUpUser", data="ada").json()["status"] == "OK"
    for name in ("bob", "cy", "dan", "dee", "fay"):
        assert server.post("signUpUser", data=name)["status"] in ("OK", "NO_ROBOTS"), "this machine's own never wait"


def test_who_guesses_names_waits_longer_each_time(server: GameServer) -> None:
    began = time.monotonic()
    for _ in range(BURST // REFUSED + 5):
        assert post(server, "127.0.0.2", "signUpUser", data="no name!").status_code == 400
    assert time.monotonic() - began > 4 * REFUSED / RATE
    assert post(server, "127.0.0.3", "getAvailableRobots").status_code == 200


def register(server: GameServer, first: int, last: int, key: str = "") -> list[int | None]:
    """Robots register that then say no more."""
    output = server.peer("register", str(first), str(last), *([key] if key else [])).wait_for("ids [", 60)
    ids: list[int | None] = json.loads(output[output.index("ids [") + 4 :].partition("\n")[0])
    return ids


@pytest.mark.slow
def test_only_the_robot_itself_keeps_itself_alive(server: GameServer) -> None:
    key = "the robot's own secret"
    assert register(server, 0, 1, hashlib.sha256(key.encode()).hexdigest()) == [0]

    def ping(source: str, **fields: object) -> int:
        return post(server, source, "incAlive", ID=0, **fields).status_code

    for fields in ({}, {"key": "guess"}, {"key": hashlib.sha256(key.encode()).hexdigest()}):
        assert ping("127.0.0.1", **fields) == 403
    assert ping("127.0.0.2", key=key) == 200

    def gone_in_spite_of_pings() -> bool:
        ping("127.0.0.1", key="guess")
        return "robot 0 is gone" in log_of(server)

    until(gone_in_spite_of_pings, 6)


def test_a_robot_without_a_key_is_kept_alive_from_its_own_address_only(server: GameServer) -> None:
    assert register(server, 0, 1) == [0]
    assert post(server, "127.0.0.2", "incAlive", ID=0).status_code == 403
    assert post(server, "127.0.0.1", "incAlive", ID=0).json() == {"status": "OK"}


def test_a_server_that_starts_again_still_knows_the_robots_key(server: GameServer) -> None:
    key = "the robot's own secret"
    assert register(server, 0, 1, hashlib.sha256(key.encode()).hexdigest()) == [0]
    until(lambda: post(server, "127.0.0.1", "incAlive", ID=0, key=key).status_code == 200)
    assert server.program.stop() == 0
    server.launch()
    server.wait_until_serving()
    assert post(server, "127.0.0.1", "incAlive", ID=0, key="guess").status_code == 403
    assert post(server, "127.0.0.1", "incAlive", ID=0, key=key).json() == {"status": "OK"}


def test_a_key_that_is_none_is_refused_in_words(server: GameServer) -> None:
    assert register(server, 0, 1, "secret") == [None]


@pytest.mark.slow  # the time is real
def test_128_names_displace_no_robots_id_and_are_offered_to_nobody(server: GameServer) -> None:
    kept = server.robot("a")
    assert kept.id == 0
    kept.vanish()
    until(lambda: "robot 0 is gone" in log_of(server), 10)
    ids = register(server, 0, 140)
    assert 0 not in ids
    assert len(set(ids) - {None}) == 127 or None not in ids, "the silent have made room for the next"
    assert server.post("getAvailableRobots")["availableR"] == 0
    assert server.robot("a").id == 0


@pytest.mark.slow  # the time is real
def test_a_request_that_is_not_complete_within_10_seconds_is_not_waited_for(server: GameServer, connect) -> None:
    begun = time.monotonic()
    silent, drips = connect(), connect()
    drips.settimeout(0.5)
    closed_after = None
    drips.sendall(b"GET / HTTP/1.1\r\nHost: a")
    while closed_after is None and time.monotonic() < begun + 20:
        try:
            drips.sendall(b"a")
            if not drips.recv(1):
                closed_after = time.monotonic() - begun
        except TimeoutError:
            continue
        except OSError:
            closed_after = time.monotonic() - begun
    assert closed_after is not None
    assert 9 < closed_after < 13
    assert silent.recv(1) == b""


@pytest.mark.slow
@pytest.mark.parametrize("crowd", [Crowd(1, 1000), Crowd(8, 100), Crowd(8, 100, by_front=True)], ids=str)
def test_a_greedy_crowd_ends_no_battle(crowd: Crowd) -> None:
    """How little it is felt is for tests/bench to say."""
    felt, costs = feel(crowd, 10)
    assert felt.seats == ROBOTS
    assert felt.row.figures.lost == 0
    assert max(felt.pings) < Rules().robot_timeout
    assert max(felt.pages) < ANSWER_WITHIN
    for name, each in costs.items():
        before, meanwhile, after = each.memory
        assert max(meanwhile, after) < before + MORE_MEMORY, name
