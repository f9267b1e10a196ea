"""Keeps the robot's program going, wherever it runs: a process that only watches another, which does the work, and
starts it again when it has been killed or hangs.

What starts containers and services notices a program that has ended, not one that hangs; and after the second end it
waits for longer than a battle allows.
"""

import contextlib
import ctypes
import logging
import os
import select
import signal
import sys
import time
from types import FrameType

from laser_bot_battle.backoff import STEADY, Backoff

BEAT = 1.0  # s
MISSED = 4  # beats in a row; they are counted, so that a machine that stood still finds nobody guilty
POLL = 0.05  # s
LONGEST_PAUSE = 5.0  # s before the next start

_BEATS, _RESTS = b"b", b"r"
_SIGNALS = {signal.SIGINT, signal.SIGTERM}
_PR_SET_PDEATHSIG = 1

_log = logging.getLogger(__name__)


class Heart:
    """The worker's sign of life. It is missed only from a beat on, until a rest."""

    def __init__(self, pipe: int) -> None:
        self._pipe = pipe

    def beat(self) -> None:
        """Call it every `BEAT` s from now on."""
        self._say(_BEATS)

    def rest(self) -> None:
        """What follows may take long."""
        self._say(_RESTS)

    def _say(self, what: bytes) -> None:
        with contextlib.suppress(OSError):  # the keeper is gone, and this process with it
            os.write(self._pipe, what)


def keep_going() -> Heart:
    """Go on in a new process. The one that calls keeps that one going, passes SIGINT and SIGTERM on to it, and ends
    with its exit code. Call it before any thread is started."""
    return _Keeper().keep()


class _Keeper:
    def __init__(self) -> None:
        self._worker = 0
        self._ends = False

    def keep(self) -> Heart:
        backoff = Backoff(LONGEST_PAUSE)
        for number in _SIGNALS:
            signal.signal(number, self._pass_on)
        while True:
            began = time.monotonic()
            pipe, workers_pipe = os.pipe()
            if not self._fork():
                os.close(pipe)
                return Heart(workers_pipe)
            os.close(workers_pipe)
            self._watch(pipe)
            os.close(pipe)
            code = os.waitstatus_to_exitcode(os.waitpid(self._worker, 0)[1])
            self._worker = 0
            if self._ends or code >= 0:
                sys.exit(max(code, 0))
            if time.monotonic() - began >= STEADY:
                backoff.worked()
            pause = backoff.failed()
            _log.error("the program was ended by signal %d: it is started again in %.1f s", -code, pause)
            again_at = time.monotonic() + pause
            while time.monotonic() < again_at:
                if self._ends:
                    sys.exit()
                time.sleep(POLL)

    def _fork(self) -> int:
        """0 in the worker, which dies with its keeper and has a process group of its own: Ctrl-C reaches only the
        keeper."""
        keeper = os.getpid()
        signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
        try:
            self._worker = os.fork()
            if not self._worker:
                os.setpgid(0, 0)
                for number in _SIGNALS:
                    signal.signal(number, signal.SIG_DFL)
                ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
                if os.getppid() != keeper:
                    os._exit(1)
        finally:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)
        return self._worker

    def _watch(self, pipe: int) -> None:
        """Until the worker has ended; one that hangs is killed."""
        beats, missed = False, 0
        while True:
            if select.select([pipe], [], [], BEAT)[0]:
                said = os.read(pipe, 4096)
                if not said:
                    return  # the kernel closes its end
                beats, missed = said.endswith(_BEATS), 0
            elif beats:
                missed += 1
                if missed > MISSED:
                    _log.error("the program hangs: no sign of life for %g s", missed * BEAT)
                    os.kill(self._worker, signal.SIGKILL)
                    beats = False

    def _pass_on(self, number: int, _frame: FrameType | None) -> None:
        self._ends = True  # no Event: its lock may be held by what the handler interrupts
        if self._worker:
            os.kill(self._worker, number)
