"""The database fails in a battle: the battle goes on, and nothing of it is missing afterwards."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import requests
from sqlalchemy import URL

from server.game.events import BattleStarted, Hit
from tests.integration.server.conftest import GameServer, Page, RobotPeer, StatusPeer
from tests.integration.server.test_operator import TOKEN, Desk
from tests.support.databases import events, taken
from tests.support.lan import needs_root
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.postgres import Postgres, own_postgres
from tests.support.programs import Program

__all__ = ["own_postgres"]

PLAYING = 2
HITS = """
import sqlite3, sys
for [data] in sqlite3.connect(sys.argv[1]).execute("SELECT data FROM events WHERE kind = 'Hit' ORDER BY id"):
    print(data)
"""


class Fight:
    """A battle of ann and bob, in which a hit takes 1 of 100."""

    def __init__(self, server: GameServer) -> None:
        self.server = server
        server.wait_until_serving()
        server.robot("one")
        self._target: RobotPeer = server.robot("two")
        self.pages = [server.player("ann"), server.player("bob")]
        for page in self.pages:
            page.ready()
        self.status: StatusPeer = server.listener()
        self.status.wait_for(lambda status: status["game"] == PLAYING)
        self.life = 100
        self._next = 0.0

    def hit(self) -> float:
        """Hit bob; the time until everybody knows."""
        until(lambda: time.monotonic() >= self._next, 1, "no robot is hit more often than that")
        self.life -= 1
        begin = time.monotonic()
        self._target.hit()
        self.status.wait_for_life("bob", self.life)
        self._next = time.monotonic() + 0.2
        return time.monotonic() - begin

    def ask(self) -> float:
        """A newcomer asks for everything that a page can; the time that it takes."""
        begin = time.monotonic()
        assert self.server.post("updateGameStatus")["status"] == "OK"
        assert self.server.post("signUpUser", data="cyd", wait=1)["status"] in ("QUEUED", "UNAVAILABLE")
        assert self.pages[0].post("playerReady", user="ann", ready=1)["status"] == "STARTED"
        return time.monotonic() - begin

    def restart(self) -> None:
        """The server is killed, and goes on."""
        self.server.program.kill()
        self.server.launch()
        self.server.wait_until_serving()

    def goes_on(self, battle: int) -> bool:
        """Whether the players are in that battle as they were."""
        latest = self.status.latest
        lives = {user["name"]: user["life"] for user in latest["users"]}
        return (latest["game"], latest["battle"], lives) == (PLAYING, battle, {"ann": 100, "bob": self.life})


@pytest.fixture
def fight(launch: Callable[..., GameServer]) -> Iterator[Callable[..., Fight]]:
    """Begin one at a server that is launched so."""
    pages: list[Page] = []

    def begin(**how: object) -> Fight:
        fight = Fight(launch(LASERBOT_COUNTDOWN="1", LASERBOT_HIT_DAMAGE="1", **how))
        pages.extend(fight.pages)
        return fight

    yield begin
    for page in pages:
        page.close()


def file_of(tmp_path: Path) -> URL:
    return URL.create("sqlite", database=str(tmp_path / "data" / "laserbot.db"))


def hits(url: URL) -> list[int]:
    """The lives that were left, as the database has them."""
    return [one.event.life for one in events(url) if isinstance(one.event, Hit)]


def test_no_hit_and_no_page_waits_for_a_database_that_another_program_holds(fight, tmp_path: Path) -> None:
    battle = fight()
    for _ in range(5):
        battle.hit()
    with taken(file_of(tmp_path)):
        tries = 0

        def tried() -> bool:
            nonlocal tries
            tries += 1
            battle.hit()
            battle.ask()
            return "database is locked" in battle.server.program.output

        until(tried, 15, "the database has been waited for")
    assert tries > 1, "a hit has waited as long as the database itself waits"
    battle.server.program.wait_for("can be written again")
    until(lambda: hits(file_of(tmp_path)) == list(range(99, battle.life - 1, -1)), 10, "all hits are kept")


@pytest.mark.slow
def test_a_server_that_is_killed_and_comes_back_misses_nothing(fight, own_postgres: Postgres) -> None:
    url = own_postgres.new_database()
    battle = fight(LASERBOT_DATABASE=url.render_as_string(hide_password=False))
    battle.hit()
    until(lambda: hits(url) == [99], 10, "it is in use")
    own_postgres.kill()
    assert battle.hit() < 3
    battle.server.program.wait_for("cannot be used (Can't create a connection")
    assert battle.hit() < 3
    own_postgres.start()
    battle.server.program.wait_for("can be written again")
    until(lambda: hits(url) == [99, 98, 97], 10, "all hits are kept, once")
    battle.restart()
    until(lambda: battle.goes_on(1), 10, "the battle goes on")


@pytest.mark.slow
@needs_root
def test_a_full_disk_stops_no_battle_and_loses_none(fight, tmp_path: Path) -> None:
    """A small disk of the server's own, in a mount namespace that outlives it."""
    (tmp_path / "data").mkdir()
    hold = f"mount -t tmpfs -o size=1m tmpfs {tmp_path / 'data'} && echo up && exec sleep inf"
    holder = Program(["unshare", "--mount", "sh", "-c", hold])
    try:
        holder.wait_for("up\n")
        disk = Path(f"/proc/{holder.process.pid}/root{tmp_path / 'data'}")
        within = ["nsenter", f"--target={holder.process.pid}", "--mount", "--root", "--wd"]

        def kept() -> list[int]:
            """As hits(); SQLite itself has to be within."""
            command = [*within, sys.executable, "-c", HITS, str(file_of(tmp_path).database)]
            return [json.loads(line)["life"] for line in subprocess.check_output(command).splitlines()]

        battle = fight(within=within)
        battle.hit()
        until(lambda: kept() == [99], 10, "it is in use")
        fill(disk / "filler")

        def full() -> bool:
            assert battle.hit() < 3
            return "disk is full" in battle.server.program.output or "disk I/O error" in battle.server.program.output

        until(full, 30, "the disk is full")
        battle.hit()
        (disk / "filler").unlink()
        battle.server.program.wait_for("can be written again")
        until(lambda: kept() == list(range(99, battle.life - 1, -1)), 10, "all hits are kept, once")
        battle.restart()
        until(lambda: battle.goes_on(1), 10, "the battle goes on")
    finally:
        holder.kill()


def fill(path: Path) -> None:
    """Take the last byte of its disk."""
    with path.open("wb", buffering=0) as filler:
        try:
            while True:
                filler.write(bytes(4096))
        except OSError:
            pass


def test_a_file_that_is_deleted_in_a_battle_is_told_and_loses_nothing(fight, tmp_path: Path) -> None:
    metrics = f"127.0.0.1:{free_port()}"
    battle = fight(LASERBOT_OPERATOR_TOKEN=TOKEN, LASERBOT_METRICS=metrics)
    desk = Desk(battle.server.url)
    file = Path(file_of(tmp_path).database or "")
    try:
        for _ in range(3):
            battle.hit()
        until(lambda: hits(file_of(tmp_path)) == [99, 98, 97], 10, "it is in use")
        assert desk.get("state")["database"]["mishap"] == ""
        for path in file.parent.glob("laserbot.db*"):
            path.unlink()
        told = until(lambda: desk.get("state")["database"]["mishap"], 10, "the desk tells it")
        assert told == f"{file} was deleted while it was open: all that was in it has been written there again"
        battle.server.program.wait_for(told)
        with requests.get(f"http://{metrics}/metrics", timeout=LATEST) as answer:
            assert "laserbot_database_replacements_total 1.0" in answer.text
        battle.hit()
        desk.say("battle", action="abort")
        battle.status.wait_for(lambda status: status["game"] == 0)
        until(lambda: desk.get("state")["database"]["waiting"] == 0, 10, "the end is written")
    finally:
        desk.close()
    battle.restart()
    with requests.get(f"{battle.server.url}/results/1.json", timeout=LATEST) as answer:
        result = answer.json()
    assert {one["name"]: one["hits_taken"] for one in result["fighters"]} == {"ann": 0, "bob": 4}
    assert hits(file_of(tmp_path)) == [99, 98, 97, 96]


@pytest.mark.slow
def test_a_file_without_permission_is_no_obstacle(fight, tmp_path: Path) -> None:
    folder = tmp_path / "data"
    folder.mkdir(mode=0o500)
    as_anybody = ["setpriv", "--inh-caps=-all", "--bounding-set=-all"] if os.geteuid() == 0 else []
    battle = fight(within=as_anybody)
    assert "cannot be used (unable to open database file)" in battle.server.program.output
    battle.hit()
    folder.chmod(0o700)
    battle.server.program.wait_for("can be written again")
    until(lambda: hits(file_of(tmp_path)) == [99], 10)
    assert [one.event.battle for one in events(file_of(tmp_path)) if isinstance(one.event, BattleStarted)] == [1]
    battle.restart()
    until(lambda: battle.goes_on(1), 10, "the battle goes on")
