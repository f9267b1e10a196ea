"""For all tests."""

import os
import signal
import tempfile
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from xdist.remote import Producer

from tests.support.costs import Costs
from tests.support.demo import Demo, Demos
from tests.support.leaks import adopt_orphans, nothing_left
from tests.support.programs import last_words
from tests.support.workers import Scheduling

# A shell starts background programs with SIGINT ignored, and so would be what the tests start and stop by SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)
# Whoever ends the tests, they end what they have started.
signal.signal(signal.SIGTERM, signal.default_int_handler)

# On a machine with GPIO, the robots that the tests start would drive one of its lines.
os.environ["LASERBOT_LED"] = "none"

adopt_orphans()

# Neither chance nor a machine that is busy for a moment may decide whether a property holds.
settings.register_profile("checks", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("checks")


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Costs())


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> Scheduling:
    return Scheduling(config, log)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """A failure shows what the programs of the test have said."""
    report = yield
    if report.failed:
        report.sections += last_words()
    return report


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


@pytest.fixture(scope="session")
def demos(temporary_files: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Demos]:
    demos = Demos(tmp_path_factory.mktemp("journal"))
    yield demos
    demos.end()


@pytest.fixture
def demo(demos: Demos) -> Iterator[Demo]:
    """A demo of two robots that all tests share."""
    yield from demos.lend()
