"""A keeper and the processes that it keeps going: real processes, which tell their IDs."""

import os
import signal
import sys
from collections.abc import Iterator

import psutil
import pytest

from tests.support.polling import until
from tests.support.programs import ROOT, Program

WORKER = """
import os, sys, time
from laser_bot_battle.log import configure_logging
from robot import keeper

keeper.BEAT = 0.05
configure_logging("info")
heart = keeper.keep_going()
BEGIN
os.write(1, f"worker {os.getpid()}\\n".encode())  # in one piece: the keeper logs into the same file
END = time.monotonic() + 20
while time.monotonic() < END:
    WORK
    time.sleep(0.01)
"""
BEATS, RESTS, ENDS = "heart.beat()", "heart.rest()", "sys.exit(3)"


class Kept(Program):
    def __init__(self, work: str) -> None:
        begin = work if work != ENDS else ""  # before it is stopped, the keeper knows what to expect
        path = f"{ROOT}:{ROOT / 'build' / 'python'}"
        super().__init__(
            [sys.executable, "-c", WORKER.replace("BEGIN", begin).replace("WORK", work)], {"PYTHONPATH": path}
        )

    def workers(self) -> list[int]:
        """Process IDs of all that there have been."""
        return [int(line.split()[1]) for line in self.output.splitlines() if line.startswith("worker ")]

    def newest(self, number: int) -> int:
        return until(lambda: self.workers()[number - 1 :], 10)[0]


@pytest.fixture
def kept(request: pytest.FixtureRequest) -> Iterator[Kept]:
    program = Kept(request.param)
    yield program
    if program.running:
        program.kill()


def kept_with(work: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("kept", [work], indirect=True, ids=["worker"])


@kept_with(BEATS)
def test_a_killed_worker_is_replaced(kept: Kept) -> None:
    os.kill(kept.newest(1), signal.SIGKILL)
    kept.newest(2)
    assert "the program was ended by signal 9: it is started again in 0.2 s" in kept.output


@kept_with(BEATS)
def test_a_worker_that_hangs_is_replaced(kept: Kept) -> None:
    os.kill(kept.newest(1), signal.SIGSTOP)
    kept.newest(2)
    assert "the program hangs: no sign of life for 0.25 s" in kept.output


@kept_with(RESTS)
def test_a_worker_that_rests_may_take_its_time(kept: Kept) -> None:
    first = kept.newest(1)
    os.kill(first, signal.SIGSTOP)
    with pytest.raises(AssertionError):
        until(lambda: len(kept.workers()) > 1, 1)
    os.kill(first, signal.SIGCONT)


@kept_with(ENDS)
def test_what_a_worker_ends_with_is_the_programs_end(kept: Kept) -> None:
    assert kept.exit_code() == 3
    assert len(kept.workers()) == 1


@kept_with(BEATS)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_reaches_the_worker_and_ends_both(kept: Kept, number: signal.Signals) -> None:
    worker = kept.newest(1)
    kept.process.send_signal(number)
    assert kept.exit_code() == 0
    assert not psutil.pid_exists(worker)


@kept_with(BEATS)
def test_a_worker_does_not_outlive_its_keeper(kept: Kept) -> None:
    worker = kept.newest(1)
    kept.process.kill()
    until(lambda: not psutil.pid_exists(worker) or psutil.Process(worker).status() == psutil.STATUS_ZOMBIE, 5)
