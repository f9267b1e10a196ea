"""All of the game at one address: real nginx before a real battle, played by programs and by Chromium, with TLS too."""

import json
import os
import re
import shutil
import socket
import ssl
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

import pytest
import requests
from playwright.sync_api import Browser, expect
from websockets.exceptions import InvalidStatus

from server.front.configuration import FILES_AT_ONCE, RATE
from tests.browser.conftest import FLAGS
from tests.browser.people import Person
from tests.support.demo import TOKEN, Demo
from tests.support.player import Player
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.sockets import connect


@pytest.fixture
def battle(demo: Demo) -> Demo:
    return demo


class Front:
    """The program before `battle`. To tests.support.player.Player, it is a place to play."""

    def __init__(self, battle: Demo, folder: Path, tls: bool = False) -> None:
        self.http_port, self.https_port = free_port(), free_port()
        self.folder = folder
        self.env = {
            "LASERBOT_BIND": "127.0.0.1",
            "LASERBOT_HTTP_PORT": str(self.http_port),
            "LASERBOT_HTTPS_PORT": str(self.https_port),
            **{
                name: battle.ports[name]
                for name in ("LASERBOT_WEB_PORT", "LASERBOT_ROSBRIDGE_PORT", "LASERBOT_RELAY_PORT")
            },
        }
        if tls:
            self.env["LASERBOT_TLS"] = str(folder)
        scheme, port = ("https", self.https_port) if tls else ("http", self.http_port)
        self.relay_port = port
        self.web = f"{scheme}://localhost:{port}"
        self.bridge = f"{'wss' if tls else 'ws'}://localhost:{port}/rosbridge"
        self.view = battle.view

    def __enter__(self) -> "Front":
        self.program = Program.python("server.front", env={name: str(value) for name, value in self.env.items()})
        self.program.wait_for("the game is at port")
        until(self._answers, 10, "nginx listens")
        return self

    def _answers(self) -> bool:
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.http_port)) == 0

    def __exit__(self, *_: object) -> None:
        assert self.program.stop() == 0


@pytest.fixture
def front(battle: Demo, tmp_path: Path) -> Iterator[Front]:
    with Front(battle, tmp_path) as running:
        yield running


def openssl(folder: Path, command: str) -> None:
    subprocess.run(["openssl", *command.split()], cwd=folder, check=True, capture_output=True)


def sign(folder: Path, serial: int) -> None:
    """A certificate of the authority's for localhost."""
    openssl(folder, "req -newkey rsa:2048 -nodes -keyout front.key -out front.csr -subj /CN=x")
    (folder / "names").write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
    authority = f"-CA ca.crt -CAkey ca.key -set_serial {serial}"
    openssl(folder, f"x509 -req -in front.csr {authority} -days 2 -extfile names -out new.crt")
    (folder / "new.crt").replace(folder / "front.crt")


@pytest.fixture
def secure(battle: Demo, tmp_path: Path) -> Iterator[Front]:
    """With a certificate of the fleet's own authority."""
    folder = tmp_path / "secure"
    folder.mkdir()
    authority = "-subj /CN=arena -addext keyUsage=critical,keyCertSign"
    openssl(folder, f"req -x509 -newkey rsa:2048 -nodes -keyout ca.key -out ca.crt -days 2 {authority}")
    sign(folder, 1)
    with Front(battle, folder, tls=True) as running:
        yield running


@contextmanager
def trusting(chromium: Browser, folder: Path) -> Iterator[Browser]:
    """A Chromium that trusts the authority, as its owner told it to."""
    database = folder / ".pki" / "nssdb"
    database.mkdir(parents=True)
    for words in (["-N", "--empty-password"], ["-A", "-t", "C,,", "-n", "arena", "-i", str(folder / "ca.crt")]):
        subprocess.run(["certutil", "-d", f"sql:{database}", *words], check=True, capture_output=True)
    browser = chromium.browser_type.launch(
        executable_path="/usr/bin/chromium", args=FLAGS, env={**os.environ, "HOME": str(folder)}
    )
    yield browser
    browser.close()


def play(chromium: Browser, front: Front, name: str) -> set[str]:
    """Sign up by the page, see connection and arena live, get ready and sign out. Returns where the page has been."""
    person = Person(chromium, front, name, camera=True, arena=True)
    page, asked = person.page, set[str]()
    page.on("request", lambda request: asked.add(request.url))
    page.on("websocket", lambda opened: asked.add(opened.url))
    person.log_in()
    expect(page.locator("#connection-state")).to_have_attribute("data-level", re.compile("good|fair"))
    expect(page.locator("body")).to_have_attribute("data-arena", "live")
    expect(page.locator("#stage")).to_have_attribute("data-view", "camera")
    page.locator("#ready-btn").click()
    expect(page.locator("#ready-btn")).to_have_attribute("aria-pressed", "true")
    page.evaluate("name => fetch('/signOutUser', {method: 'POST', body: new URLSearchParams({data: name})})", name)
    person.context.close()
    assert person.complaints == []
    return {"/".join(url.split("/")[:3]) for url in asked if not url.startswith(("data:", "blob:"))}


def test_a_person_plays_at_one_address(front: Front, chromium: Browser) -> None:
    """Nothing that the page opens is at another one."""
    assert play(chromium, front, "Ann") == {front.web, front.web.replace("http", "ws")}


def test_a_program_drives_through_it(front: Front) -> None:
    with Player(front, "Bob") as bob, Player(front, "Cleo") as cleo:
        assert {bob.ready(), cleo.ready()} == {"OK"}
        bob.wait_for_game(1)


def test_a_foreign_page_still_acts_for_nobody(front: Front) -> None:
    """The cookie counts only with a page of this very address."""
    with Player(front, "Dan") as dan:
        cookie = "; ".join(f"{one.name}={one.value}" for one in dan.http.cookies)
        for origin, status in ((front.web, 200), ("http://evil.example", 403), ("http://localhost:1", 403)):
            answer = requests.post(
                f"{front.web}/playerReady",
                {"user": "Dan", "ready": 0},
                headers={"Origin": origin, "Cookie": cookie},
                timeout=LATEST,
            )
            assert answer.status_code == status, origin


def test_the_eyes_are_not_to_be_had_past_the_relay(front: Front) -> None:
    told = {"X-Laserbot-Relay": "1"}
    assert requests.get(f"{front.web}/arena/eyes/virtual0/snapshot", headers=told, timeout=LATEST).status_code == 404


def test_the_ports_stay_for_old_pages(battle: Demo, front: Front) -> None:
    for path in ("home", "watch", "operator"):
        for web, is_front in ((battle.web, False), (front.web, True)):
            visitor = requests.Session()
            if path == "operator":
                visitor.post(f"{web}/operator/login", data={"token": TOKEN, "name": "Otto"}, timeout=LATEST)
            page = visitor.get(f"{web}/{path}", timeout=LATEST).text
            assert 'name="relay-port"' in page
            assert ('name="front"' in page) is is_front, path


def test_files_are_compressed_and_kept(front: Front) -> None:
    page = requests.get(f"{front.web}/", timeout=LATEST)
    assert page.headers["Content-Encoding"] == "gzip"
    style = page.text.split('rel="stylesheet" href="')[1].split('"')[0]
    file = requests.get(front.web + style, timeout=LATEST)
    assert "immutable" in file.headers["Cache-Control"]
    assert file.headers["Content-Encoding"] == "gzip"


def test_who_sends_too_much_waits_for_his_turn(front: Front) -> None:
    """A file that nginx has: it answers as fast as anybody can ask."""
    page = requests.get(f"{front.web}/", timeout=LATEST).text
    style = page.split('rel="stylesheet" href="')[1].split('"')[0]
    requests.get(front.web + style, timeout=LATEST)
    ask = f"HEAD {style} HTTP/1.1\r\nHost: localhost\r\n"
    count = FILES_AT_ONCE + 2 * RATE
    began = time.monotonic()
    with socket.create_connection(("127.0.0.1", front.http_port), timeout=LATEST) as hasty:
        hasty.sendall((f"{ask}\r\n" * (count - 1) + f"{ask}Connection: close\r\n\r\n").encode())
        codes = re.findall(rb"HTTP/1.1 (\d+)", hasty.makefile("rb").read())
    assert codes == [b"200"] * count
    assert time.monotonic() - began > 1, "a refusal would be answered at once, and followed by the next request"


def test_a_visitor_who_sends_nothing_is_cut(front: Front) -> None:
    with socket.create_connection(("127.0.0.1", front.http_port), timeout=15) as slow:  # nginx's own patience is 60 s
        slow.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nX-Slow: ")
        with suppress(ConnectionResetError):
            assert slow.recv(1000) == b""


def test_a_program_that_is_away_is_told_and_found_again(battle: Demo, front: Front) -> None:
    with battle.pause("server.rosbridge"):
        assert requests.get(f"{front.web}/watch.json", timeout=LATEST).ok
    battle.kill("server.rosbridge")

    def refused() -> bool:
        try:
            connect(front.bridge).close()
        except InvalidStatus as error:
            assert error.response.status_code == 502
            return False
        return True

    until(refused, 20, "rosbridge is back")


@pytest.mark.slow
def test_by_tls_a_browser_that_trusts_the_authority_plays(secure: Front, chromium: Browser, tmp_path: Path) -> None:
    shutil.copy(secure.folder / "ca.crt", tmp_path)
    with trusting(chromium, tmp_path) as browser:
        assert play(browser, secure, "Eve") == {secure.web, secure.web.replace("https", "wss")}


def test_without_tls_there_is_only_the_way_to_it(secure: Front, chromium: Browser) -> None:
    plain = f"http://localhost:{secure.http_port}"
    answer = requests.get(f"{plain}/results?day=1", timeout=LATEST, allow_redirects=False)
    assert (answer.status_code, answer.headers["Location"]) == (302, f"{secure.web}/results?day=1")
    assert requests.get(f"{plain}/ca.crt", timeout=LATEST).content == (secure.folder / "ca.crt").read_bytes()
    page = chromium.new_page()
    page.goto(f"{plain}/trust")
    expect(page.get_by_role("heading", name="Trust this arena")).to_be_visible()
    page.close()


def test_a_cookie_that_came_by_tls_goes_back_by_tls_only(secure: Front) -> None:
    with requests.Session() as session:
        post = partial(session.post, verify=str(secure.folder / "ca.crt"), timeout=LATEST)
        answer = post(f"{secure.web}/signUpUser", {"data": "Fay"})
        assert "Secure" in answer.headers["Set-Cookie"]
        assert "Strict-Transport-Security" not in answer.headers, "nobody has to trust an own authority for a year"
        assert json.loads(post(f"{secure.web}/signOutUser", {"data": "Fay"}).text)["status"] == "OK"


def test_a_renewed_certificate_is_read_without_a_restart(secure: Front) -> None:
    def serial() -> int:
        chain = ssl.get_server_certificate(("localhost", secure.https_port))
        show = ["openssl", "x509", "-noout", "-serial"]
        shown = subprocess.run(show, input=chain.encode(), capture_output=True, check=True).stdout.decode()
        return int(shown.partition("=")[2], 16)

    assert serial() == 1
    sign(secure.folder, 2)
    until(lambda: serial() == 2, 10, "the new one is shown")


def test_a_real_name_with_a_certificate_that_all_trust_asks_for_tls_from_then_on(battle: Demo, tmp_path: Path) -> None:
    names = "-subj /CN=x -addext subjectAltName=DNS:localhost"
    openssl(tmp_path, f"req -x509 -newkey rsa:2048 -nodes -keyout front.key -out front.crt -days 2 {names}")
    with Front(battle, tmp_path, tls=True) as front:
        for host, told in {"arena.example": True, "master.local": False, "10.0.0.7": False, "localhost": False}.items():
            trusted = str(tmp_path / "front.crt")
            answer = requests.get(f"{front.web}/", headers={"Host": host}, verify=trusted, timeout=LATEST)
            assert ("Strict-Transport-Security" in answer.headers) == told, host


def test_who_floods_the_sign_up_waits_whatever_he_says_of_himself(front: Front) -> None:
    """The last test: from then on, sign-ups of this address wait."""

    def sign_up(number: int) -> int:
        said = {"X-Forwarded-For": f"10.0.0.{number}"}
        reply = requests.post(f"{front.web}/signUpUser", {"data": f"Gil{number}"}, headers=said, timeout=LATEST)
        return reply.status_code

    assert requests.codes.too_many_requests in [sign_up(number) for number in range(6)]
