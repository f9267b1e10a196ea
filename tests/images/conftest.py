"""The images, built once, in a real engine (ci/engine)."""

import os
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from _pytest.mark import ParameterSet

from tests.support import imagefile
from tests.support.containers import engine
from tests.support.polling import until
from tests.support.ports import free_port, listening
from tests.support.programs import ROOT, Program

FIGURES = pytest.StashKey[list[str]]()


def pytest_configure(config: pytest.Config) -> None:
    config.stash[FIGURES] = []


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if config.stash[FIGURES]:
        terminalreporter.section("images")
        for line in config.stash[FIGURES]:
            terminalreporter.write_line(line)


@pytest.fixture(scope="session")
def figures(pytestconfig: pytest.Config) -> list[str]:
    """Lines that are printed at the end of the run."""
    return pytestconfig.stash[FIGURES]


def build(*targets: str, **variables: str) -> float:
    """Run ci/images; s that it took."""
    began = time.monotonic()
    result = subprocess.run(
        [ROOT / "ci/images", *targets], env={**os.environ, **variables}, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return time.monotonic() - began


HERE = "linux/amd64"


def _every(*, emulated: bool) -> list[ParameterSet]:
    """Each image with each of its platforms; slow are those that `make test` does not build and, without `emulated`,
    those that this machine cannot run itself."""
    return [
        pytest.param((image, platform), id=f"{image}-{platform}", marks=[] if is_quick else pytest.mark.slow)
        for image in imagefile.IMAGES
        for platform in sorted(imagefile.platforms(image))
        for is_quick in [platform in imagefile.platforms(image, fewer=True) and (emulated or platform == HERE)]
    ]


EVERY, NATIVE = _every(emulated=True), _every(emulated=False)


@pytest.fixture(scope="session")
def version() -> str:
    """The tag of the images, which have been built when this is asked for."""
    if not os.environ.get("IMAGES_ENGINE"):
        pytest.fail(
            "these tests need a Docker Engine: ci/engine/run .venv/bin/python -m pytest tests/images", pytrace=False
        )
    if "IMAGES_BUILT" not in os.environ:
        build()
    return imagefile.version()


@pytest.fixture(scope="module")
def network(version: str) -> Iterator[str]:
    """A bridge network of its own, without a way out."""
    made = engine().networks.create(f"laserbot-test-{os.getpid()}", internal=True)
    yield str(made.name)
    made.remove()


class Registry(NamedTuple):
    """An empty registry, Debian's, unpacked and not installed."""

    place: str
    """host:port"""
    command: list[str]


@pytest.fixture(scope="session")
def registry(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Registry]:
    folder: Path = tmp_path_factory.mktemp("registry")
    subprocess.run(["apt-get", "-q", "download", "docker-registry"], cwd=folder, check=True, capture_output=True)
    (package,) = folder.glob("*.deb")
    subprocess.run(["dpkg-deb", "-x", package, folder / "root"], check=True)
    port = free_port()
    place = f"127.0.0.1:{port}"
    settings = folder / "config.yml"
    settings.write_text(
        f"version: 0.1\nlog: {{level: warn}}\nstorage: {{filesystem: {{rootdirectory: {folder / 'data'}}}}}\n"
        f"http: {{addr: {place}}}\n"
    )
    command = [f"{folder}/root/usr/bin/docker-registry", "serve", str(settings)]
    program = Program(command)
    until(lambda: listening(port), 10, "the registry answers")
    yield Registry(place, command)
    program.stop()
