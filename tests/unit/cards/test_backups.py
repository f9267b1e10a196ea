"""A master's results outlast the partition that they are on."""

import os
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from cards.backups import COPY, DAMAGED, DATA, keep
from cards.files import STATE
from cards.start import start
from cards.telling import ERRORS


class MasterCard:
    def __init__(self, folder: Path) -> None:
        self.boot, self.root = folder / "boot", folder / "root"
        self.database = self.root / DATA / "laserbot.db"
        self.database.parent.mkdir(parents=True)
        self.boot.mkdir()
        (self.boot / "laserbot.txt").write_text("")

    def play(self, winner: str) -> None:
        """As the game keeps it: a part is in other files as long as it runs."""
        with closing(sqlite3.connect(self.database)) as game:
            game.execute("PRAGMA journal_mode=WAL")
            game.execute("CREATE TABLE IF NOT EXISTS battles (winner)")
            game.execute("INSERT INTO battles VALUES (?)", [winner])
            game.commit()

    def keep(self) -> int:
        return keep(self.boot, self.root)

    def start(self) -> None:
        start(self.boot, self.root, "master")

    def copy_to(self, other: "MasterCard") -> None:
        (other.boot / COPY).write_bytes((self.boot / COPY).read_bytes())

    @property
    def winners(self) -> list[str]:
        with closing(sqlite3.connect(self.database)) as opened:
            return [winner for (winner,) in opened.execute("SELECT winner FROM battles")]

    @property
    def told(self) -> str:
        path = self.boot / ERRORS
        return path.read_text() if path.exists() else ""


@pytest.fixture
def owned(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, object]]:
    owned: list[tuple[str, object]] = []
    monkeypatch.setattr("cards.backups.shutil.chown", lambda path, user, group: owned.append((path.name, user)))
    return owned


@pytest.fixture
def master(tmp_path: Path) -> MasterCard:
    return MasterCard(tmp_path / "first")


@pytest.fixture
def anew(tmp_path: Path) -> MasterCard:
    return MasterCard(tmp_path / "anew")


def test_a_master_whose_state_is_new_has_the_results_again(
    master: MasterCard, anew: MasterCard, owned: list[tuple[str, object]]
) -> None:
    master.play("ada")
    assert master.keep() == 0
    with closing(sqlite3.connect(master.database)) as game:  # it runs
        game.execute("INSERT INTO battles VALUES ('bob')")
        game.commit()
        assert master.keep() == 0
    master.copy_to(anew)
    anew.start()
    assert anew.winners == ["ada", "bob"]
    assert owned == [("laserbot.db.new", 10001)], "the containers' user"
    assert [path.name for path in anew.database.parent.iterdir()] == ["laserbot.db"]
    assert list((master.root / STATE.relative_to("/")).iterdir()) == []
    assert not anew.told


def test_results_that_are_there_stay(master: MasterCard) -> None:
    master.play("ada")
    master.keep()
    master.play("bob")
    master.start()
    assert master.winners == ["ada", "bob"]


def test_only_what_has_changed_is_written(master: MasterCard) -> None:
    master.keep()
    assert not (master.boot / COPY).exists(), "there is nothing yet"
    master.play("ada")
    master.keep()
    before = (master.boot / COPY).stat().st_ino
    master.keep()
    assert (master.boot / COPY).stat().st_ino == before
    master.play("bob")
    master.keep()
    assert (master.boot / COPY).stat().st_ino != before


@pytest.mark.parametrize("kept", [0, 4096])
def test_a_copy_that_is_damaged_is_told_and_not_lost(kept: int, master: MasterCard, anew: MasterCard) -> None:
    master.play("ada" * 5000)
    master.keep()
    whole = (master.boot / COPY).read_bytes()
    damaged = whole[:kept] + bytes(len(whole) - kept) if kept else b""
    (anew.boot / COPY).write_bytes(damaged)
    anew.start()
    assert not anew.database.exists()
    anew.play("eve")
    anew.keep()
    assert (anew.boot / DAMAGED).read_bytes() == damaged
    assert anew.told.startswith(f"{DAMAGED}: the results cannot be taken from it: ")
    assert (anew.boot / COPY).exists()


def test_a_database_that_is_damaged_does_not_replace_the_copy(master: MasterCard) -> None:
    master.play("ada")
    master.keep()
    before = (master.boot / COPY).read_bytes()
    master.database.write_bytes(b"no database" * 1000)
    assert master.keep() == 1
    assert master.told.startswith(f"{COPY}: the results cannot be copied here: ")
    assert (master.boot / COPY).read_bytes() == before


def test_a_first_partition_that_is_full_is_told(master: MasterCard, monkeypatch: pytest.MonkeyPatch) -> None:
    master.play("ada")
    usage = type("Usage", (), {"free": 3 << 20})
    monkeypatch.setattr("cards.backups.shutil.disk_usage", lambda _: usage)
    assert master.keep() == 1
    assert master.told == f"{COPY}: the results cannot be copied here: 150 MiB have to be free, and 3 are\n"
    monkeypatch.undo()
    assert master.keep() == 0
    assert not master.told


def test_no_link_in_the_games_folder_is_followed(
    master: MasterCard, anew: MasterCard, tmp_path: Path, owned: list[tuple[str, object]]
) -> None:
    master.play("ada")
    master.keep()
    master.copy_to(anew)
    (tmp_path / "secret").write_text("the host's")
    os.symlink(tmp_path / "secret", anew.database.with_name("laserbot.db.new"))
    anew.start()
    assert anew.winners == ["ada"]
    assert (tmp_path / "secret").read_text() == "the host's"


def test_a_robots_card_has_no_results(master: MasterCard, anew: MasterCard) -> None:
    master.play("ada")
    master.keep()
    master.copy_to(anew)
    start(anew.boot, anew.root, "robot")
    assert not anew.database.exists()
