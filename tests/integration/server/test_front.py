"""nginx as the front runs it, where what leads to it has other ports."""

import re
import socket
import subprocess
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, HTTPServer, ThreadingHTTPServer
from pathlib import Path

import pytest
import requests

from server.front.configuration import CONNECTIONS, configuration
from server.front.settings import FrontSettings
from tests.support.polling import LATEST, until
from tests.support.ports import free_port, listening
from tests.support.programs import Program


@contextmanager
def front(**variables: str) -> Iterator[str]:
    """Its address, without TLS."""
    port = free_port()
    environment = {"LASERBOT_BIND": "127.0.0.1", "LASERBOT_HTTP_PORT": str(port), **variables}
    program = Program.python("server.front", env=environment)
    try:
        until(lambda: listening(port), 20, "nginx listens")
        yield f"http://127.0.0.1:{port}"
    finally:
        assert program.stop() == 0, program.output


@pytest.fixture
def certificate(tmp_path: Path) -> Path:
    words = "openssl req -x509 -newkey rsa:2048 -nodes -keyout front.key -out front.crt -days 2 -subj /CN=arena"
    subprocess.run(words.split(), cwd=tmp_path, check=True, capture_output=True)
    return tmp_path


def test_port_80_shows_the_way_by_the_ports_that_the_visitor_sees(certificate: Path) -> None:
    https = str(free_port())
    with front(LASERBOT_TLS=str(certificate), LASERBOT_HTTPS_PORT=https) as address:
        for host, way in {
            "arena.example:8000": f"https://arena.example:{https}",
            "arena.example": "https://arena.example",  # a load balancer has led him here
            "[fe80::1]": "https://[fe80::1]",
            "[fe80::1]:8000": f"https://[fe80::1]:{https}",
        }.items():
            answer = requests.get(f"{address}/watch", headers={"Host": host}, timeout=LATEST, allow_redirects=False)
            assert (answer.status_code, answer.headers["Location"]) == (HTTPStatus.FOUND, f"{way}/watch")


@pytest.mark.parametrize(
    ("ports", "usual", "named"),
    [
        ({}, "", ""),
        ({"LASERBOT_HTTPS_PORT": "8443"}, ":8443", ":8443"),  # port 80 is its own, so this is what visitors see
        ({"LASERBOT_HTTP_PORT": "8000", "LASERBOT_HTTPS_PORT": "8443"}, "", ":8443"),
    ],
)
def test_it_names_its_own_port_of_tls_to_who_sees_its_own_ports(
    tmp_path: Path, ports: dict[str, str], usual: str, named: str
) -> None:
    text = configuration(FrontSettings.from_env(ports), tmp_path, is_root=False)
    assert f'default "{usual}";\n        ~:\\d+$ "{named}";' in text


@pytest.mark.parametrize(
    ("bind", "listens", "programs"),
    [
        ("0.0.0.0", ["0.0.0.0:80", "[::]:80 ipv6only=on"], "127.0.0.1"),
        ("127.0.0.1", ["127.0.0.1:80", "[::1]:80 ipv6only=on"], "127.0.0.1"),
        ("127.0.0.2", ["127.0.0.2:80"], "127.0.0.2"),
    ],
)
def test_it_listens_where_the_programs_do(tmp_path: Path, bind: str, listens: list[str], programs: str) -> None:
    text = configuration(FrontSettings.from_env({"LASERBOT_BIND": bind}), tmp_path, is_root=False)
    assert re.findall(r"listen (.*) backlog", text) == listens
    assert f"server {programs}:5000;" in text


def test_an_address_that_is_none_is_one_clear_line() -> None:
    program = Program.python("server.front", env={"LASERBOT_BIND": "a..b"})
    program.wait_for("cannot listen on a..b: that is no host's name; set LASERBOT_BIND")
    assert program.exit_code() == 1
    assert "Traceback" not in program.output


def test_what_a_visitor_says_of_proxies_is_not_passed_on() -> None:
    heard: list[dict[str, str]] = []

    class Web(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            heard.append(dict(self.headers))
            self.send_response(HTTPStatus.NO_CONTENT)
            self.end_headers()

    said = {"X-Forwarded-Host": "forged.example", "X-Forwarded-Proto": "https", "X-Forwarded-For": "9.9.9.9"}
    with HTTPServer(("127.0.0.1", 0), Web) as web:
        thread = threading.Thread(target=web.serve_forever)
        thread.start()
        try:
            with front(LASERBOT_WEB_PORT=str(web.server_port)) as address:
                port = address.rpartition(":")[2]
                requests.get(f"http://[::1]:{port}/", headers=said, timeout=LATEST)
        finally:
            web.shutdown()
            thread.join()
    told = {name: heard[0][name] for name in said}
    assert told == {"X-Forwarded-Host": f"[::1]:{port}", "X-Forwarded-Proto": "http", "X-Forwarded-For": "::1"}


@pytest.mark.slow
def test_one_address_cannot_have_all_connections() -> None:
    held: list[str] = []
    done = threading.Event()

    class Slow(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            held.append(self.headers["X-Forwarded-For"])
            done.wait(60)

    with ThreadingHTTPServer(("127.0.0.1", 0), Slow) as web, ExitStack() as calls:
        calls.callback(web.shutdown)
        calls.callback(done.set)
        threading.Thread(target=web.serve_forever).start()
        url = calls.enter_context(front(LASERBOT_WEB_PORT=str(web.server_port)))

        def call(own_address: str) -> None:
            where = ("127.0.0.1", int(url.rpartition(":")[2]))
            caller = calls.enter_context(socket.create_connection(where, 5, (own_address, 0)))
            caller.sendall(b"GET /home HTTP/1.1\r\nHost: arena\r\n\r\n")

        def full() -> bool:
            call("127.0.0.1")  # one that comes too fast is refused, and does not count
            return len(held) >= CONNECTIONS

        until(full, 30, "the address has all that it may have")
        until(lambda: requests.get(f"{url}/home", timeout=LATEST).status_code == HTTPStatus.SERVICE_UNAVAILABLE, 5)
        call("127.0.0.3")
        until(lambda: held[-1] == "127.0.0.3", 5, "another address has room")
        assert held[:-1] == ["127.0.0.1"] * CONNECTIONS
