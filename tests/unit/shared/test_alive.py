import os
from pathlib import Path

import pytest

from laser_bot_battle import alive


def test_the_files_time_is_renewed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "alive"
    monkeypatch.setenv("LASERBOT_ALIVE_FILE", str(file))
    alive.touch()
    os.utime(file, (0, 0))
    alive.touch()
    assert file.stat().st_mtime > 0


@pytest.mark.parametrize("file", ["", "/nowhere/alive"])
def test_without_a_file_that_can_be_written_nothing_happens(file: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LASERBOT_ALIVE_FILE", file)
    alive.touch()
