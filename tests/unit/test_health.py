"""images/health: a program works if it said so a moment ago. tests/images has those that are known by their port."""

import os
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from tests.support.programs import ROOT


def health(file: Path) -> tuple[int, str]:
    """Exit code and words, where there is no program but these: an interpreter takes seconds on a busy machine."""
    programs = file.parent / "bin"
    programs.mkdir()
    for name in ("stat", "date"):
        (programs / name).symlink_to(str(shutil.which(name)))
    environment = {"PATH": str(programs), "LASERBOT_ALIVE_FILE": str(file)}
    result = subprocess.run([ROOT / "images/health"], env=environment, capture_output=True, text=True, check=False)
    assert not result.stderr
    return result.returncode, result.stdout.strip()


@pytest.mark.parametrize(("age", "code", "told"), [(0, 0, ""), (7, 0, ""), (40, 1, "health: no sign of work for 4. s")])
def test_the_age_of_its_last_sign_counts(tmp_path: Path, age: int, code: int, told: str) -> None:
    file = tmp_path / "alive"
    file.touch()
    then = time.time() - age
    os.utime(file, (then, then))
    answer, words = health(file)
    assert answer == code
    assert re.fullmatch(told, words)


def test_a_program_that_has_not_begun_is_not_healthy(tmp_path: Path) -> None:
    assert health(tmp_path / "alive") == (1, "health: no sign of work yet")
