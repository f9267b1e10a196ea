"""For the checks of a deployed fleet, real or rehearsed: each runs on every host that it concerns; a table sums up."""

import functools
import shutil
import tempfile
from collections import defaultdict
from pathlib import Path

import pytest

from fleet import Fleet

HOSTS = Path(__file__).parents[2] / "build" / "fleet-hosts.json"  # ansible/check.yml writes it


@functools.cache
def sockets() -> Path:
    """Where ssh keeps its connections: a short path, which sockets need, and nobody else's."""
    return Path(tempfile.mkdtemp(prefix="laserbot-"))


@functools.cache
def read_fleet() -> Fleet:
    return Fleet.read(HOSTS, sockets())


def pytest_unconfigure() -> None:
    shutil.rmtree(sockets())


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test with the argument machine, master or robot runs once for each host of that kind."""
    if not HOSTS.exists():
        raise pytest.UsageError("which hosts to check, ansible/check.yml knows: it runs these tests")
    machines = [machine for machine in read_fleet().machines.values() if machine.checked]
    for argument, group in {"machine": None, "master": "master", "robot": "robots"}.items():
        if argument in metafunc.fixturenames:
            chosen = [machine for machine in machines if group in (None, machine.group)]
            # the hosts are asked at the same time, each over one connection
            each = [pytest.param(one, id=one.name, marks=pytest.mark.xdist_group(one.name)) for one in chosen]
            metafunc.parametrize(argument, each, scope="session")


@pytest.fixture(scope="session")
def fleet() -> Fleet:
    return read_fleet()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    rows: dict[str, dict[str, str]] = defaultdict(dict)
    told = []
    for outcome, mark in (("passed", "ok"), ("failed", "FAILED"), ("error", "FAILED")):
        for report in terminalreporter.getreports(outcome):
            test, _, host = report.nodeid.rpartition("::")[2].partition("[")
            rows[test][host.partition("]")[0]] = mark
            told += [f"{host.partition(']')[0]}: {what}: {value}" for what, value in report.user_properties]
    hosts = sorted({host for row in rows.values() for host in row if host})
    if not hosts:
        return
    width = max(map(len, rows))
    terminalreporter.write_line("")
    terminalreporter.write_line(" ".join([" " * width, *hosts]))
    for test, row in sorted(rows.items()):
        name = test.removeprefix("test_").replace("_", " ")
        everywhere = row.get("", "")
        terminalreporter.write_line(
            " ".join([name.ljust(width), *(row.get(host, everywhere or "-").ljust(len(host)) for host in hosts)])
        )
    for line in sorted(told):
        terminalreporter.write_line(line)
