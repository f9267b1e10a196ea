"""For the tests of cards: the images, built by what `make cards` calls."""

import os
import subprocess
from pathlib import Path

import pytest

from tests.support.programs import ROOT


@pytest.fixture(scope="session")
def robot_image() -> Path:
    return built("robot")


@pytest.fixture(scope="session")
def master_image() -> Path:
    return built("master")


def built(role: str) -> Path:
    subprocess.run([ROOT / "ci/cards", role], env={**os.environ, "PLAIN": "1"}, check=True)
    return ROOT / f"build/cards/laserbot-{role}.img"


@pytest.fixture
def key(tmp_path: Path) -> Path:
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", tmp_path / "key"], check=True)
    return tmp_path / "key"
