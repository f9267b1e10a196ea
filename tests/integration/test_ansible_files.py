"""ansible/library/files.py: one step writes several files, and only those that are not as they should be."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

from tests.support.programs import ROOT


def write(*files: dict[str, Any], check: bool = False) -> dict[str, Any]:
    """What the module answers."""
    given = {"ANSIBLE_MODULE_ARGS": {"files": files, "_ansible_check_mode": check}}
    run = subprocess.run(
        [ROOT / ".venv/bin/python", ROOT / "ansible/library/files.py"],
        input=json.dumps(given),
        capture_output=True,
        text=True,
        check=False,
    )
    answer: dict[str, Any] = json.loads(run.stdout)
    return answer


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o7777


def test_files_and_their_folders_are_written_once(tmp_path: Path) -> None:
    program, settings, folder = tmp_path / "bin/program", tmp_path / "etc/program.d/speed.conf", tmp_path / "data"
    files: tuple[dict[str, Any], ...] = (
        {"path": str(program), "content": "#!/bin/sh\n", "mode": "0755"},
        {"path": str(settings), "content": "speed=1 # schnell wie möglich\n"},
        {"path": str(folder), "mode": "0700", "owner": os.getuid()},
    )
    assert write(*files, check=True)["changed"]
    assert list(tmp_path.iterdir()) == [], "a dry run"
    umask = os.umask(0o077)
    try:
        answer = write(*files)
    finally:
        os.umask(umask)
    assert [each["after_header"] for each in answer["diff"]] == [str(program), str(settings)]
    assert settings.read_text() == files[1]["content"]
    modes = {path: mode(path) for path in (program, settings, settings.parent, folder)}
    assert modes == {program: 0o755, settings: 0o644, settings.parent: 0o755, folder: 0o700}
    assert not write(*files)["changed"]


def test_what_somebody_has_changed_is_mended(tmp_path: Path) -> None:
    settings = tmp_path / "speed.conf"
    file = {"path": str(settings), "content": "speed=1\n"}
    write(file)
    settings.write_text("speed=2\n")
    (difference,) = write(file, check=True)["diff"]
    assert (difference["before"], difference["after"]) == ("speed=2\n", "speed=1\n")
    assert write(file)["changed"]
    settings.chmod(0o666)
    assert write(file)["changed"]
    assert (settings.read_text(), mode(settings)) == ("speed=1\n", 0o644)
    elsewhere = settings.rename(tmp_path / "elsewhere")
    settings.symlink_to(elsewhere)
    assert write({**file, "content": "speed=3\n"})["changed"]
    assert (settings.is_symlink(), elsewhere.read_text()) == (False, "speed=1\n")


def test_a_folder_may_be_a_link_to_another_disk(tmp_path: Path) -> None:
    disk, folder = tmp_path / "disk", tmp_path / "data"
    disk.mkdir(0o755)
    folder.symlink_to(disk)
    file = {"path": str(folder), "mode": "0700", "owner": os.getuid()}
    assert write(file)["changed"]
    assert mode(disk) == 0o700
    assert not write(file)["changed"]
    assert folder.is_symlink()


def test_what_belongs_to_the_host_keeps_its_content(tmp_path: Path) -> None:
    floor = tmp_path / "floor.json"
    first = {"path": str(floor), "content": "{}", "once": True}
    assert write(first)["changed"]
    floor.write_text("another")
    assert not write(first)["changed"]
    assert floor.read_text() == "another"
    floor.chmod(0o600)
    assert write(first)["changed"]
    assert (floor.read_text(), mode(floor)) == ("another", 0o644)


def test_a_file_that_would_be_wrong_is_not_written(tmp_path: Path) -> None:
    settings = tmp_path / "speed.conf"
    answer = write({"path": str(settings), "content": "sped=1\n", "validate": "grep speed %s"})
    assert answer["failed"]
    assert answer["msg"].startswith(f"{settings} would be wrong")
    assert not settings.exists()
    assert write({"path": str(settings), "content": "speed=1\n", "validate": "grep speed %s"})["changed"]
