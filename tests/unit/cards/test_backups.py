"""A master's results outlast the partition that they are on."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from cards import backups
from cards.backups import COPY, DATA, keep
from cards.start import start
from cards.telling import ERRORS
from server.store import keeping

NEWEST, OLDER = "laserbot-2026-03-02T040000Z.db", "laserbot-2026-03-01T040000Z.db"


class MasterCard:
    def __init__(self, folder: Path) -> None:
        self.boot, self.root = folder / "boot", folder / "root"
        self.data = self.root / DATA
        self.database = self.data / "laserbot.db"
        (self.data / "backups").mkdir(parents=True)
        self.boot.mkdir()
        (self.boot / "laserbot.txt").write_text("")

    def back_up(self, name: str, winner: str) -> None:
        """As the game does."""
        with closing(sqlite3.connect(self.data / "backups" / name)) as backup:
            backup.execute("CREATE TABLE battles (winner)")
            backup.execute("INSERT INTO battles VALUES (?)", [winner])
            backup.commit()

    def start(self) -> None:
        start(self.boot, self.root, "master")

    @property
    def winner(self) -> str:
        with closing(sqlite3.connect(self.database)) as opened:
            return str(opened.execute("SELECT winner FROM battles").fetchone()[0])

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
    return MasterCard(tmp_path)


def test_a_master_whose_state_is_new_has_the_results_of_its_last_backup(
    master: MasterCard, tmp_path: Path, owned: list[tuple[str, object]]
) -> None:
    master.back_up(OLDER, "ada")
    master.back_up(NEWEST, "bob")
    (master.data / "backups/laserbot-2026-03-03T040000Z.db.part-1").write_text("half of one")
    assert keep(master.boot, master.data) == 0
    anew = MasterCard(tmp_path / "anew")
    anew.boot = master.boot
    anew.start()
    assert anew.winner == "bob"
    assert owned == [("laserbot.db.new", 10001)], "the containers' user"
    assert sorted(path.name for path in anew.data.iterdir()) == ["backups", "laserbot.db"]
    assert not anew.told


def test_results_that_are_there_stay(master: MasterCard) -> None:
    master.back_up(NEWEST, "bob")
    keep(master.boot, master.data)
    master.database.write_text("the evening's")
    master.start()
    assert master.database.read_text() == "the evening's"


def test_only_another_backup_is_written(master: MasterCard) -> None:
    keep(master.boot, master.data)
    assert not (master.boot / COPY).exists(), "there is none yet"
    master.back_up(OLDER, "ada")
    keep(master.boot, master.data)
    before = (master.boot / COPY).stat().st_ino
    keep(master.boot, master.data)
    assert (master.boot / COPY).stat().st_ino == before
    master.back_up(NEWEST, "bob")
    keep(master.boot, master.data)
    assert (master.boot / COPY).read_bytes() == (master.data / "backups" / NEWEST).read_bytes()


@pytest.mark.parametrize("content", ["no database", ""])
def test_a_copy_that_is_damaged_is_told_and_not_taken(content: str, master: MasterCard) -> None:
    master.back_up(NEWEST, "bob")
    whole = (master.data / "backups" / NEWEST).read_bytes()
    (master.boot / COPY).write_bytes(content.encode() or whole[:4096] + bytes(len(whole) - 4096))
    master.start()
    assert not master.database.exists()
    assert master.told.startswith(f"{COPY}: the results cannot be taken from it: ")


def test_a_first_partition_that_is_full_is_told(master: MasterCard, monkeypatch: pytest.MonkeyPatch) -> None:
    master.back_up(NEWEST, "bob")
    usage = type("Usage", (), {"free": 3 << 20})
    monkeypatch.setattr("cards.backups.shutil.disk_usage", lambda _: usage)
    assert keep(master.boot, master.data) == 1
    assert master.told == f"{COPY}: the backup of the results needs 32 MiB here, and 3 are free\n"
    monkeypatch.undo()
    assert keep(master.boot, master.data) == 0
    assert not master.told


def test_a_robots_card_has_no_results(tmp_path: Path) -> None:
    card = MasterCard(tmp_path)
    card.back_up(NEWEST, "bob")
    keep(card.boot, card.data)
    start(card.boot, card.root, "robot")
    assert not card.database.exists()


def test_the_names_are_those_that_the_game_gives() -> None:
    assert backups._BACKUP.pattern == keeping._NAME.pattern
