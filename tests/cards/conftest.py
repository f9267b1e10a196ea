"""For the tests of cards: the images, built by what `make cards` calls."""

import os
import subprocess
from pathlib import Path

import pytest

from tests.support.programs import ROOT


@pytest.fixture(scope="session")
def images() -> Path:
    return built("robot", "master")


@pytest.fixture(scope="session")
def robot_image(images: Path) -> Path:
    return images / "laserbot-robot.img"


@pytest.fixture(scope="session")
def master_image(images: Path) -> Path:
    return images / "laserbot-master.img"


def built(*roles: str) -> Path:
    """The folder with those cards' images, and with what an update for them is made of."""
    subprocess.run([ROOT / "ci/cards", *roles], env={**os.environ, "PLAIN": "1"}, check=True)
    return ROOT / "build/cards"


@pytest.fixture
def key(tmp_path: Path) -> Path:
    return new_key(tmp_path)


def new_key(folder: Path) -> Path:
    """A private SSH key; the public one lies beside it."""
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", folder / "key"], check=True)
    return folder / "key"
