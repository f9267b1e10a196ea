"""For the tests of cards: one image, built by what `make cards` calls."""

import subprocess
from pathlib import Path

import pytest

from tests.support.programs import ROOT


@pytest.fixture(scope="session")
def image() -> Path:
    subprocess.run([ROOT / "ci/cards", "--plain"], check=True)
    return ROOT / "build/cards/laserbot-robot.img"


@pytest.fixture
def key(tmp_path: Path) -> Path:
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", tmp_path / "key"], check=True)
    return tmp_path / "key"
