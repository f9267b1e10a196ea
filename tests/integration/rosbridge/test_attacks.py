"""Whatever a guest does, the drivers' commands arrive in time, all of them, and the memory stays as it is."""

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import Any, Self

import psutil
import pytest

from tests.integration.rosbridge.attacks import ATTACKS
from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import Client, RosSide, player
from tests.support.polling import until
from tests.support.programs import ROOT, Program
from tests.support.ros import RosMaster

DURATION = 5.0  # s of an attack
P99 = 0.05  # s from a driver's socket to his robot
JOINING = 3.0  # s for one more player, from the page's opening to the robot's first command
LINES = 300  # a second in the log
GROWTH = 40 * 2**20  # bytes


class Drivers:
    """The process of drivers.py, driving while in a `with`."""

    def __init__(self, master: RosMaster, port: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.integration.rosbridge.drivers", str(port)],
            env=master.env, cwd=ROOT, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip

    def join(self) -> float:
        """How long one more player needs, in s."""
        assert self._process.stdin
        self._process.stdin.write("join\n")
        self._process.stdin.flush()
        return float(self._hear()["joined"])

    def finish(self) -> dict[str, float]:
        assert self._process.stdin
        self._process.stdin.close()
        return self._hear()

    def __enter__(self) -> Self:
        try:
            assert self._hear() == {"driving": True}
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        assert self._process.stdin and self._process.stdout
        if kind or self._process.stdout.closed or not self._process.stdin.closed:
            self._process.kill()
        self._process.wait(10)
        self._process.stdin.close()
        self._process.stdout.close()

    def _hear(self) -> dict[str, Any]:
        assert self._process.stdout
        line = self._process.stdout.readline()
        assert line, "the drivers have failed"
        return dict(json.loads(line))


@pytest.fixture
def drivers(ros_master: RosMaster, rosbridge: Rosbridge) -> Iterator[Drivers]:
    with Drivers(ros_master, rosbridge.port) as driving:
        yield driving


@pytest.mark.slow  # the time is real
@pytest.mark.parametrize("attack", ATTACKS)
def test_drivers_notice_nothing(attack: str, drivers: Drivers, rosbridge: Rosbridge) -> None:
    process = psutil.Process(rosbridge.program.process.pid)
    memory, lines = process.memory_info().rss, len(rosbridge.program.output.splitlines())
    begin = time.monotonic()
    attacker = Program.python("tests.integration.rosbridge.attacks", attack, str(rosbridge.port))
    try:
        attacker.wait_for("attacking")
        time.sleep(DURATION / 2)  # what an attack is: nothing to wait for
        joined = drivers.join()
        time.sleep(DURATION / 2)
        assert attacker.running, attacker.output
        result = drivers.finish()
    finally:
        attacker.kill()
    print(attack, {**result, "joined": joined}, f"{(process.memory_info().rss - memory) / 2**20:.1f} MiB")
    assert result["lost"] == 0
    assert result["p99"] <= P99
    assert joined <= JOINING
    assert process.memory_info().rss - memory < GROWTH
    assert len(rosbridge.program.output.splitlines()) - lines < LINES * (time.monotonic() - begin)


def test_impossible_numbers_are_refused_and_the_socket_stays(client: Callable[..., Client]) -> None:
    rude = client()
    rude.say("subscribe", topic="/game_status", throttle_rate=10**400)
    assert "throttle_rate" in rude.hear_error()
    rude.say("subscribe", topic="/game_status", queue_length=10**400)
    rude.say("call_service", service="/a", timeout=10**400)
    while (answer := rude.hear())["op"] != "service_response":
        pass
    assert answer["result"] is False


def player_at_the_wheel(ros: RosSide, client: Callable[..., Client], **headers: str) -> Client:
    """al, and rosbridge knows him."""
    ros.status(2, player("al", "token-of-al", 3))
    watcher = client()
    watcher.watch()
    until(lambda: [user["name"] for user in watcher.hear_status(2)["users"]] == ["al"])
    return client("token-of-al", **headers)


def test_a_command_that_no_key_gives_is_refused(ros: RosSide, client: Callable[..., Client]) -> None:
    al = player_at_the_wheel(ros, client)
    al.drive(3, {"linear_x": 5, "angular_z": 0, "shoot": False})
    assert "linear_x and angular_z must be -1, 0 or 1" in al.hear_error()


@pytest.mark.parametrize(
    "origin",
    [
        "http://127.0.0.1:8080",
        "http://127.0.0.1:" + "9" * 5000,
        "http://[::1",
        "file:///etc/passwd",
        "ftp://127.0.0.1:5000",
        "null",
    ],
    ids=lambda origin: origin[:20],
)
def test_a_page_of_others_is_a_guest(ros: RosSide, client: Callable[..., Client], origin: str) -> None:
    page = player_at_the_wheel(ros, client, Origin=origin)
    page.advertise(3)
    assert "only signed-in players" in page.hear_error()
