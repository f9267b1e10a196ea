"""roles/master: what only the master has is saved in one file, and brought back (docs/replace-the-master.md)."""

import os
import sqlite3
import sys
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import URL

from server.store import versions
from server.store.database import make_engine
from tests.support.local_play import play_role, recap
from tests.support.programs import ROOT

# runs the store's own program here instead of in a container; what else it is told is noted
DOCKER = """#!/bin/sh
case $1 in
run)
    until [ "$1" = python3 ]; do shift; done
    shift
    cd {root} && LASERBOT_DATA={folder} PYTHONPATH=laser_bot_battle/src exec {python} "$@"
    ;;
inspect) echo webserver ;;
*) echo "$*" >>{folder}/told ;;
esac
"""


def play(tasks: str, folder: Path, **more: object) -> None:
    given = {
        "fleet_ca": folder / "ca",
        "master_backup": folder / "saved/evening.tar",
        "master_floors": folder / "data/floors",
        **more,
    }
    variables = "".join(f"{name}: {value}\n" for name, value in given.items())
    run = play_role("master", tasks, variables, folder, "laser_bot_master")
    assert recap(run.stdout)["laser_bot_master"]["failed"] == 0, run.stdout


def mark(database: Path, number: int | None = None) -> int:
    """A number in the database that tells which one it is."""
    with closing(sqlite3.connect(database)) as connection:
        if number is not None:
            connection.execute(f"PRAGMA user_version={number}")
        return int(connection.execute("PRAGMA user_version").fetchone()[0])


def make_database(folder: Path) -> Path:
    """Of the game, in the folder, beside the `docker` that finds it there."""
    (folder / "docker").write_text(DOCKER.format(root=ROOT, folder=folder, python=sys.executable))
    (folder / "docker").chmod(0o755)
    database = folder / "laserbot.db"
    engine = make_engine(URL.create("sqlite", database=str(database)))
    with engine.begin() as connection:
        versions.prepare(connection)
    engine.dispose()
    return database


@pytest.mark.slow
def test_the_database_is_saved_before_another_image(tmp_path: Path) -> None:
    make_database(tmp_path)
    own = {"master_data": tmp_path, "fleet_container_user": os.getuid()}
    play("keep", tmp_path, master_image="webserver", **own)
    assert list((tmp_path / "backups").iterdir()) == [], "it runs already"
    play("keep", tmp_path, master_image="another", **own)
    assert len(list((tmp_path / "backups").glob("laserbot-*.db"))) == 1


@pytest.mark.slow
def test_database_floors_and_ca_come_back_as_they_were_saved(tmp_path: Path) -> None:
    (tmp_path / "ca").mkdir()
    for name in ("ca.key", "ca.crt"):
        (tmp_path / "ca" / name).write_text(name)
    database = make_database(tmp_path)
    mark(database, 7)
    floor = tmp_path / "data/floors/hall-1a2b3c4d.json"
    floor.parent.mkdir(parents=True)
    floor.write_text("of the desk")
    (floor.parent / ".hall-1a2b3c4d.json.x").write_text("half of ano")
    play("backup", tmp_path)
    saved = tmp_path / "saved" / "evening.tar"
    assert saved.stat().st_mode & 0o077 == 0, "it has the CA's key"
    assert not (tmp_path / "told").exists(), "the game goes on"

    for name in ("ca.key", "ca.crt"):
        (tmp_path / "ca" / name).write_text("another one's")
    mark(database, 8)
    floor.write_text("another one")
    (floor.parent / ".hall-1a2b3c4d.json.x").unlink()
    play("restore_ca", tmp_path)
    play("restore_floors", tmp_path)
    play("restore_database", tmp_path)
    before = floor.with_name(f"{floor.name}.before")
    assert {path: path.read_text() for path in floor.parent.iterdir()} == {floor: "of the desk", before: "another one"}
    assert {path.name: path.read_text() for path in (tmp_path / "ca").iterdir()} == {
        "ca.key": "ca.key",
        "ca.crt": "ca.crt",
    }
    assert (mark(database), mark(database.with_name("laserbot.db.before"))) == (7, 8)
    assert (tmp_path / "told").read_text() == "stop laserbot-web\nstart laserbot-web\n"


@pytest.mark.slow
def test_who_has_no_floor_of_the_desk_misses_none(tmp_path: Path) -> None:
    (tmp_path / "ca").mkdir()
    for name in ("ca.key", "ca.crt"):
        (tmp_path / "ca" / name).write_text(name)
    make_database(tmp_path)
    play("backup", tmp_path)
    play("restore_floors", tmp_path)
    assert not (tmp_path / "data").exists()
