"""For all tests."""

import os
import signal
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.leaks import adopt_orphans, nothing_left

# A shell starts background programs with SIGINT ignored, and so would be what the tests start and stop by SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)
# Whoever ends the tests, they end what they have started.
signal.signal(signal.SIGTERM, signal.default_int_handler)

# On a machine with GPIO, the robots that the tests start would drive one of its lines.
os.environ["LASERBOT_LED"] = "none"

adopt_orphans()


@pytest.fixture(scope="session")
def temporary_files(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where this run, and what it starts as whichever user, has temporary files; not those of tmp_path."""
    tmp_path_factory.getbasetemp()
    with tempfile.TemporaryDirectory(prefix="laserbot-tests-") as folder, pytest.MonkeyPatch.context() as patch:
        Path(folder).chmod(0o1777)
        patch.setenv("TMPDIR", folder)
        patch.setattr(tempfile, "tempdir", folder)
        yield Path(folder)


@pytest.fixture(autouse=True)
def leaves_nothing(temporary_files: Path) -> Iterator[None]:
    """What a test itself starts, it ends; what its module shares is there before it."""
    with nothing_left(temporary_files):
        yield
